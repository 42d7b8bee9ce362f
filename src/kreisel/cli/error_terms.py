"""Turns what a simulated IMU got wrong, term by term, into arrays in a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.atomic import replacing
from kreisel.data.checks import Array
from kreisel.data.frames import WORLDS, from_enu_flu
from kreisel.data.increments import ImuIncrements
from kreisel.data.recording import ImuRecording
from kreisel.simulate.recorded import Recorded

_SENSORS = ("gyro", "accel", "mag_uT", "dtheta", "dv")


def write_error_terms(path: Path, recorded: Recorded, world: str) -> None:
    """Write the ideal readings, the biases and every error term of `recorded` to an NPZ archive, in `world`.

    Its arrays: t; ideal_SENSOR and SENSOR_error_EFFECT (n, 3), where SENSOR is gyro, accel or mag_uT, of increments
    dtheta or dv, and EFFECT the name of an effect; gyro_bias and accel_bias, sums of the errors that are biases, as
    rates; disturbance_N_uT (n, 3), what the world added to the magnetic field, in N, where it did;
    temperature_degC (n,), where it was told; seed.
    """
    arrays: dict[str, Any] = {"t": recorded.ideal.t}
    sensors = [s for s in _SENSORS if getattr(recorded.ideal, s, None) is not None]
    errors = {sensor: recorded.errors(sensor) for sensor in sensors}
    ideal = {sensor: getattr(recorded.ideal, sensor) for sensor in sensors}
    arrays |= {f"ideal_{sensor}": x for sensor, x in _turned(recorded.ideal, ideal, world).items()}
    biases = _turned(_as_rates(recorded), {"gyro": recorded.gyro_bias, "accel": recorded.accel_bias}, world)
    arrays |= {f"{sensor}_bias": x for sensor, x in biases.items()}
    for effect in dict.fromkeys(name for terms in errors.values() for name in terms):
        terms = {s: errors[s][effect] for s in sensors if effect in errors[s]}
        arrays |= {
            f"{sensor}_error_{effect}": x for sensor, x in _turned(recorded.ideal, terms, world).items()
        }
    if recorded.disturbance_N_uT is not None:
        arrays["disturbance_N_uT"] = WORLDS[world].nav.to_theirs(recorded.disturbance_N_uT)
    if recorded.temperature_degC is not None:
        arrays["temperature_degC"] = recorded.temperature_degC
    with replacing(path) as out:
        np.savez(out, allow_pickle=False, **arrays, seed=np.array(recorded.seed))


def _as_rates(recorded: Recorded) -> ImuRecording:
    ideal = recorded.ideal
    return ideal.mean_rates() if isinstance(ideal, ImuIncrements) else ideal


def _turned(ideal: ImuRecording | ImuIncrements, terms: dict[str, Any], world: str) -> dict[str, Array]:
    """`terms` by sensor in the axes and signs of `world`; what a sensor adds turns as its readings do."""
    in_world = from_enu_flu(replace(ideal, **terms), world)
    return {sensor: getattr(in_world, sensor) for sensor in terms}
