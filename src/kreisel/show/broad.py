"""Turns scores on the BROAD benchmark into a figure: one line per trial, one mark per filter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from kreisel.show import style
from kreisel.study.broad import Score, mean

_PANELS = (("total_rmse_deg", "as it comes"), ("free_total_rmse_deg", "heading offset of each trial removed"))

# Told apart by shape as well as colour; the benchmark's own order of filters decides who gets which.
_LOOKS = tuple(zip(("o", "s", "D", "^", "v", "P", "X"), (style.BODY, *style.OTHERS), strict=True))


def plot_broad(scores: Sequence[Score]) -> Figure:
    """Total error of each filter in each trial (RMSE, deg, on a logarithmic axis), their means below.

    Left as the benchmark counts it, right with each trial's constant heading offset removed.
    """
    filters, trials = (list(dict.fromkeys(getattr(s, name) for s in scores)) for name in ("filter", "trial"))
    figure = Figure(figsize=(10.0, 2.0 + 0.34 * len(trials)), dpi=style.DPI, facecolor=style.PAPER)
    figure.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, rect=(0.0, 0.0, 1.0, 0.99))
    figure.suptitle(
        "Total attitude error on BROAD", x=0.015, ha="left", fontsize=style.TITLE_SIZE, color=style.INK,
        fontweight="bold",
    )  # fmt: skip
    panels = list(figure.subplots(1, 2, sharex=True, sharey=True))
    # A row left empty sets the means off.
    rows = {trial: k for k, trial in enumerate(trials)}
    bottom = len(trials) + 0.5
    for axes, (name, text) in zip(panels, _PANELS, strict=True):
        _dress(axes, text)
        axes.axhline(len(trials) - 0.25, color=style.FAINT_INK, linewidth=0.7)
        for k, filter in enumerate(filters):
            own = [score for score in scores if score.filter == filter]
            y = [*(rows[score.trial] for score in own), bottom]
            x = [*(getattr(score, name) for score in own), getattr(mean(own), name)]
            _marks(axes, np.array(x), np.array(y), k, filter)
    panels[0].set_yticks([*rows.values(), bottom], [*map(_readable, trials), "mean"])
    panels[0].set_ylim(bottom + 0.7, -0.7)
    figure.legend(
        handles=[_handle(k, filter) for k, filter in enumerate(filters)],
        loc="outside lower center",
        ncols=len(filters),
        frameon=False,
        fontsize=style.LABEL_SIZE,
        labelcolor=style.INK,
    )
    return figure


def _dress(axes: Axes, text: str) -> None:
    style.dress(axes)
    style.caption(axes, text, "")
    axes.set_xscale("log")
    axes.set_xlabel("total RMSE [deg]", fontsize=style.LABEL_SIZE, color=style.INK)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(which="minor", color=style.GRID)


def _marks(axes: Axes, x: np.ndarray, y: np.ndarray, k: int, filter: str) -> None:
    marker, colour = _LOOKS[k % len(_LOOKS)]
    axes.plot(
        x, y, linestyle="none", marker=marker, color=colour, markersize=7.0, markeredgecolor=style.PAPER,
        markeredgewidth=0.8, alpha=0.95, label=filter, zorder=3.0 - 0.01 * k,
    )  # fmt: skip


def _handle(k: int, filter: str) -> Line2D:
    marker, colour = _LOOKS[k % len(_LOOKS)]
    return Line2D([], [], linestyle="none", marker=marker, color=colour, markersize=7.0, label=filter)


def _readable(trial: str) -> str:
    return trial.replace("_", " ")
