"""What is wrong with the triads of an IMU, constant over a recording, and the recording put right."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kreisel.data.cards import Shown
from kreisel.data.checks import Array, finite, read_only, regular, shaped
from kreisel.data.recording import ImuRecording


@dataclass(frozen=True, slots=True, eq=False)
class TriadCalibration(Shown):
    """Three axes of one sensor: reading = matrix @ truth + bias, in the unit of the sensor."""

    matrix: Array = field(
        default_factory=lambda: np.eye(3)
    )  # (3, 3) scale factors and misalignment, or soft iron
    bias: Array = field(default_factory=lambda: np.zeros(3))  # (3,) or hard iron
    matrix_error: Array = field(
        default_factory=lambda: np.zeros((3, 3))
    )  # standard errors; zero where not fitted
    bias_error: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrix", regular("matrix", self.matrix, "without unit"))
        for name, shape in (("bias", (3,)), ("matrix_error", (3, 3)), ("bias_error", (3,))):
            object.__setattr__(self, name, finite(name, shaped(name, getattr(self, name), shape)))

    def undo(self, readings: Array) -> Array:
        """Truth (n, 3) from `readings` (n, 3); NaN rows stay."""
        return read_only((readings - self.bias) @ np.linalg.inv(self.matrix).T)


@dataclass(frozen=True, slots=True, eq=False)
class Calibration(Shown):
    """The triads that were calibrated; None where nothing is known."""

    gyro: TriadCalibration | None = None  # rad/s
    accel: TriadCalibration | None = None  # m/s^2
    mag: TriadCalibration | None = None  # uT

    def apply(self, recording: ImuRecording) -> ImuRecording:
        """`recording` with the errors of its triads taken off.

        Raises ValueError where a magnetometer was calibrated and the recording has none.
        """
        changes: dict[str, Any] = {}
        for name, triad in (("gyro", self.gyro), ("accel", self.accel), ("mag_uT", self.mag)):
            readings = getattr(recording, name)
            if triad is not None and readings is None:
                raise ValueError(
                    "the calibration has a magnetometer and the recording none; is it of the same IMU?"
                )
            if triad is not None:
                changes[name] = triad.undo(readings)
        return replace(recording, **changes)
