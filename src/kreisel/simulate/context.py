"""What surrounds a block of readings while effects act on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.environment import Environment
from kreisel.data.motion import Motion, Mount
from kreisel.data.temperature import TemperatureHistory

ROOM_DEGC = 25.0
"""Temperature where no history is given: the one at which datasheets state their values."""


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """Times, motion, environment and temperature at the n samples of one block of one sensor.

    sensor: "gyro", "accel" or "mag_uT". first: number of the block's first sample, counted from the start
    of the recording. dt: time since the sample before; the first sample of all has that of the second.
    averaged: each reading is the mean over its dt, which ends at t, as in a unit that adds up inside.
    """

    sensor: str
    first: int
    t: Array  # (n,) s
    dt: Array  # (n,) s
    specific_force: Array  # (n, 3) m/s^2, at the mount, in S, free of errors
    environment: Environment
    mount: Mount
    body: Motion  # whole motion of the body
    rows: slice | np.ndarray  # rows of `body` that belong to this block
    history: TemperatureHistory | None = None
    averaged: bool = False

    @property
    def motion(self) -> Motion:
        """Motion of the sensor at these samples (frame S in place of B)."""
        return self.body.rows(self.rows).at(self.mount)

    @property
    def temperature_degC(self) -> Array:
        """(n,) degrees Celsius; 25 where no history was given."""
        return np.full(len(self.t), ROOM_DEGC) if self.history is None else self.history.at(self.t)
