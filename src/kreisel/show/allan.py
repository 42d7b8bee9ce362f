"""Turns a fitted Allan deviation into the usual figure: log-log curves with their asymptotes."""

from __future__ import annotations

from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterMathtext, LogLocator, NullFormatter

from kreisel.data.checks import Array
from kreisel.evaluate.allan import TERMS, AllanFit
from kreisel.evaluate.noise_units import COEFFICIENT, READING
from kreisel.show import style

_SENSOR = {"gyro": "gyroscope", "accel": "accelerometer", "mag": "magnetometer"}

_FLOOR = float(np.sqrt(2.0 * np.log(2.0) / np.pi))

# An asymptote is drawn where its term is at least this share of the model, and a little beyond.
_SHARE = 0.15

# Share of the drawn asymptote at which its name stands.
_NAME_AT = {"N": 0.82, "B": 0.2, "K": 0.16}
_ROOM = 1.8  # a name needs so many times the lowest value on paper


def plot_allan(fit: AllanFit) -> Figure:
    """Allan deviation of the three axes over averaging time, 95 % bands, the model and its asymptotes.

    The asymptotes are those of the root mean square over the axes that show the term; each bears its value.
    """
    figure = Figure(figsize=(9.0, 6.2), dpi=style.DPI, facecolor=style.PAPER)
    figure.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, rect=(0.0, 0.0, 1.0, 0.99))
    title = f"Allan deviation of the {_SENSOR[fit.sensor]}"
    figure.suptitle(
        f"{fit.name}: {title}" if fit.name else title, x=0.015, ha="left", fontsize=style.TITLE_SIZE,
        color=style.INK, fontweight="bold",
    )  # fmt: skip
    axes = figure.subplots()
    style.dress(axes)
    hours = fit.samples / fit.rate_hz / 3600.0
    length = f"{hours:.3g} h" if hours >= 1.0 else f"{60.0 * hours:.3g} min"
    shown, other = READING[fit.sensor]
    style.caption(
        axes, f"{length} at {fit.rate_hz:.4g} Hz, overlapping clusters", f"deviation [{shown.name}]"
    )
    _curves(axes, fit, shown.factor)
    _asymptotes(axes, fit, shown.factor)
    _scales(axes, other.name, other.factor / shown.factor)
    axes.legend(
        loc="upper right", fontsize=style.TICK_SIZE, frameon=True, facecolor=style.PANEL, edgecolor=style.GRID,
        labelcolor=style.INK, prop={"family": "monospace", "size": style.TICK_SIZE}, title=_heading(fit),
        title_fontproperties={"family": "monospace", "size": style.TICK_SIZE}, alignment="left",
    )  # fmt: skip
    return figure


def _curves(axes: Axes, fit: AllanFit, factor: float) -> None:
    model = fit.model(fit.tau)
    for k, (axis, colour, dark) in enumerate(zip("xyz", style.XYZ, style.XYZ_DARK, strict=True)):
        axes.fill_between(
            fit.tau, fit.low[:, k] * factor, fit.high[:, k] * factor, color=colour, alpha=0.13, linewidth=0.0
        )
        axes.plot(
            fit.tau, model[:, k] * factor, color=dark, linewidth=0.8, linestyle=(0, (4.0, 2.0)), zorder=3.5
        )
        axes.plot(
            fit.tau, fit.deviation[:, k] * factor, color=colour, linewidth=1.5, marker="o", markersize=3.0,
            markeredgewidth=0.0, label=_values(fit, axis, k), zorder=3.0,
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = float((fit.deviation * factor).min()), float((fit.deviation * factor).max())
    axes.set_ylim(0.35 * low, 2.0 * high)
    axes.set_xlim(0.8 * fit.tau[0], 1.25 * fit.tau[-1])


def _heading(fit: AllanFit) -> str:
    units = [COEFFICIENT[fit.sensor][term][0].name for term in TERMS]
    # As wide as a handle of the legend and the axis's letter.
    return " " * 6 + "".join(f"{f'{term} {unit}':>18}" for term, unit in zip(TERMS, units, strict=True))


def _values(fit: AllanFit, axis: str, k: int) -> str:
    cells = []
    for term in TERMS:
        value = getattr(fit, term).value[k] * COEFFICIENT[fit.sensor][term][0].factor
        cells.append(f"{f'{value:.3g}' if np.isfinite(value) else 'not visible':>18}")
    return axis + "".join(cells)


def _asymptotes(axes: Axes, fit: AllanFit, factor: float) -> None:
    tau = np.geomspace(fit.tau[0], fit.tau[-1], 400)
    lines: dict[str, Array] = {}
    for term, line in (("N", 1.0 / np.sqrt(tau)), ("B", np.full(400, _FLOOR)), ("K", np.sqrt(tau / 3.0))):
        values = getattr(fit, term).value
        if np.isfinite(values).any():
            lines[term] = line * np.sqrt(np.nanmean(values**2)) * factor
    total = np.sqrt(sum(line**2 for line in lines.values()))
    for term, line in lines.items():
        drawn = np.where(line > _SHARE * total, line, np.nan)
        axes.plot(tau, drawn, color=style.FAINT_INK, linewidth=1.0, linestyle=(0, (1.0, 1.6)), zorder=2.5)
        _name(axes, term, tau, drawn)


def _name(axes: Axes, term: str, tau: Array, line: Array) -> None:
    """The term's name below its line, along it, towards the end that no curve hides."""
    seen = np.flatnonzero(line > _ROOM * axes.get_ylim()[0])
    at = seen[int(_NAME_AT[term] * (len(seen) - 1))]
    slope = {"N": -0.5, "B": 0.0, "K": 0.5}[term]
    text = {"N": "N: white noise", "B": "0.664 B: bias instability", "K": "K: random walk"}[term]
    axes.annotate(
        text, (tau[at], line[at]), xytext=(0.0, -6.0), textcoords="offset points", ha="center", va="top",
        fontsize=style.TICK_SIZE, color=style.FAINT_INK, rotation=_angle(axes, slope), rotation_mode="anchor",
        zorder=4.0,
    )  # fmt: skip


def _angle(axes: Axes, slope: float) -> float:
    """Degrees on paper of a line of `slope` decades per decade."""
    box = axes.get_position()
    figure = axes.get_figure(root=True)
    assert figure is not None
    width, height = figure.get_figwidth() * box.width, figure.get_figheight() * box.height
    (x0, x1), (y0, y1) = (np.log10(axes.get_xlim()), np.log10(axes.get_ylim()))
    return float(np.degrees(np.arctan2(slope * height / (y1 - y0), width / (x1 - x0))))


def _scales(axes: Axes, other: str, factor: float) -> None:
    axes.set_xlabel("averaging time τ [s]", fontsize=style.LABEL_SIZE, color=style.INK)
    axes.grid(True, which="minor", color=style.GRID, linewidth=0.35)
    times, over = partial(np.multiply, factor), partial(np.multiply, 1.0 / factor)
    right = axes.secondary_yaxis("right", functions=(times, over))
    right.set_ylabel(f"[{other}]", fontsize=style.LABEL_SIZE, color=style.INK)
    right.tick_params(which="both", labelsize=style.TICK_SIZE, labelcolor=style.INK, color=style.FAINT_INK)
    for spine in right.spines.values():
        spine.set_visible(False)
    for scale in (axes.xaxis, axes.yaxis, right.yaxis):
        scale.set_major_locator(LogLocator(10.0, numticks=12))
        scale.set_major_formatter(LogFormatterMathtext())
        scale.set_minor_formatter(NullFormatter())
