"""What a simulated IMU recorded, beside what it should have read and every error that made the difference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from kreisel.data.checks import Array
from kreisel.data.recording import ImuRecording


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """A recording and its truth, row by row; NaN where a sensor gave no sample.

    errors: what each effect added, by sensor ("gyro", "accel", "mag_uT") and name of the effect, (n, 3) in
        the sensor's unit. With a clock that neither delays nor averages, ideal plus all of them is measured.
    """

    measured: ImuRecording
    ideal: ImuRecording
    gyro_bias: Array  # (n, 3) rad/s, sum of the errors that are biases
    accel_bias: Array  # (n, 3) m/s^2
    errors: Mapping[str, Mapping[str, Array]]
    seed: int  # with which the same IMU records the same bits again
