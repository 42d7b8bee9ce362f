"""Turns estimated attitude, its errors and its gyro bias into figures over time, the truth beside them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from kreisel.data.attitude import AttitudeHistory, Mask, Reference
from kreisel.data.checks import Array, same_length, shaped
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.evaluate.attitude_errors import AttitudeErrors, Summary
from kreisel.maths.rotations import euler_from_matrix
from kreisel.show import series, style

_ANGLES = ("φx about x", "φy about y", "φz about z")
_TRUTH = {"color": style.TRUTH, "linewidth": 2.4, "alpha": 1.0, "zorder": 2.0}
_FLAGS = (
    ("rest", "at rest", style.FLAG_REST),
    ("disturbed", "magnetometer not trusted", style.FLAG_DISTURBED),
    ("held", "gyro sample missing", style.MISSING),
)

# A step between neighbours beyond this is a wrap, or the flip at phi_y = +-90 deg, rather than a turn.
_WRAP_DEG = 120.0

# A panel follows the errors themselves; a start this many times worse would flatten them.
_OFF_THE_SCALE = 6.0


def plot_attitude(
    estimate: AttitudeHistory, truth: AttitudeHistory | Reference | Motion | Poses | None = None
) -> Figure:
    """Euler angles of R_NS (deg) over time, the truth as a broad line beneath, the filter's flags below.

    Gaps are where the truth has no attitude; angles are drawn from -180 to 180 degrees without a line where
    they wrap. A truth of positions only is left out.
    """
    known = None if truth is None else _angles_of(truth, estimate.t0_ns)
    what = "estimated attitude" if known is None else "estimated attitude, over the truth"
    figure, panels = style.stacked(3, _title(estimate.name, what))
    angles = np.rad2deg(estimate.euler)
    for k, axes in enumerate(panels):
        style.caption(axes, _ANGLES[k], f"φ{'xyz'[k]} [deg]")
        handles: list[Artist] = []
        if known is not None:
            handles += series.draw_components(
                axes, known[0], known[1][:, [k]], ["truth"], colours=["k"], jump=_WRAP_DEG, **_TRUTH
            )
        handles += series.draw_components(
            axes, estimate.t, angles[:, [k]], ["estimate"], colours=[style.XYZ[k]], jump=_WRAP_DEG, zorder=3.0
        )
        series.fit(axes, estimate.t, angles[:, k], *([] if known is None else [known[1][:, k]]))
        series.degree_ticks(axes)
        # Each panel has its own colour, so each says which of its lines is which.
        series.legend(axes, [*handles, *(_flags(axes, estimate) if k == 2 else [])])
    return figure


def _angles_of(truth: AttitudeHistory | Reference | Motion | Poses, t0_ns: int) -> tuple[Array, Array] | None:
    """Times after `t0_ns` and Euler angles in degrees (n, 3); None without attitude."""
    R = truth.R_NS if isinstance(truth, AttitudeHistory | Reference) else truth.R_NB
    if R is None:
        return None
    return truth.t + (truth.t0_ns - t0_ns) * 1e-9, np.rad2deg(euler_from_matrix(R))


def _flags(axes: Axes, estimate: AttitudeHistory) -> list[Artist]:
    """A thin bar along the floor of the panel for each flag that was ever raised, one above the other."""
    bars: list[Artist] = []
    for name, text, colour in _FLAGS:
        raised: Mask | None = getattr(estimate, name)
        if raised is not None and raised.any():
            bars.append(series.mark_spans(axes, estimate.t, raised, text, colour, row=len(bars)))
    return bars


def plot_attitude_errors(errors: AttitudeErrors, limit_deg: float = 5.0) -> Figure:
    """Total, heading and inclination error (deg) over time: RMSE, and the time of convergence marked.

    Samples that do not count are grey. Offsets that were removed first are named in the title. The error has
    converged when the total stays below `limit_deg` for good.
    """
    summary = errors.summary(limit_deg)
    figure, panels = style.stacked(3, _title(errors.name, "attitude error" + _removed(summary)))
    rows = (
        ("total", "angle of the whole error", "total [deg]", style.INK),
        ("heading", "heading: the part about up", "heading [deg]", style.XYZ[2]),
        ("inclination", "inclination: between the two directions of up", "inclination [deg]", style.XYZ[0]),
    )
    for axes, (name, text, quantity, colour) in zip(panels, rows, strict=True):
        style.caption(axes, text, quantity)
        handles = _error_lines(axes, errors, np.rad2deg(getattr(errors, name)), colour)
        rmse = getattr(summary, f"{name}_rmse_deg")
        handles.append(_level(axes, rmse, colour))
        if name == "heading":
            _level(axes, -rmse, colour)
        series.legend(axes, handles)
    _mark_convergence(panels, errors, summary)
    return figure


def _error_lines(axes: Axes, errors: AttitudeErrors, values: Array, colour: str) -> list[Artist]:
    counts = errors.counts
    handles: list[Artist] = []
    if not counts.all():
        # Under the coloured line lies the whole one, so that the two join where counting starts.
        handles += series.draw_components(
            axes, errors.t, values[:, None], ["not counted"], colours=[style.UNCOUNTED], jump=_WRAP_DEG
        )
    counted = np.where(counts, values, np.nan)
    # No label: the caption says what it is.
    series.draw_components(
        axes, errors.t, counted[:, None], [""], colours=[colour], jump=_WRAP_DEG, zorder=3.0
    )
    seen = np.abs(values[counts & np.isfinite(values)])
    top = _OFF_THE_SCALE * float(np.percentile(seen, 95.0)) if seen.size else np.inf
    series.fit(axes, errors.t, np.where(np.abs(values) <= top, values, np.nan), np.zeros(1))
    series.degree_ticks(axes)
    peak = float(seen.max(initial=0.0))
    if peak > top:
        text = f"up to {_degrees(peak)}, beyond this panel"
        handles.append(Line2D([], [], color=colour, linestyle="none", marker="^", markersize=5.0, label=text))
    return handles


def _level(axes: Axes, y: float, colour: str) -> Line2D:
    low, high = axes.get_ylim()
    line = axes.axhline(y, color=colour, linewidth=0.9, linestyle=(0, (5.0, 2.5)), alpha=0.75, zorder=3.5)
    line.set_label(f"RMSE {_degrees(abs(y))}")
    axes.set_ylim(low, high)
    return line


def _mark_convergence(panels: Sequence[Axes], errors: AttitudeErrors, summary: Summary) -> None:
    """A line through all panels at the time of convergence, where it is not the start."""
    limit, settled = _degrees(summary.convergence_limit_deg), summary.convergence_time_s
    start = float(errors.t[errors.counts][0])
    if settled is None:
        _remark(panels[0], f"never settles below {limit}", start)
    elif settled > 0.0:
        for axes in panels:
            axes.axvline(
                start + settled, color=style.NOTE, linewidth=0.9, linestyle=(0, (1.0, 1.5)), zorder=1.5
            )
        _remark(panels[0], f"below {limit} for good after {settled:.4g} s", start + settled)


def _remark(axes: Axes, text: str, at: float) -> None:
    """A short sentence inside the upper edge of a panel, on that side of time `at` that has more room."""
    on_the_left = at > 0.5 * sum(axes.get_xlim())
    axes.annotate(
        text,
        (at, 1.0),
        xycoords=axes.get_xaxis_transform(),
        xytext=(-5.0 if on_the_left else 5.0, -4.0),
        textcoords="offset points",
        ha="right" if on_the_left else "left",
        va="top",
        fontsize=style.TICK_SIZE,
        color=style.NOTE,
        bbox={"facecolor": style.PANEL, "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
        zorder=5.0,
    )


def _removed(summary: Summary) -> str:
    """What was taken off before comparing, as the end of a title."""
    parts = []
    if summary.heading_offset_deg is not None:
        parts.append(f"heading offset {_degrees(summary.heading_offset_deg)}")
    if summary.frame_offset_deg is not None:
        parts.append(f"turn of the frame {_degrees(float(np.linalg.norm(summary.frame_offset_deg)))}")
    if summary.sensor_offset_deg is not None:
        parts.append(f"turn of the sensor {_degrees(float(np.linalg.norm(summary.sensor_offset_deg)))}")
    if summary.clock_offset_s:
        parts.append(f"clock offset {summary.clock_offset_s:.4g} s")
    return f" after removing {', '.join(parts)}" if parts else ""


def _degrees(value: float) -> str:
    return f"{value:.3g}°"


def plot_bias(
    estimate: AttitudeHistory, truth_bias: Array | None = None, truth_t: Array | None = None
) -> Figure:
    """Estimated gyro bias (deg/s) in sensor axes over time, and the true one as broad pale lines beneath it.

    truth_bias : (m, 3) rad/s, at the times `truth_t` (m,) s after the estimate's t0_ns, or at its stamps.
    Raises ValueError for an estimate without bias.
    """
    if estimate.gyro_bias is None:
        raise ValueError("there is no bias to draw: this estimate has no gyro_bias.")
    what = "estimated gyro bias" if truth_bias is None else "estimated gyro bias, over the true one"
    figure, (axes,) = style.stacked(1, _title(estimate.name, what))
    style.caption(axes, "gyro bias in sensor axes", "bias [deg/s]")
    handles: list[Artist] = []
    drawn = [np.rad2deg(estimate.gyro_bias)]
    if truth_bias is not None:
        t = estimate.t if truth_t is None else shaped("truth_t", truth_t, ("n",))
        drawn.append(np.rad2deg(shaped("truth_bias", truth_bias, ("n", 3))))
        same_length(t, truth_bias=drawn[1])
        series.draw_components(axes, t, drawn[1], alpha=0.35, linewidth=3.0, zorder=2.0)
        handles.append(Line2D([], [], color=style.FAINT_INK, linewidth=3.0, alpha=0.45, label="truth"))
    lines = series.draw_components(axes, estimate.t, drawn[0], zorder=3.0)
    series.fit(axes, estimate.t, *drawn)
    series.legend(axes, [*lines, *handles])
    return figure


def _title(name: str, what: str) -> str:
    return f"{name}: {what}" if name else what[0].upper() + what[1:]
