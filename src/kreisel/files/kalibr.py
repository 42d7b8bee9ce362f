"""Turns kalibr's imu.yaml into noise models and back.

kalibr knows two numbers per sensor, in SI units: the noise density sigma, which is N here, two-sided, so that a
sample at an interval dt has the deviation sigma / sqrt(dt); and the random walk of the bias, which is K. Neither
is what a datasheet prints: docs/datasheets.md says how they follow from it.
Source: the page IMU Noise Model of kalibr's wiki.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.atomic import replacing
from kreisel.data.checks import LARGEST, scalar
from kreisel.data.noise import NoiseModel
from kreisel.files.small import read_small

_NUMBERS = {
    "gyroscope_noise_density": ("gyro", "white_noise", "rad/s/sqrt(Hz)", "N, angle random walk"),
    "gyroscope_random_walk": ("gyro", "bias_random_walk", "rad/s^2/sqrt(Hz)", "K, random walk of the bias"),
    "accelerometer_noise_density": ("accel", "white_noise", "m/s^2/sqrt(Hz)", "N, velocity random walk"),
    "accelerometer_random_walk": (
        "accel", "bias_random_walk", "m/s^3/sqrt(Hz)", "K, random walk of the bias",
    ),
}  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class KalibrImu:
    """What an imu.yaml holds."""

    gyro: NoiseModel  # rad/s
    accel: NoiseModel  # m/s^2
    rate_hz: float
    topic: str = "/imu0"


def read_kalibr(path: str | Path) -> KalibrImu:
    """The IMU in kalibr's imu.yaml, or the first one in a file of its results (imu0: ...).

    Raises ValueError with file and key where it is not sound, OSError where there is no file.
    """
    table = _table(Path(path))
    try:
        models: dict[str, dict[str, float]] = {"gyro": {}, "accel": {}}
        for key, (sensor, quantity, unit, _) in _NUMBERS.items():
            models[sensor][quantity] = scalar(key, _given(table, key), unit, 0.0)
        rate_hz = scalar("update_rate", _given(table, "update_rate"), "Hz", 1e-9)
        return KalibrImu(
            NoiseModel(**models["gyro"]),
            NoiseModel(**models["accel"]),
            rate_hz,
            str(table.get("rostopic", "/imu0")),
        )
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None


def write_kalibr(path: str | Path, imu: KalibrImu) -> None:
    """An imu.yaml; of axes that differ the noisiest counts, for kalibr has one number for all three.

    Raises ValueError where a density or random walk is zero: kalibr weighs measurements by them.
    """
    scalar("rate_hz", imu.rate_hz, "Hz", 1e-9, LARGEST)
    lines = ["# kreisel: continuous-time noise, SI units, the noisiest axis of each sensor"]
    for key, (sensor, quantity, unit, meaning) in _NUMBERS.items():
        value = float(np.max(getattr(getattr(imu, sensor), quantity)))
        if value == 0.0:
            raise ValueError(
                f"kalibr needs a {key} above 0, {unit}; the {sensor} has none. Give its NoiseModel a {quantity} "
                f"(kreisel sensors --{sensor}-walk), from a recording at rest or from experience."
            )
        lines.append(f"{key}: {_number(value)}  # {unit}: {meaning}")
    lines += [f"rostopic: {imu.topic}", f"update_rate: {_number(imu.rate_hz)}  # Hz"]
    with replacing(path) as out:
        out.write(("\n".join(lines) + "\n").encode())


def _number(value: float) -> str:
    """Digits that read back to the bit, with the point that YAML 1.1 wants in a number with an exponent."""
    mantissa, _, exponent = repr(value).partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{exponent}" if exponent else mantissa


def _table(path: Path) -> dict[str, Any]:
    import yaml

    data = read_small(path, "imu.yaml")
    try:
        # An old habit of OpenCV's writers, which PyYAML does not take for a comment.
        table = yaml.safe_load(data.removeprefix(b"%YAML:1.0"))
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError):
        raise ValueError(f"{path} is no imu.yaml: it is not YAML.") from None
    if isinstance(table, dict) and isinstance(table.get("imu0"), dict):
        table = table["imu0"]
    if not isinstance(table, dict):
        raise ValueError(f"{path} is no imu.yaml: it holds no keys.")
    return table


def _given(table: dict[str, Any], key: str) -> float:
    """A number; YAML 1.1 takes 1e-3, without a point, for text."""
    value = table.get(key)
    if value is None:
        raise ValueError(f"{key} is missing; an imu.yaml has {', '.join(_NUMBERS)} and update_rate.")
    try:
        if isinstance(value, bool):
            raise ValueError
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{key} must be a number; got {value!r:.60}.") from None
