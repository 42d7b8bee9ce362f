"""Turns three components over time into lines of a panel, with sensible limits and honest gaps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator, ScalarFormatter

from kreisel.data.checks import Array
from kreisel.data.motion import Note
from kreisel.show import style
from kreisel.show.thinning import COLUMNS, Mask, alone, drawable

# A span below this, in the unit drawn or relative to the value, is round-off rather than signal.
ROUND_OFF, RELATIVE_ROUND_OFF = 1e-8, 1e-11

_DASHES = {"heading-jump": (0, (4.0, 2.0)), "rate-step": (0, (1.0, 1.5))}
_OTHER_DASH = (0, (6.0, 2.0, 1.0, 2.0))


def draw_components(
    axes: Axes,
    t: Array,
    values: Array,
    labels: Sequence[str] = ("x", "y", "z"),
    *,
    colours: Sequence[str] = style.XYZ,
    jump: float = np.inf,
    **look: Any,
) -> list[Line2D]:
    """A line for each column of `values` (n, 3) at times `t` (n,); samples without neighbours become dots."""
    lines = []
    sparse = len(t) < COLUMNS
    width, alpha = (style.LINE_WIDTH, 1.0) if sparse else (style.DENSE_LINE_WIDTH, style.DENSE_ALPHA)
    for column, colour, label in zip(values.T, colours, labels, strict=True):
        at, y = drawable(t, column, jump)
        options = {"color": colour, "label": label, "linewidth": width, "alpha": alpha, **look}
        (line,) = axes.plot(at, y, solid_joinstyle="round", **options)
        lonely = alone(y)
        if len(lonely):
            line.set(marker=".", markersize=9.0 if len(lonely) < 20 else 4.0, markevery=lonely.tolist())
        lines.append(line)
    return lines


def fit(axes: Axes, t: Array, *values: Array) -> None:
    """Limits around all finite `values`, and around `t`; round-off is not blown up to full scale."""
    seen = [v[np.isfinite(v)] for v in values]
    low = min((float(v.min()) for v in seen if v.size), default=0.0)
    high = max((float(v.max()) for v in seen if v.size), default=0.0)
    axes.set_ylim(*value_limits(low, high))
    axes.set_xlim(*time_limits(t))
    axes.yaxis.set_major_formatter(_numbers())


def _numbers() -> ScalarFormatter:
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-3, 5))
    return formatter


def value_limits(low: float, high: float) -> tuple[float, float]:
    """Axis limits around values from `low` to `high`.

    Where they differ by round-off only, the axis reaches one unit or a tenth of the value to either side, so
    that a constant reads as constant.
    """
    centre, span = 0.5 * (low + high), high - low
    if span < max(ROUND_OFF, RELATIVE_ROUND_OFF * max(abs(low), abs(high))):
        centre = 0.0 if abs(centre) < ROUND_OFF else centre
        half = max(1.0, 0.1 * abs(centre))
    else:
        half = 0.56 * span
    return centre - half, centre + half


def time_limits(t: Array) -> tuple[float, float]:
    """Axis limits around times `t` (n,); half a second to either side of a single one."""
    if not len(t):
        return 0.0, 1.0
    margin = 0.008 * float(t[-1] - t[0]) or 0.5
    return float(t[0]) - margin, float(t[-1]) + margin


def degree_ticks(axes: Axes) -> None:
    """Ticks at quarter turns once an axis in degrees spans more than half a turn."""
    low, high = axes.get_ylim()
    if high - low > 180.0:
        axes.yaxis.set_major_locator(MultipleLocator(90.0))


def degrees_on_the_right(axes: Axes, unit: str) -> None:
    """A second scale on the right for a panel in radians: the same in degrees, in `unit`."""
    right = axes.secondary_yaxis("right", functions=(np.rad2deg, np.deg2rad))
    right.yaxis.set_major_formatter(_numbers())
    right.set_ylabel(unit, fontsize=style.LABEL_SIZE, color=style.FAINT_INK)
    right.tick_params(labelsize=style.TICK_SIZE, labelcolor=style.FAINT_INK, color=style.FAINT_INK, width=0.7)
    right.yaxis.get_offset_text().set(fontsize=style.TICK_SIZE, color=style.FAINT_INK)
    right.spines["right"].set(color=style.GRID, linewidth=0.7)


def mark_missing(axes: Axes, t: Array, values: Array) -> Line2D | None:
    """A row of small ticks under the curves where a row of `values` (n, 3) has a missing sample."""
    missing = t[~np.isfinite(values).all(axis=1)]
    if not len(missing):
        return None
    at = _one_per_column(missing, t)
    (line,) = axes.plot(
        at,
        np.full(len(at), 0.02),
        linestyle="none",
        marker="|",
        markersize=4.5,
        color=style.MISSING,
        label=f"missing ({len(missing)})",
        transform=axes.get_xaxis_transform(),
    )
    return line


def mark_spans(axes: Axes, t: Array, raised: Mask, label: str, colour: str, row: int = 0) -> Artist:
    """A bar along the floor of a panel wherever a flag `raised` (n,) is up; `row` counts bars upwards.

    Each sample stands for the time up to the next; spans narrower than a pixel are drawn one pixel wide.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], raised, [False]])))
    first, last = edges[::2], edges[1::2]
    ends = np.append(t[1:], t[-1])
    # Spans that share a column of the picture are one to the eye.
    column = (t[-1] - t[0]) / COLUMNS
    apart = t[first[1:]] - ends[last[:-1] - 1] > column
    starts = t[first[np.append(True, apart)]]
    stops = ends[last[np.append(apart, True)] - 1]
    spans = np.column_stack([starts, np.maximum(stops - starts, column)])
    return axes.broken_barh(
        spans.tolist(),
        (0.012 + 0.035 * row, 0.025),
        transform=axes.get_xaxis_transform(),
        facecolors=colour,
        label=label,
        zorder=4.0,
    )


