"""Turns a recording and its calibration into a figure of what the sensors read before and after it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.axes3d import Axes3D

from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.data.checks import Array
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording
from kreisel.evaluate.stillness import still_windows
from kreisel.show import style

# More points than these hide each other.
_POINTS = 1500

_BEFORE, _AFTER = style.XYZ[0], style.XYZ[2]
_WIRES = {"color": style.FAINT_INK, "linewidth": 0.5, "alpha": 0.45}


def plot_calibration(
    recording: ImuRecording, calibration: Calibration, gravity: float = STANDARD_GRAVITY
) -> Figure:
    """Readings of `recording` before (vermillion) and after (blue) `calibration`.

    The magnetometer's lie on an ellipsoid about the hard iron, then on a sphere about zero; its strength over time,
    and the accelerometer's in every stretch of rest, become those of the field and of `gravity`, m/s^2.
    Raises ValueError for a calibration of neither.
    """
    mag = calibration.mag if recording.mag_uT is not None else None
    rest = np.zeros((0, 3)) if calibration.accel is None else _rest(recording)
    if mag is None and not len(rest):
        raise ValueError(
            "there is nothing to draw without a calibrated magnetometer that moves or accelerometer that rests. "
            "A gyro's bias is three numbers."
        )
    heights = [*([2.6, 1.0] if mag is not None else []), *([1.0] if len(rest) else [])]
    figure = Figure(figsize=(9.5, 0.8 + 2.1 * sum(heights)), dpi=style.DPI, facecolor=style.PAPER)
    name = f"{recording.name}: " if recording.name else ""
    figure.suptitle(
        f"{name}{'before and after calibration' if name else 'Before and after calibration'}", x=0.015, ha="left",
        fontsize=style.TITLE_SIZE, color=style.INK, fontweight="bold",
    )  # fmt: skip
    figure.set_layout_engine("constrained", h_pad=0.06, w_pad=0.08, rect=(0.0, 0.0, 1.0, 0.99))
    grid = figure.add_gridspec(len(heights), 2, height_ratios=heights)
    if mag is not None:
        _magnetometer(figure, grid, recording, mag)
    if calibration.accel is not None and len(rest):
        axes = figure.add_subplot(grid[len(heights) - 1, :])
        _accelerometer(axes, rest, calibration.accel, gravity)
    return figure


def _rest(recording: ImuRecording) -> Array:
    """Mean specific force (p, 3) of every stretch of rest."""
    still = still_windows(recording)
    means = [still.accel[still.pose == pose].mean(axis=0) for pose in np.unique(still.pose)]
    return np.array(means).reshape(-1, 3)


def _magnetometer(figure: Figure, grid: GridSpec, recording: ImuRecording, triad: TriadCalibration) -> None:
    assert recording.mag_uT is not None  # or nobody asks
    seen = np.isfinite(recording.mag_uT).all(axis=1)
    t, before = recording.t[seen], recording.mag_uT[seen]
    after = triad.undo(before)
    strength = float(np.sqrt(np.mean(np.sum(after**2, axis=1))))
    sphere = strength * _sphere()
    left: Axes3D = figure.add_subplot(grid[0, 0], projection="3d")
    right: Axes3D = figure.add_subplot(grid[0, 1], projection="3d")
    _cloud(left, before, sphere @ triad.matrix.T + triad.bias, triad.bias, _BEFORE)
    _cloud(right, after, sphere, np.zeros(3), _AFTER)
    left.set_title("magnetometer: an ellipsoid about the hard iron", **_CAPTION)
    right.set_title(f"calibrated: a sphere of {strength:.4g} µT about zero", **_CAPTION)
    reach = 0.92 * max(np.abs(before).max(), np.abs(after).max())
    handles, labels = left.get_legend_handles_labels()
    left.legend(
        handles, labels, loc="upper left", frameon=False, fontsize=style.TICK_SIZE, labelcolor=style.INK
    )
    # Seen from where the hard iron lies across the picture, not along the line of sight.
    azimuth = float(np.degrees(np.arctan2(triad.bias[1], triad.bias[0]))) - 90.0
    for axes in (left, right):
        _furnish(axes, reach)
        axes.view_init(elev=18.0, azim=azimuth)
    below = figure.add_subplot(grid[1, :])
    lengths = [np.linalg.norm(x, axis=1) for x in (before, after)]
    style.dress(below)
    for length, colour, label in zip(lengths, (_BEFORE, _AFTER), ("before", "after"), strict=True):
        below.plot(t, length, color=colour, linewidth=style.DENSE_LINE_WIDTH, label=label)
    style.caption(below, "strength of the field", "|m| [µT]")
    below.set_xlabel("time [s]", fontsize=style.LABEL_SIZE, color=style.INK)
    _spreads(below, [float(np.std(length)) for length in lengths], "µT")


def _accelerometer(axes: Axes, means: Array, triad: TriadCalibration, gravity: float) -> None:
    style.dress(axes)
    excess = [np.linalg.norm(x, axis=1) - gravity for x in (means, triad.undo(means))]
    number = np.arange(1, len(means) + 1)
    axes.axhline(0.0, color=style.FAINT_INK, linewidth=0.8)
    for values, colour, label in zip(excess, (_BEFORE, _AFTER), ("before", "after"), strict=True):
        axes.vlines(number, 0.0, values, color=colour, linewidth=1.0, alpha=0.5)
        axes.plot(number, values, "o", color=colour, markersize=5.0, markeredgewidth=0.0, label=label)
    style.caption(axes, f"accelerometer at rest, less gravity of {gravity:.6g} m/s²", "|f| - g [m/s²]")
    axes.set_xlabel("stretch of rest", fontsize=style.LABEL_SIZE, color=style.INK)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    _spreads(axes, [float(np.sqrt(np.mean(values**2))) for values in excess], "m/s²")


def _spreads(axes: Axes, rms: Sequence[float], unit: str) -> None:
    before, after = rms
    axes.set_title(
        f"{before:.2g} {unit} RMS before, {after:.2g} after", loc="right", fontsize=style.TICK_SIZE,
        color=style.FAINT_INK, pad=5.0,
    )  # fmt: skip
    axes.legend(
        loc="upper right", ncols=2, fontsize=style.TICK_SIZE, frameon=True, facecolor=style.PANEL,
        edgecolor=style.GRID, labelcolor=style.INK,
    )  # fmt: skip
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.05 * (high - low), high + 0.3 * (high - low))  # room for the legend


_CAPTION = {"fontsize": style.CAPTION_SIZE, "color": style.INK, "pad": 5.0, "loc": "left"}


def _sphere() -> Array:
    """Points (19, 37, 3) of the unit sphere, ten degrees apart in latitude and longitude."""
    up, around = np.meshgrid(
        np.linspace(-0.5, 0.5, 19) * np.pi, np.linspace(0.0, 2.0, 37) * np.pi, indexing="ij"
    )
    return np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], axis=-1)


def _cloud(axes: Axes3D, points: Array, surface: Array, centre: Array, colour: str) -> None:
    x, y, z = np.moveaxis(surface, -1, 0)
    axes.plot_wireframe(x, y, z, rstride=3, cstride=3, **_WIRES)
    shown = points[:: max(1, len(points) // _POINTS)]
    axes.scatter(*shown.T, s=3.0, color=colour, alpha=0.55, linewidths=0.0, depthshade=False)
    iron = np.stack([np.zeros(3), centre])
    if centre.any():
        label = f"hard iron, {np.linalg.norm(centre):.3g} µT from zero"
        axes.plot(
            *iron.T, color=style.IMU[0], linewidth=2.2, marker="o", markersize=6.0, markevery=[1], label=label
        )
    axes.plot([0.0], [0.0], [0.0], "+", color=style.INK, markersize=9.0, markeredgewidth=1.6)


def _furnish(axes: Axes3D, reach: float) -> None:
    axes.set_proj_type("ortho")
    axes.set_box_aspect((1.0, 1.0, 1.0), zoom=1.3)
    for axis, name in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz", strict=True):
        axis.set_pane_color(style.PANEL)
        axis.line.set_color(style.GRID_IN_SPACE)
        axis._axinfo["grid"].update(color=style.GRID_IN_SPACE, linewidth=0.5)
        axis.set_label_text(f"{name} [µT]", fontsize=style.TICK_SIZE, color=style.INK)
        axis.set_tick_params(labelsize=style.TICK_SIZE - 1.0, labelcolor=style.FAINT_INK, pad=-1.0)
    axes.locator_params(nbins=5)
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach, reach))
