"""What a simulated IMU recorded, beside what it should have read and every error that made the difference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from kreisel.data.cards import Card, Shown, course, span
from kreisel.data.checks import Array
from kreisel.data.recording import ImuRecording


@dataclass(frozen=True, slots=True, eq=False)
class Recorded(Shown):
    """A recording and its truth, row by row; NaN where a sensor gave no sample."""

    measured: ImuRecording
    ideal: ImuRecording
    gyro_bias: Array  # (n, 3) rad/s, sum of the errors that are biases
    accel_bias: Array  # (n, 3) m/s^2
    seed: int  # with which the same IMU records the same bits again
    run: int
    replay: Callable[[str], dict[str, Array]] = field(repr=False)
    disturbance_N_uT: Array | None = (
        None  # (n, 3) in N, added by the world to the field at the sensor; None: nothing
    )

    def card(self) -> Card:
        """What each sensor read, what it should have read, and its bias."""
        sensors = [name for name in ("gyro", "accel", "mag_uT") if getattr(self.measured, name) is not None]
        biases = {"gyro": self.gyro_bias, "accel": self.accel_bias}
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

        Made when asked for, by going through the recording again, which gives the same bits: kept for all
        effects they would take more memory, and more time to fill it, than all the rest.
        With a clock that neither delays nor averages, ideal plus all of them is measured.
        """
        return self.replay(sensor)
