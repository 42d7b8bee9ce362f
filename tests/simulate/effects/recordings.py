"""Turns effects into what they do to a body at rest or on its way; shared by the tests of single effects."""

from __future__ import annotations

from typing import Any

import numpy as np

from kreisel.data.environment import Environment
from kreisel.simulate.imu import Imu
from kreisel.simulate.recorded import Recorded
from kreisel.simulate.trajectories.rest import rest

FIELD = np.array([1.0, 20.0, -44.0])
SENSORS = {"gyro": "gyro_effects", "accel": "accel_effects", "mag_uT": "mag_effects"}


def at_rest(effect: Any, t: np.ndarray, seed: int, sensor: str = "gyro", **imu: Any) -> Recorded:
    """What an IMU at rest with this one effect records."""
    effects = {SENSORS[sensor]: (effect,)}
    return Imu(environment=Environment(field_N_uT=FIELD), **effects, **imu).record(rest().sample(t), seed)


def error_at_rest(effect: Any, t: np.ndarray, seed: int, sensor: str = "gyro", **imu: Any) -> np.ndarray:
    """(n, 3) what the effect added."""
    return at_rest(effect, t, seed, sensor, **imu).errors(sensor)[effect.name]


def first_errors(effect: Any, runs: int, seed: int, t: np.ndarray) -> np.ndarray:
    """(runs, n, 3) what the effect added in each run."""
    return np.array([error_at_rest(effect, t, seed + run) for run in range(runs)])


def uneven(rng: np.random.Generator, count: int) -> np.ndarray:
    """(n,) s: steps of 4 and of 16 ms in random order."""
    return np.cumsum(rng.choice([0.004, 0.016], count))
