"""What a simulated IMU recorded, beside what it should have read and every error that made the difference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from kreisel.data.cards import Card, Shown, course, span
from kreisel.data.checks import Array
from kreisel.data.increments import ImuIncrements
from kreisel.data.recording import ImuRecording

Delivered = TypeVar("Delivered", ImuRecording, ImuIncrements)


@dataclass(frozen=True, slots=True, eq=False)
class Recorded(Shown, Generic[Delivered]):
    """A recording, of rates or of increments, and its truth, row by row; NaN where a sensor gave no sample."""

    measured: Delivered
    ideal: Delivered
    gyro_bias: Array  # (n, 3) rad/s, also of increments: sum of the errors that are biases
    accel_bias: Array  # (n, 3) m/s^2
    seed: int  # with which the same IMU records the same bits again
    run: int
    replay: Callable[[str], dict[str, Array]] = field(repr=False)
    disturbance_N_uT: Array | None = (
        None  # (n, 3) in N, added by the world to the field at the sensor; None: nothing
    )
    temperature_degC: Array | None = (
        None  # (n,) of the sensor; None: room temperature, of which nothing was said
    )

    def card(self) -> Card:
        """What each sensor read, what it should have read, and its bias."""
        gyro, accel = self.gyro_bias, self.accel_bias
        biases: dict[str, Array] = {"gyro": gyro, "accel": accel, "dtheta": gyro, "dv": accel}
        sensors = [name for name in (*biases, "mag_uT") if getattr(self.measured, name, None) is not None]
        rows = [
            (
                name,
                span(getattr(self.measured, name)),
                span(getattr(self.ideal, name)),
                span(biases[name]) if name in biases else "",
            )
            for name in sensors
        ]
        return Card(
            course(self, self.measured.t),
            ("", "measured", "ideal", "bias"),
            rows,
            (f"seed {self.seed}, run {self.run}",),
        )

    def errors(self, sensor: str) -> dict[str, Array]:
        """What each effect of `sensor` ("gyro", "accel" or "mag_uT") added, by its name: (n, 3), sensor's unit.

        Of increments the sensors go by "dtheta" and "dv", and what is added is in rad and m/s.

        Made when asked for, by going through the recording again, which gives the same bits: kept for all
        effects they would take more memory, and more time to fill it, than all the rest.
        With a clock that neither delays nor averages, ideal plus all of them is measured.
        """
        return self.replay(sensor)
