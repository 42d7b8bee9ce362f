"""Turns the name of a sensor, that of a preset or of a file, into an IMU with that sensor's errors."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.simulate.clock import Clock
from kreisel.simulate.datasheet import completed
from kreisel.simulate.imu import Imu
from kreisel.simulate.order import placed
from kreisel.simulate.presets import values_of
from kreisel.simulate.recorded import Delivered, Recorded


def sensor_imu(
    sensor: str | None,
    mount: Mount | None = None,
    environment: Environment | None = None,
    folder: Path | None = None,
    datasheet: Mapping[str, Any] | None = None,
) -> Imu:
    """The IMU of a preset ("bmi088"), a preset file ("mine.toml") or kalibr's ("imu.yaml"); a perfect one for None.

    A file that `kreisel calibrate` wrote is the sensor with the errors that it takes off, and no noise.
    datasheet: numbers as `Imu.from_datasheet` takes them, in place of those of the sensor or beside them.
    Relative paths begin at `folder`. Raises ValueError and OSError as `Imu.from_preset`, `read_kalibr` and
    `read_calibration` do.
    """
    values = dict(datasheet or {})
    if sensor is None:
        return Imu.from_datasheet(mount=mount, environment=environment, **values)
    path = (folder or Path()) / sensor
    if path.suffix in (".yaml", ".yml"):
        from kreisel.files.kalibr import read_kalibr

        found = read_kalibr(path)
        if not values:
            return Imu.from_noise(found.gyro, found.accel, mount=mount, environment=environment)
        values = completed(values_of(found.gyro, found.accel), values)
        return Imu.from_datasheet(mount=mount, environment=environment, **values)
    if path.suffix == ".toml" and _is_calibration(path):
        return _with(_calibrated(path, mount or Mount(), environment or Environment()), values)
    preset = str(path) if path.suffix == ".toml" else sensor
    return Imu.from_preset(preset, mount=mount, environment=environment, **values)


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


def _with(imu: Imu, values: Mapping[str, Any]) -> Imu:
    """A calibrated sensor with the errors of a datasheet beside its own."""
    added = Imu.from_datasheet(environment=imu.environment, **values)
    lists = {}
    for name in ("gyro_effects", "accel_effects", "mag_effects"):
        effects = getattr(imu, name)
        for effect in getattr(added, name):
            if effect.name in [own.name for own in effects]:
                sensor = name.removesuffix("_effects")
                raise ValueError(
                    f"the calibration says what the {effect.name} of the {sensor} is; leave that number out."
                )
            effects = placed(effects, effect)
        lists[name] = effects
    return replace(imu, **lists)


def errs(imu: Imu) -> bool:
    """Whether it reads anything but its own motion in an undisturbed world, of which a record is kept then."""
    effects = (imu.gyro_effects, imu.accel_effects, imu.mag_effects)
    return any(effects) or bool(imu.environment.disturbances) or imu.clock != Clock()


def record_all(
    imus: Sequence[Imu], motion: Motion, seed: int, on_done: Callable[[], object] | None = None, run: int = 0
) -> tuple[tuple[ImuRecording, ...], tuple[Recorded[ImuRecording], ...]]:
    """What each IMU read, and of those that err what is known of it; a perfect one in peace needs no draw.

    on_done : called after each IMU.
    """
    return _read_all(imus, lambda imu: imu.record(motion, seed, run), lambda imu: imu.ideal(motion), on_done)


def add_up_all(
    imus: Sequence[Imu], motion: Motion, seed: int, on_done: Callable[[], object] | None = None
) -> tuple[tuple[ImuIncrements, ...], tuple[Recorded[ImuIncrements], ...]]:
    """The same for units that add up inside."""
    return _read_all(
        imus, lambda imu: imu.record_increments(motion, seed), lambda imu: imu.increments(motion), on_done
    )


def _read_all(
    imus: Sequence[Imu],
    record: Callable[[Imu], Recorded[Delivered]],
    ideal: Callable[[Imu], Delivered],
    on_done: Callable[[], object] | None,
) -> tuple[tuple[Delivered, ...], tuple[Recorded[Delivered], ...]]:
    readings: list[Delivered] = []
    known: list[Recorded[Delivered]] = []
    for imu in imus:
        if errs(imu):
            known.append(record(imu))
            readings.append(known[-1].measured)
        else:
            readings.append(ideal(imu))
        if on_done is not None:
            on_done()
    return tuple(readings), tuple(known)
