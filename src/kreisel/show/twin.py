"""Turns a real recording and its alignment into a figure of both, axis by axis, and of its liveliest seconds."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kreisel.data.checks import Array
from kreisel.data.recording import ImuRecording
from kreisel.evaluate.align import Alignment
from kreisel.show import series, style

_WINDOW = 2.0  # s, of the close-up
_SENSORS = (("gyro", "rad/s"), ("accel", "m/s²"))


def plot_twin(recording: ImuRecording, found: Alignment) -> Figure:
    """Readings of `recording` (broad, pale) under those of its simulated twin (thin, dark), with RMSE and correlation.

    Left all of it, right the two seconds in which the body turned fastest.
    """
    figure = Figure(figsize=(11.5, 11.0), dpi=style.DPI, facecolor=style.PAPER)
    figure.set_layout_engine("constrained", h_pad=0.05, w_pad=0.08, hspace=0.02, rect=(0.0, 0.0, 1.0, 0.99))
    name = f"{recording.name}: the" if recording.name else "The"
    title = f"{name} real IMU and its simulated twin"
    figure.suptitle(title, x=0.015, ha="left", fontsize=style.TITLE_SIZE, color=style.INK, fontweight="bold")
    panels = figure.subplots(6, 2, sharex="col", width_ratios=[1.7, 1.0], squeeze=False)
    first, last = liveliest(recording.t, found.twin.gyro)
    for k, (whole, near) in enumerate(panels):
        sensor, axis = _SENSORS[k // 3], k % 3
        _draw(whole, recording, found, sensor, axis, slice(None))
        _draw(near, recording, found, sensor, axis, slice(first, last))
        whole.axvspan(recording.t[first], recording.t[last - 1], color=style.GRID, alpha=0.7, zorder=0.5)
        _caption(whole, near, found, sensor, axis)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]", fontsize=style.LABEL_SIZE, color=style.INK)
    handles, labels = panels[0, 1].get_legend_handles_labels()
    del labels  # they are the handles' own
    series.legend(panels[0, 1], handles)
    return figure


def liveliest(t: Array, rate: Array) -> tuple[int, int]:
    """First and one past the last row of those two seconds in which `rate` (n, 3) is largest; NaN counts as rest."""
    energy = np.append(0.0, np.cumsum(np.nan_to_num(np.square(rate)).sum(axis=1)))
    ends = np.searchsorted(t, t + _WINDOW, side="right")
    first = int(np.argmax(energy[ends] - energy[:-1]))
    return first, max(int(ends[first]), first + 2)


def _draw(
    axes: Axes, recording: ImuRecording, found: Alignment, sensor: tuple[str, str], axis: int, rows: slice
) -> None:
    style.dress(axes)
    real, twin = (getattr(source, sensor[0])[rows, axis : axis + 1] for source in (recording, found.twin))
    t = recording.t[rows]
    pale = {"alpha": 0.45, "linewidth": 2.6, "zorder": 2.0}
    series.draw_components(axes, t, real, ["real"], colours=[style.XYZ[axis]], **pale)
    dark = {"linewidth": 0.9, "alpha": 1.0, "zorder": 3.0}
    series.draw_components(axes, t, twin, ["twin"], colours=[style.XYZ_DARK[axis]], **dark)
    series.fit(axes, t, real, twin)


def _caption(whole: Axes, near: Axes, found: Alignment, sensor: tuple[str, str], axis: int) -> None:
    name, unit = sensor
    agreement = getattr(found, name)
    style.caption(whole, f"{name} {'xyz'[axis]}", f"[{unit}]")
    numbers = f"RMSE {agreement.rmse[axis]:.3g} {unit}, correlation {agreement.correlation[axis]:.4f}"
    whole.set_title(numbers, loc="right", fontsize=style.TICK_SIZE, color=style.FAINT_INK, pad=5.0)
    if name == "gyro" and axis == 0:
        near.set_title(
            "the liveliest two seconds", loc="left", fontsize=style.CAPTION_SIZE, color=style.INK, pad=5.0
        )
