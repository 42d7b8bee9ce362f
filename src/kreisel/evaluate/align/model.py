"""Turns a trajectory and parameters into what the sensors should read, and the change of that with each parameter.

gyro  = diag(scale) R_SB omega_NB_B + bias
accel = diag(scale) R_SB (R_BN (a_NB - g_N) + omega x (omega x p_BS) + alpha x p_BS) + bias, equation (9)

both at the trajectory's time u of the sample stamped s = u + clock + drift (u - u_0), u_0 that of the first stamp.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Trajectory
from kreisel.evaluate.align.confirmed import ALL, Confirmed
from kreisel.evaluate.align.parameters import Parameters
from kreisel.maths.rotations import exp_so3, skew

SENSORS = ("gyro", "accel")

# s: the accelerometer's derivative is taken over it; 1e-4 of the derivative is lost at 40 Hz, six digits stay.
_APART = 1e-4

# Rows whose derivatives are held in memory at once.
_BLOCK = 16384


class Scene(NamedTuple):
    """What does not change while parameters are sought."""

    stamps: Array  # (n,) s, of the recording, counted from the trajectory's t0_ns
    readings: dict[str, Array]  # sensor -> (n, 3), NaN where missing
    trajectory: Trajectory
    gravity: float  # m/s^2
    down_N: Array  # (3,) unit vector
    confirmed: Confirmed = ALL  # derivatives are taken of this part of the motion

    @property
    def start(self) -> float:
        """Stamp at which the clock offsets hold."""
        return float(self.stamps[0])


class Block(NamedTuple):
    """Some rows of one sensor, seen from given parameters."""

    rows: npt.NDArray[np.int64]  # (m,) of the recording
    expected: Array  # (m, 3) reading
    columns: dict[str, Array]  # parameter -> (m, 3, k), its derivative


def trajectory_times(stamps: Array, start: float, clock: float, drift: float) -> Array:
    """Time on the trajectory's clock (n,) s of samples stamped `stamps` (n,)."""
    return start - clock + (stamps - start) / (1.0 + drift)


def usable_rows(scene: Scene, sensor: str, at: Parameters) -> npt.NDArray[np.int64]:
    """Rows that have a reading and lie inside the trajectory, with room to differentiate."""
    first, last = scene.trajectory.span
    u = _times(scene, sensor, at)
    inside = (u >= first + _APART) & (u <= last - _APART)
    return np.flatnonzero(inside & np.isfinite(scene.readings[sensor]).all(axis=1))


def blocks(scene: Scene, sensor: str, at: Parameters) -> Iterator[Block]:
    """The usable rows of a sensor, some thousand at a time, with expected readings and their derivatives."""
    rows = usable_rows(scene, sensor, at)
    make = _gyro if sensor == "gyro" else _accel
    for first in range(0, len(rows), _BLOCK):
        some = rows[first : first + _BLOCK]
        yield make(scene, some, _times(scene, sensor, at)[some], at)


def expected_readings(scene: Scene, sensor: str, at: Parameters) -> Array:
    """What the sensor should read (n, 3) at every stamp; NaN where the trajectory has no motion."""
    first, last = scene.trajectory.span
    u = _times(scene, sensor, at)
    out = np.full((len(u), 3), np.nan)
    rows = np.flatnonzero((u >= first) & (u <= last))
    for k in range(0, len(rows), _BLOCK):
        some = rows[k : k + _BLOCK]
        motion = scene.trajectory.sample(u[some])
        out[some] = _expected(scene, sensor, motion, at)
    return out


def _times(scene: Scene, sensor: str, at: Parameters) -> Array:
    clock = getattr(at, f"{sensor}_clock")
    return trajectory_times(scene.stamps, scene.start, float(clock[0]), float(at.drift[0]))


def _expected(scene: Scene, sensor: str, motion: Motion, at: Parameters) -> Array:
    seen = motion.omega_NB_B if sensor == "gyro" else _force_B(scene, motion, at)
    return np.asarray(getattr(at, f"{sensor}_scale") * (seen @ at.R_BS) + getattr(at, f"{sensor}_bias"))


def _gyro(scene: Scene, rows: npt.NDArray[np.int64], u: Array, at: Parameters) -> Block:
    motion = scene.trajectory.sample(u)
    to_S = scene.confirmed.rate @ at.R_BS
    slope = at.gyro_scale * (motion.alpha_NB_B @ to_S)
    columns = _shared_columns("gyro", motion.omega_NB_B @ to_S, slope, scene.stamps[rows] - scene.start, at)
    return Block(rows, _expected(scene, "gyro", motion, at), columns)


def _accel(scene: Scene, rows: npt.NDArray[np.int64], u: Array, at: Parameters) -> Block:
    motion = scene.trajectory.sample(u)
    force, confirmed = _force_B(scene, motion, at), scene.confirmed
    before, after = (_force_B(scene, scene.trajectory.sample(u + h), at) for h in (-_APART, _APART))
    slope = at.accel_scale * ((after - before) / (2.0 * _APART) @ confirmed.change @ at.R_BS)
    since = scene.stamps[rows] - scene.start
    columns = _shared_columns("accel", force @ confirmed.force @ at.R_BS, slope, since, at)
    W, A = skew(motion.omega_NB_B @ confirmed.rate), skew(motion.alpha_NB_B @ confirmed.rate)
    to_S = at.accel_scale[:, None] * at.R_BS.T
    columns["lever_arm"] = to_S @ (W @ W + A)
    columns["tilt"] = to_S @ np.swapaxes(motion.R_NB, 1, 2) @ _down_slopes(scene, at)
    return Block(rows, at.accel_scale * (force @ at.R_BS) + at.accel_bias, columns)


def _shared_columns(sensor: str, seen: Array, slope: Array, since: Array, at: Parameters) -> dict[str, Array]:
    """Derivatives by what both sensors have; `seen` is free of bias and scale, `slope` is d expected / du."""
    n, scale = len(seen), getattr(at, f"{sensor}_scale")
    diagonal = np.zeros((n, 3, 3))
    diagonal[:, range(3), range(3)] = seen
    return {
        "rotation": scale[:, None] * skew(seen),
        f"{sensor}_bias": np.broadcast_to(np.eye(3), (n, 3, 3)),
        f"{sensor}_scale": diagonal,
        f"{sensor}_clock": -slope[:, :, None],
        "drift": -(slope * since[:, None])[:, :, None] / (1.0 + at.drift[0]) ** 2,
    }


def _force_B(scene: Scene, motion: Motion, at: Parameters) -> Array:
    """Specific force (n, 3) in body axes at the lever arm."""
    omega, p_BS = motion.omega_NB_B, at.lever_arm
    free_N = motion.a_NB - scene.gravity * _down(scene, at.tilt)
    force_B = np.einsum("nji,nj->ni", motion.R_NB, free_N)
    force_B += np.cross(omega, np.cross(omega, p_BS)) + np.cross(motion.alpha_NB_B, p_BS)
    return np.asarray(force_B)


def _down(scene: Scene, tilt: Array) -> Array:
    return np.asarray(exp_so3(np.append(tilt, 0.0)) @ scene.down_N)


def _down_slopes(scene: Scene, at: Parameters) -> Array:
    """d(-g_N) / d tilt (3, 2), to first order in the tilt, which is small."""
    down = _down(scene, at.tilt)
    return np.asarray(scene.gravity * skew(down)[:, :2])
