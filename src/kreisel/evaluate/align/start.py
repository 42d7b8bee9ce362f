"""Turns a recording and a trajectory into a rough clock offset and turn of the sensor, from any start."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kreisel.data.checks import Array
from kreisel.evaluate.align.confirmed import Confirmed, confirmed
from kreisel.evaluate.align.model import SENSORS, Scene
from kreisel.maths.kinematics import specific_force
from kreisel.maths.rotations import nearest_rotation

# s: finest step of the clock search; rates that matter last longer than twice this.
_STEP = 5e-3
_MOST_SAMPLES = 50_000

# rad/s and m/s^2, RMS about the mean: less than this is no motion to align by.
_STILL = {"gyro": 0.02, "accel": 0.05}

# Sum of the singular values of two cross-covariances, 1 each for equal signals: noise of a hundred
# independent samples reaches 0.3.
_ALIKE = 0.4

# Pull towards the mount as it was given: decides what no motion shows and moves nothing that one does.
_PULL = 1e-3


class Tracks(NamedTuple):
    """Both sides on one even grid of time, sensor by sensor."""

    step: float  # s
    first: int  # row of `seen` at the time of row 0 of `read`
    read: dict[str, Array]  # sensor -> (n, 3) readings
    seen: dict[str, Array]  # sensor -> (m, 3) what the body's origin feels, in B


class Start(NamedTuple):
    """A first guess, and what of the motion it rests on."""

    clock: float  # s, by which the stamps are ahead
    R_BS: Array  # (3, 3)
    confirmed: Confirmed


def rough_start(scene: Scene, R_BS: Array, *, turned: bool, search: float) -> Start:
    """The clock offset, at most `search` s either way, and where `turned` the rotation at which both sides agree best.

    At each offset the agreement is what is left of the correlation after the best rotation (the gain of Wahba's
    problem), so that neither has to be known first.
    Raises ValueError where nothing overlaps, nothing moves or hardly anything agrees.
    """
    tracks = _tracks(scene, search)
    lags = np.arange(-int(search / tracks.step), int(search / tracks.step) + 1)
    gains = np.array([_agreement(tracks, int(lag), None if turned else R_BS) for lag in lags])
    best = int(np.argmax(gains))
    if not gains[best] > _ALIKE:
        raise ValueError(strangers(search))
    read, seen = _matched(tracks, int(lags[best]))
    lag, turn = int(lags[best]), R_BS
    if turned:
        turn = _turn(read, seen, R_BS)
    return Start(lag * tracks.step, turn, confirmed(_in_B(read, turn), seen))


def strangers(search: float) -> str:
    """What to tell of a recording and a trajectory that have nothing in common."""
    return (
        "recording and trajectory do not show the same motion: they may be of different trials, or their clocks more "
        f"than {search:g} s apart."
    )


def _in_B(read: dict[str, Array], R_BS: Array) -> dict[str, Array]:
    return {sensor: x @ R_BS.T for sensor, x in read.items()}


def _tracks(scene: Scene, search: float) -> Tracks:
    first, last = scene.trajectory.span
    begin, end = max(first, scene.stamps[0] - search), min(last, scene.stamps[-1] + search)
    if not end - begin > 0.0:
        raise ValueError(
            f"recording and trajectory do not overlap in time: the recording spans {scene.stamps[0]:.9g} to "
            f"{scene.stamps[-1]:.9g} s on the trajectory's clock, the trajectory {first:.9g} to {last:.9g} s."
        )
    step = max(_STEP, (end - begin) / _MOST_SAMPLES)
    t = begin + step * np.arange(int((end - begin) / step) + 1)
    motion = scene.trajectory.sample(np.minimum(t, last))
    g_N = scene.gravity * scene.down_N
    seen = {"gyro": motion.omega_NB_B, "accel": specific_force(motion.a_NB, motion.R_NB, g_N)}
    for sensor, least in _STILL.items():
        if _spread(seen[sensor]) > least:
            break
    else:
        raise ValueError(
            f"too little motion to align by: the body turns at {_spread(seen['gyro']):.2g} rad/s RMS and its specific "
            f"force varies by {_spread(seen['accel']):.2g} m/s^2. Turn it about all axes for some seconds."
        )
    ahead = max(0, int(np.ceil((scene.stamps[0] - begin) / step)))
    grid = t[(t >= scene.stamps[0]) & (t <= scene.stamps[-1])]
    read = {sensor: _interpolated(grid, scene, sensor) for sensor in SENSORS}
    return Tracks(step, ahead, read, seen)


def _interpolated(grid: Array, scene: Scene, sensor: str) -> Array:
    readings = scene.readings[sensor]
    good = np.isfinite(readings).all(axis=1)
    if not good.any():
        raise ValueError(f"the recording has no {sensor} sample: every row has a NaN.")
    return np.stack([np.interp(grid, scene.stamps[good], column[good]) for column in readings.T], axis=1)


def _matched(tracks: Tracks, lag: int) -> tuple[dict[str, Array], dict[str, Array]]:
    """Rows of both sides that belong together where the stamps are `lag` steps ahead."""
    n, m = len(tracks.read["gyro"]), len(tracks.seen["gyro"])
    shift = tracks.first - lag
    low, high = max(0, -shift), min(n, m - shift)
    read = {sensor: x[low : max(high, low)] for sensor, x in tracks.read.items()}
    return read, {sensor: x[low + shift : max(high, low) + shift] for sensor, x in tracks.seen.items()}


def _agreement(tracks: Tracks, lag: int, R_BS: Array | None) -> float:
    read, seen = _matched(tracks, lag)
    # A short overlap agrees by chance.
    if 2 * len(read["gyro"]) < min(len(tracks.read["gyro"]), len(tracks.seen["gyro"])):
        return -np.inf
    return sum(_gain(_covariance(read[sensor], seen[sensor]), R_BS) for sensor in SENSORS)


def _covariance(read: Array, seen: Array) -> Array:
    """Cross-covariance (3, 3) over the lengths of both; zero where one of them does not change."""
    a, b = read - read.mean(axis=0), seen - seen.mean(axis=0)
    size = np.sqrt(np.square(a).sum() * np.square(b).sum())
    return np.asarray(a.T @ b / size) if size > 0.0 else np.zeros((3, 3))


def _gain(covariance: Array, R_BS: Array | None) -> float:
    """Correlation after the best rotation, or after the one given."""
    if R_BS is not None:
        return float(np.sum(R_BS.T * covariance))
    singular = np.linalg.svd(covariance, compute_uv=False)
    return float(singular[0] + singular[1] + np.sign(np.linalg.det(covariance)) * singular[2])


def _turn(read: dict[str, Array], seen: dict[str, Array], R_BS: Array) -> Array:
    """R_BS by Wahba's problem: rates about their mean, for a bias, and forces as they are, for gravity."""
    rates = _covariance(read["gyro"], seen["gyro"])
    a, b = read["accel"], seen["accel"]
    forces = a.T @ b / np.sqrt(np.square(a).sum() * np.square(b).sum())
    total = rates + forces
    return nearest_rotation(total.T + _PULL * R_BS)


def _spread(x: Array) -> float:
    return float(np.sqrt(np.square(x - x.mean(axis=0)).sum(axis=1).mean()))