def mark_notes(panels: Sequence[Axes], t: Array, notes: Sequence[Note]) -> list[Line2D]:
    """Thin dashed vertical lines where a note has a time; one legend handle for each kind."""
    timed: dict[str, list[float]] = {}
    for note in notes:
        if note.t is not None:
            timed.setdefault(note.kind, []).append(note.t)
    handles = []
    for kind, times in timed.items():
        at = _one_per_column(np.array(times), t)
        lines = [_uprights(axes, at, _DASHES.get(kind, _OTHER_DASH)) for axes in panels]
        lines[0].set_label(f"{kind.replace('-', ' ')} ({len(times)})")
        handles.append(lines[0])
    return handles


def legend(axes: Axes, handles: Sequence[Artist]) -> None:
    """One row of entries above the right end of a panel, clear of the curves."""
    axes.legend(
        handles=list(handles),
        loc="lower right",
        bbox_to_anchor=(1.0, 0.99),
        ncols=len(handles),
        frameon=False,
        fontsize=style.TICK_SIZE,
        labelcolor=style.INK,
        handlelength=1.8,
        columnspacing=1.4,
        borderaxespad=0.1,
    )


def _uprights(axes: Axes, at: Array, dash: tuple[int, tuple[float, ...]]) -> Line2D:
    x = np.repeat(at, 3)
    y = np.tile([0.0, 1.0, np.nan], len(at))
    (line,) = axes.plot(
        x,
        y,
        transform=axes.get_xaxis_transform(),
        color=style.NOTE,
        linewidth=0.8,
        linestyle=dash,
        zorder=1.5,
    )
    return line


def _one_per_column(times: Array, t: Array) -> Array:
    """The first of `times` in each of the columns that `t` (n,) is drawn in."""
    span = float(t[-1] - t[0])
    if span == 0.0:
        return times[:1]
    _, first = np.unique(np.floor((times - t[0]) / span * COLUMNS), return_index=True)
    return times[first]
