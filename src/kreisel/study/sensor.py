"""Turns the name of a sensor, that of a preset or of a file, into an IMU with that sensor's errors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kreisel.data.environment import Environment
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.simulate.imu import Imu
from kreisel.simulate.recorded import Recorded


def sensor_imu(
    sensor: str | None,
    mount: Mount | None = None,
    environment: Environment | None = None,
    folder: Path | None = None,
) -> Imu:
    """The IMU of a preset ("bmi088"), a preset file ("mine.toml") or kalibr's ("imu.yaml"); a perfect one for None.

    Relative paths begin at `folder`. Raises ValueError and OSError as `Imu.from_preset` and `read_kalibr` do.
    """
    if sensor is None:
        return Imu(mount or Mount(), environment=environment or Environment())
    path = (folder or Path()) / sensor
    if path.suffix in (".yaml", ".yml"):
        from kreisel.files.kalibr import read_kalibr

        found = read_kalibr(path)
        return Imu.from_noise(found.gyro, found.accel, mount=mount, environment=environment)
    preset = str(path) if path.suffix == ".toml" else sensor
    return Imu.from_preset(preset, mount=mount, environment=environment)


def errs(imu: Imu) -> bool:
    """Whether it reads anything but its own motion in an undisturbed world, of which a record is kept then."""
    effects = (imu.gyro_effects, imu.accel_effects, imu.mag_effects)
    return any(effects) or bool(imu.environment.disturbances)


def record_all(
    imus: Sequence[Imu], motion: Motion, seed: int
) -> tuple[tuple[ImuRecording, ...], tuple[Recorded, ...]]:
    """What each IMU read, and of those that err what is known of it; a perfect one in peace needs no draw."""
    known = {id(imu): imu.record(motion, seed) for imu in imus if errs(imu)}
    readings = tuple(known[id(imu)].measured if id(imu) in known else imu.ideal(motion) for imu in imus)
    return readings, tuple(known.values())
