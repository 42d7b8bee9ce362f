"""Turns a recording into the stretches in which the sensor lay still, with the mean of each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.data.recording import ImuRecording

_WINDOW = 0.5  # s, over which scatter is judged

# A sensor at rest scatters by its noise alone, and the quietest tenth of the windows shows how much that is. More than
# this many times as much is motion; hands never come near, a table that hums does.
_TIMES_QUIETEST = 3.0

# The quietest windows of a sensor that never rests scatter more than any sensor's noise.
_NOISE_AT_MOST = {"gyro": 0.05, "accel": 0.5}  # rad/s and m/s^2

# Means of neighbouring windows at rest differ by noise alone: by 2 standard errors of a mean as a rule, by 7 at most in
# ten BROAD trials. A slow and smooth turn scatters as little as rest does, but its means run away.
_STEP_AT_MOST = 12.0

# A perfect sensor has no noise at all, and a simulated one may be: this share of _NOISE_AT_MOST is always allowed.
_ALWAYS = 0.02

# rad/s; a steady turn scatters as little as rest. No bias of a gyro that is worth a calibration is larger.
_SLOWEST_TURN = 0.35


class Still(NamedTuple):
    """Stretches of rest, window by window."""

    pose: npt.NDArray[np.int64]  # (w,) number of the stretch
    gyro: Array  # (w, 3) mean of each window, rad/s
    accel: Array  # (w, 3) m/s^2


def still_windows(recording: ImuRecording) -> Still:
    """Windows of half a second in which the sensor was still, less those at either end of each stretch.

    A motion that starts or ends inside a window would not make it scatter enough to be seen: hence the ends. A
    recording that is still from its first sample or to its last keeps that end. NaN rows are left out.
    """
    edges = np.searchsorted(recording.t, np.arange(recording.t[0], recording.t[-1] + 1e-9, _WINDOW))
    edges = edges[np.concatenate([[True], np.diff(edges) >= 4])]
    if len(edges) < 2:
        return Still(np.zeros(0, dtype=np.int64), np.zeros((0, 3)), np.zeros((0, 3)))
    gyro, gyro_error, gyro_quiet = _statistics(recording.gyro, edges, _NOISE_AT_MOST["gyro"])
    accel, accel_error, accel_quiet = _statistics(recording.accel, edges, _NOISE_AT_MOST["accel"])
    still = gyro_quiet & accel_quiet & (np.linalg.norm(gyro, axis=1) < _SLOWEST_TURN)
    steady = _steady(gyro, gyro_error, _NOISE_AT_MOST["gyro"])
    steady &= _steady(accel, accel_error, _NOISE_AT_MOST["accel"])
    goes_on = still[:-1] & still[1:] & steady
    inside = still & np.concatenate([[True], goes_on]) & np.concatenate([goes_on, [True]])
    stretch = np.cumsum(np.concatenate([[True], ~goes_on]))
    return Still(np.unique(stretch[inside], return_inverse=True)[1], gyro[inside], accel[inside])


def _statistics(
    x: Array, edges: npt.NDArray[np.int64], at_most: float
) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
    """Mean (w, 3) between neighbouring edges, its standard error (w,), axes together, and whether it was quiet (w,)."""
    x = x[edges[0] : edges[-1]]
    good: npt.NDArray[np.bool_] = np.asarray(np.isfinite(x).all(axis=1))
    starts = edges[:-1] - edges[0]
    count = np.add.reduceat(good.astype(np.float64), starts)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.add.reduceat(np.where(good[:, None], x, 0.0), starts) / count[:, None]
        # Means are taken off first: the square of gravity would drown the scatter.
        away = np.where(good[:, None], x - np.repeat(mean, np.diff(edges), axis=0), 0.0)
        scatter = np.sqrt(np.add.reduceat(np.sum(away**2, axis=1), starts) / (3.0 * count))
    return (
        mean,
        scatter / np.sqrt(np.maximum(count, 1.0)),
        _quiet(np.where(count >= 4, scatter, np.nan), at_most),
    )


def _steady(mean: Array, error: Array, at_most: float) -> npt.NDArray[np.bool_]:
    """Whether each window's mean goes on in the next one (w - 1,)."""
    step = np.linalg.norm(np.diff(mean, axis=0), axis=1)
    allowed = np.maximum(_STEP_AT_MOST * np.maximum(error[1:], error[:-1]), _ALWAYS * at_most)
    return np.asarray(step <= allowed)


def _quiet(scatter: Array, at_most: float) -> npt.NDArray[np.bool_]:
    seen = scatter[np.isfinite(scatter)]
    if not seen.size:
        return np.zeros(len(scatter), dtype=np.bool_)
    floor = float(np.quantile(seen, 0.1))
    return np.asarray(scatter <= min(at_most, max(_TIMES_QUIETEST * floor, _ALWAYS * at_most)))
