"""Turns the name of a sensor, that of a preset or of a file, into an IMU with that sensor's errors."""

from __future__ import annotations

import tomllib
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

    A file that `kreisel calibrate` wrote is the sensor with the errors that it takes off, and no noise.
    Relative paths begin at `folder`. Raises ValueError and OSError as `Imu.from_preset`, `read_kalibr` and
    `read_calibration` do.
    """
    if sensor is None:
        return Imu(mount or Mount(), environment=environment or Environment())
    path = (folder or Path()) / sensor
    if path.suffix in (".yaml", ".yml"):
        from kreisel.files.kalibr import read_kalibr

        found = read_kalibr(path)
        return Imu.from_noise(found.gyro, found.accel, mount=mount, environment=environment)
    if path.suffix == ".toml" and _is_calibration(path):
        return _calibrated(path, mount or Mount(), environment or Environment())
    preset = str(path) if path.suffix == ".toml" else sensor
    return Imu.from_preset(preset, mount=mount, environment=environment)


def _is_calibration(path: Path) -> bool:
    """Whether the file has a calibration's tables; False where it cannot be read, which a preset's reader tells."""
    try:
        return not {"gyro", "accel", "mag"}.isdisjoint(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return False


def _calibrated(path: Path, mount: Mount, environment: Environment) -> Imu:
    from kreisel.files.calibrations import read_calibration
    from kreisel.simulate.calibrated import effects_of

    gyro, accel, mag = effects_of(read_calibration(path))
    return Imu(mount, gyro, accel, mag if environment.field_N_uT is not None else (), environment)


def errs(imu: Imu) -> bool:
    """Whether it reads anything but its own motion in an undisturbed world, of which a record is kept then."""
    effects = (imu.gyro_effects, imu.accel_effects, imu.mag_effects)
    return any(effects) or bool(imu.environment.disturbances)


def record_all(
    imus: Sequence[Imu], motion: Motion, seed: int, run: int = 0
) -> tuple[tuple[ImuRecording, ...], tuple[Recorded, ...]]:
    """What each IMU read, and of those that err what is known of it; a perfect one in peace needs no draw."""
    known = {id(imu): imu.record(motion, seed, run) for imu in imus if errs(imu)}
    readings = tuple(known[id(imu)].measured if id(imu) in known else imu.ideal(motion) for imu in imus)
    return readings, tuple(known.values())
