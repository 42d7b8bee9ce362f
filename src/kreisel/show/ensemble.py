"""Turns an ensemble of runs into figures: errors over time as fans, their spread over runs, and what drives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from kreisel.data.checks import Array
from kreisel.show import style
from kreisel.study.ensemble.ensemble import LEVELS, Ensemble

_KINDS = {"heading": style.XYZ[2], "inclination": style.XYZ[0]}
_BANDS = ((0, 6, "all runs", 0.10), (1, 5, "9 in 10", 0.22), (2, 4, "half of them", 0.40))
_MOST_BARS = 12
_HATCH = "////"
_BAR_ALPHA = 0.85


def plot_fans(ensemble: Ensemble, estimate: int = 0) -> Figure:
    """Heading and inclination error over time: the median of the runs, and the bands that hold half, 90 % and all."""
    each = ensemble.estimates[estimate]
    figure, panels = style.stacked(2, f"{_runs(ensemble)}: errors of {each.filter} on {each.imu}")
    for axes, (kind, colour) in zip(panels, _KINDS.items(), strict=True):
        quantiles = each.quantiles[kind]
        for low, high, _, alpha in _BANDS:
            axes.fill_between(
                ensemble.t, quantiles[low], quantiles[high], color=colour, alpha=alpha, linewidth=0.0
            )
        median = quantiles[LEVELS.index(0.5)]
        axes.plot(ensemble.t, median, color=style.INK, linewidth=style.LINE_WIDTH)
        style.caption(axes, f"{kind} error", "[deg]")
        _zoom(axes, quantiles, signed=kind == "heading")
        _legend_above(axes, _band_handles(colour))
    panels[-1].set_xlabel("time after the start [s]", fontsize=style.LABEL_SIZE, color=style.INK)
    panels[0].set_xlim(float(ensemble.t[0]), float(ensemble.t[-1]))
    return figure


def _band_handles(colour: str) -> list[Artist]:
    """What stands for each band, as dark as the bands are that lie over each other there."""
    handles: list[Artist] = []
    bare = 1.0
    for _, _, label, alpha in _BANDS:
        bare *= 1.0 - alpha
        handles.append(Patch(color=colour, alpha=1.0 - bare, linewidth=0.0, label=label))
    return [*handles, Line2D([], [], color=style.INK, linewidth=style.LINE_WIDTH, label="median")]


def _legend_above(axes: Axes, handles: Sequence[Artist]) -> None:
    axes.legend(
        handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(handles), frameon=False,
        fontsize=style.TICK_SIZE, labelcolor=style.INK, borderaxespad=0.1, handlelength=1.4, columnspacing=1.2,
    )  # fmt: skip


def _zoom(axes: Axes, quantiles: Array, signed: bool) -> None:
    """Show everything, or where a start is far off or a run lost, nine in ten of what comes after the start."""
    settled = quantiles[:, quantiles.shape[1] // 20 :]
    ends = []
    for side, nine, every in ((-1.0, 1, 0), (1.0, 5, 6)) if signed else ((1.0, 5, 6),):
        most = 1.15 * float((side * settled[nine]).max())
        all_runs = 1.03 * float((side * quantiles[every]).max())
        ends.append(side * (all_runs if most < all_runs < 2.5 * most else most))
    low, high = min(*ends, 0.0), max(*ends, 0.0)
    # Zero stays in sight, and errors that are all zero have a height too.
    axes.set_ylim(low - 0.05 * (high - low) * signed, high + 0.05 * (high - low) * signed + 1e-9)


def plot_histograms(ensemble: Ensemble, estimate: int = 0) -> Figure:
    """How many runs have which RMSE of heading and inclination, with median and 95th percentile."""
    each = ensemble.estimates[estimate]
    figure = Figure(figsize=(9.0, 3.9), dpi=style.DPI, facecolor=style.PAPER)
    figure.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, rect=(0.0, 0.0, 1.0, 0.98))
    title = f"{_runs(ensemble)}: how good is {each.filter} on {each.imu}"
    figure.suptitle(title, x=0.015, ha="left", fontsize=style.TITLE_SIZE, color=style.INK, fontweight="bold")
    for axes, (kind, colour) in zip(figure.subplots(1, 2), _KINDS.items(), strict=True):
        _histogram(axes, kind, each.figures[f"{kind}_rmse_deg"], colour)
    return figure


def _histogram(axes: Axes, kind: str, values: Array, colour: str) -> None:
    style.dress(axes)
    # As the ensemble's own statistics, which are those of runs there are.
    middle, p95 = np.quantile(values, [0.5, 0.95], method="inverted_cdf")
    # A few lost runs must not press all others into one bar: they are counted below.
    top = min(float(values.max()), 2.0 * float(p95))
    beyond = int((values > top).sum())
    bins = int(np.clip(2.0 * len(values) ** (1.0 / 3.0), 8, 60))
    lowest = float(values.min())
    span = (lowest, top) if top > lowest else (lowest - 0.5, lowest + 0.5)
    axes.hist(
        values[values <= top],
        bins=bins,
        range=span,
        color=colour,
        alpha=0.75,
        edgecolor=style.PAPER,
        linewidth=0.5,
    )
    _legend_above(
        axes,
        [
            axes.axvline(
                float(value), color=style.INK, linewidth=1.1, linestyle=dashes, label=f"{text} {value:.3g}"
            )
            for value, text, dashes in ((middle, "median", (0, ())), (p95, "95 %", (0, (4.0, 2.0))))
        ],
    )
    style.caption(axes, f"{kind} RMSE", "runs")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    also = f"; {beyond} more beyond {top:.3g}" if beyond else ""
    axes.set_xlabel(f"[deg]{also}", fontsize=style.LABEL_SIZE, color=style.INK)


def plot_tornado(ensemble: Ensemble, estimate: int = 0) -> Figure:
    """Rank correlation of every input with the RMSE of heading and inclination, strongest first.

    Bars that end within the shade are such as chance makes them. Raises ValueError where no number varies.
    """
    each = ensemble.estimates[estimate]
    found = {kind: ensemble.correlations(f"{kind}_rmse_deg", estimate) for kind in _KINDS}
    # "|PATH|", the distance from the median, shares the row of PATH.
    bars = {kind: {name.strip("|"): (name, rho) for name, rho in found[kind].items()} for kind in _KINDS}
    reach = {
        path: max(abs(np.nan_to_num(bars[kind][path][1])) for kind in _KINDS) for path in bars["heading"]
    }
    paths = sorted(reach, key=lambda path: -reach[path])[:_MOST_BARS]
    if not paths:
        raise ValueError("no number varies in this ensemble, so that nothing can drive its errors.")
    figure = Figure(figsize=(9.0, 1.9 + 0.42 * len(paths)), dpi=style.DPI, facecolor=style.PAPER)
    figure.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, rect=(0.0, 0.0, 1.0, 0.98))
    title = f"{_runs(ensemble)}: what drives the errors of {each.filter} on {each.imu}"
    figure.suptitle(title, x=0.015, ha="left", fontsize=style.TITLE_SIZE, color=style.INK, fontweight="bold")
    axes = figure.subplots()
    style.dress(axes)
    chance = 2.0 / np.sqrt(ensemble.runs)
    axes.axvspan(-chance, chance, color=style.GRID, linewidth=0.0)
    for (kind, colour), shift in zip(_KINDS.items(), (-0.19, 0.19), strict=True):
        _bars(axes, [bars[kind][path] for path in paths], shift, colour)
    axes.axvline(0.0, color=style.INK, linewidth=0.9)
    axes.set_yticks(range(len(paths)), paths)
    axes.set_ylim(len(paths) - 0.4, -0.6)
    axes.set_xlim(-1.0, 1.0)
    axes.set_xlabel(
        "rank correlation: 1 where more of it is always worse", fontsize=style.LABEL_SIZE, color=style.INK
    )
    figure.legend(
        handles=_tornado_handles(), loc="outside lower center", ncols=4, frameon=False,
        fontsize=style.TICK_SIZE, labelcolor=style.INK,
    )  # fmt: skip
    return figure


def _bars(axes: Axes, drivers: Sequence[tuple[str, float]], shift: float, colour: str) -> None:
    """A bar for each (name, correlation), hatched where the name is that of a distance."""
    names, values = zip(*drivers, strict=True)
    drawn = axes.barh(
        np.arange(len(names)) + shift, np.nan_to_num(values), height=0.36, color=colour, alpha=_BAR_ALPHA,
        edgecolor=style.PAPER, linewidth=0.0,
    )  # fmt: skip
    for bar, name in zip(drawn, names, strict=True):
        bar.set_hatch(_HATCH if name.startswith("|") else "")


def _tornado_handles() -> list[Artist]:
    kinds = [
        Patch(color=colour, alpha=_BAR_ALPHA, linewidth=0.0, label=f"{kind} RMSE")
        for kind, colour in _KINDS.items()
    ]
    hatched = Patch(facecolor=style.FAINT_INK, edgecolor=style.PAPER, linewidth=0.0, hatch=_HATCH)
    hatched.set_label("by its distance from the median")
    return [*kinds, hatched, Patch(color=style.GRID, linewidth=0.0, label="as chance makes them")]


def _runs(ensemble: Ensemble) -> str:
    name = ensemble.base.name
    count = f"{ensemble.runs} run{'' if ensemble.runs == 1 else 's'}"
    return f"{name}, {count}" if name else count


def plot_ensembles(
    ensembles: Mapping[str, Ensemble], figure: str = "heading_max_deg", limit: float | None = None
) -> Figure:
    """A figure of every run, one row per ensemble under its name, on a logarithmic axis, with the 95th percentile.

    Rows whose 95th percentile is within `limit` (deg or s, as the figure) are told from the others by their colour.
    """
    drawn = Figure(figsize=(9.0, 1.9 + 0.55 * len(ensembles)), dpi=style.DPI, facecolor=style.PAPER)
    drawn.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, rect=(0.0, 0.0, 1.0, 0.98))
    kind, _, rest = figure.partition("_")
    what = f"{kind} error, {rest.removesuffix('_deg')} of each run, deg" if rest.endswith("_deg") else figure
    runs = min(len(ensemble) for ensemble in ensembles.values())
    title = f"{runs} runs each" if limit is None else f"Which stay below {limit:g}? {runs} runs each"
    drawn.suptitle(title, x=0.015, ha="left", fontsize=style.TITLE_SIZE, color=style.INK, fontweight="bold")
    axes = drawn.subplots()
    style.dress(axes)
    axes.set_xscale("log")
    for row, (_, ensemble) in enumerate(ensembles.items()):
        values = np.sort(ensemble.estimates[0].figures[figure])
        p95 = float(np.percentile(values, 95.0))
        good = limit is None or p95 <= limit
        colour = style.XYZ[1] if good else style.XYZ[0]
        # Spread over the row in an order that has nothing to do with the values: the same picture every time.
        height = 0.5 * ((np.arange(len(values)) * 0.6180339887) % 1.0 - 0.5)
        axes.plot(
            values, row + height, linestyle="none", marker="o", markersize=3.2, color=colour, alpha=0.45,
            markeredgewidth=0.0,
        )  # fmt: skip
        axes.plot([p95, p95], [row - 0.38, row + 0.38], color=style.INK, linewidth=1.8)
        axes.annotate(
            f"{p95:.3g}", (p95, row - 0.38), (4, 0), textcoords="offset points", fontsize=style.TICK_SIZE,
            color=style.INK, va="top",
        )  # fmt: skip
    if limit is not None:
        axes.axvline(limit, color=style.BODY, linewidth=1.1, linestyle=(0, (4.0, 2.0)))
    axes.set_yticks(np.arange(len(ensembles)), list(ensembles))
    axes.set_ylim(len(ensembles) - 0.4, -0.6)
    axes.set_xlabel(what + "; the bar holds 95 % of the runs", fontsize=style.LABEL_SIZE, color=style.INK)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    return drawn
