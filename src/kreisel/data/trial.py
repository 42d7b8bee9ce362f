"""A recording together with the attitude and position that a reference system measured at the same time."""

from __future__ import annotations

from dataclasses import dataclass

from kreisel.data.attitude import Reference
from kreisel.data.cards import Shown
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses


@dataclass(frozen=True, slots=True, eq=False)
class Trial(Shown):
    """What a benchmark file holds: what the IMU said, and how it was turned in truth."""

    recording: ImuRecording
    reference: Reference  # attitude of the sensor, on stamps of its own
    name: str = ""
    poses: Poses | None = (
        None  # of the sensor's body, where the reference system saw both position and attitude
    )
