"""What a simulated IMU recorded, beside what it should have read and every error that made the difference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from kreisel.data.checks import Array
from kreisel.data.increments import ImuIncrements
from kreisel.data.recording import ImuRecording

Delivered = TypeVar("Delivered", ImuRecording, ImuIncrements)


@dataclass(frozen=True, slots=True, eq=False)
class Recorded(Generic[Delivered]):
    """A recording, of rates or of increments, and its truth, row by row; NaN where a sensor gave no sample."""

    measured: Delivered
    ideal: Delivered
    gyro_bias: (
        Array  # (n, 3) rad/s, sum of the errors that are biases; of increments the mean over each interval
    )
    accel_bias: Array  # (n, 3) m/s^2
    seed: int  # with which the same IMU records the same bits again
    run: int
    replay: Callable[[str], dict[str, Array]] = field(repr=False)
    disturbance_N_uT: Array | None = (
        None  # (n, 3) in N, added by the world to the field at the sensor; None: nothing
    )

    def errors(self, sensor: str) -> dict[str, Array]:
        """What each effect of `sensor` ("gyro", "accel" or "mag_uT") added, by its name: (n, 3), sensor's unit.

        Of increments the sensors go by "dtheta" and "dv", and what is added is in rad and m/s.

        Made when asked for, by going through the recording again, which gives the same bits: kept for all
        effects they would take more memory, and more time to fill it, than all the rest.
        With a clock that neither delays nor averages, ideal plus all of them is measured.
        """
        return self.replay(sensor)
