"""Turns a Motion or an ImuRecording into figures of its quantities over time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.show import series, style

_IN_N = ("x east", "y north", "z up")
_IN_B = ("x forward", "y left", "z up")

# A step between neighbours beyond this is a wrap, or the flip at phi_y = +-90 deg, rather than a turn.
_WRAP_DEG = 120.0


def plot_linear(motion: Motion) -> Figure:
    """Position, velocity and acceleration of the body in N over time, notes of the motion marked."""
    figure, panels = style.stacked(3, _title(motion.name, "where the body is and how it moves"))
    rows = (
        ("position in N", "p [m]", motion.p_NB),
        ("velocity in N", "v [m/s]", motion.v_NB),
        ("acceleration in N, without gravity", "a [m/s²]", motion.a_NB),
    )
    for axes, (text, quantity, values) in zip(panels, rows, strict=True):
        style.caption(axes, text, quantity)
        lines = series.draw_components(axes, motion.t, values, _IN_N)
        series.fit(axes, motion.t, values)
    series.legend(panels[0], [*lines, *series.mark_notes(panels, motion.t, motion.notes)])
    return figure


def plot_angular(motion: Motion) -> Figure:
    """Euler angles (deg), angular rate and angular acceleration of the body in B over time.

    Angles are drawn from -180 to 180 degrees without a line where they wrap; notes of the motion are marked.
    """
    figure, panels = style.stacked(3, _title(motion.name, "how the body is turned and how it turns"))
    angles = np.rad2deg(motion.euler)
    style.caption(panels[0], "Euler angles, intrinsic z-y-x", "φ [deg]")
    labels = ("φx about x", "φy about y", "φz about z")
    series.legend(panels[0], series.draw_components(panels[0], motion.t, angles, labels, jump=_WRAP_DEG))
    series.fit(panels[0], motion.t, angles)
    series.degree_ticks(panels[0])
    rows = (
        ("angular rate in body axes", "ω [rad/s]", "[deg/s]", motion.omega_NB_B),
        ("angular acceleration in body axes", "α [rad/s²]", "[deg/s²]", motion.alpha_NB_B),
    )
    for axes, (text, quantity, in_degrees, values) in zip(panels[1:], rows, strict=True):
        style.caption(axes, text, quantity)
        lines = series.draw_components(axes, motion.t, values, _IN_B)
        series.fit(axes, motion.t, values)
        series.degrees_on_the_right(axes, in_degrees)
    series.legend(panels[1], [*lines, *series.mark_notes(panels, motion.t, motion.notes)])
    return figure


def plot_imu(recording: ImuRecording, ideal: ImuRecording | None = None) -> Figure:
    """Angular rate, specific force and, where there is one, magnetic field in sensor axes over time.

    Missing samples are gaps in the lines and ticks on the floor of the panel. With `ideal`, its readings are
    drawn dark over the pale ones of `recording`, at its own times.
    """
    rows = [
        ("angular rate in sensor axes", "gyro [rad/s]", "gyro"),
        ("specific force in sensor axes, +g up at rest", "accel [m/s²]", "accel"),
        ("magnetic field in sensor axes", "mag [µT]", "mag_uT"),
    ]
    rows = rows if recording.mag_uT is not None else rows[:2]
    what = "what the IMU reads" if ideal is None else "what the IMU reads, over what a perfect one would"
    figure, panels = style.stacked(len(rows), _title(recording.name, what))
    for axes, (text, quantity, name) in zip(panels, rows, strict=True):
        style.caption(axes, text, quantity)
        _readings(axes, recording, ideal, name)
    series.degrees_on_the_right(panels[0], "[deg/s]")
    return figure


def _readings(axes: Axes, recording: ImuRecording, ideal: ImuRecording | None, name: str) -> None:
    values: Array = getattr(recording, name)
    expected: Array | None = getattr(ideal, name) if ideal is not None else None
    handles: list[Artist] = []
    pale: dict[str, Any] = {} if expected is None else {"alpha": 0.4, "linewidth": 2.2}
    handles += series.draw_components(axes, recording.t, values, zorder=2.0, **pale)
    if expected is not None and ideal is not None:
        t = ideal.t + (ideal.t0_ns - recording.t0_ns) * 1e-9
        series.draw_components(axes, t, expected, colours=style.XYZ_DARK, linewidth=0.8, zorder=3.0)
        handles.append(Line2D([], [], color=style.INK, linewidth=0.9, label="ideal"))
    # A magnetometer slower than the gyro has no sample in most rows, and none of them is missing.
    missing = series.mark_missing(axes, recording.t, values) if name != "mag_uT" else None
    series.fit(axes, recording.t, values, *([] if expected is None else [expected]))
    series.legend(axes, [*handles, missing] if missing else handles)


def _title(name: str, what: str) -> str:
    return f"{name}: {what}" if name else what[0].upper() + what[1:]
