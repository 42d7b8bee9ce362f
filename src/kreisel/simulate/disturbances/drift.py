"""Turns a field and two times into a field that grows evenly from one to the other and then stays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array
from kreisel.simulate.field_in_time import FieldInTime


@dataclass(frozen=True, slots=True, eq=False)
class FieldDrift(FieldInTime):
    """A field that grows evenly from nothing at `start` to `field_N_uT` at `end` and stays: a current that rises.

    field_N_uT: (3,) microtesla in N, the same at every place. start, end: s on the clock of the motion.
    """

    @property
    def span(self) -> tuple[float, float]:
        """First and last time at which it acts, s: once there, it stays."""
        return self.start, np.inf

    def added_N_uT(self, t: Array, p_NS: Array) -> Array:
        """(n, 3) microtesla in N at times t (n,) s, wherever the sensor is."""
        share = np.clip((t - self.start) / (self.end - self.start), 0.0, 1.0)
        return np.asarray(share[:, None] * np.asarray(self.field_N_uT))


DISTURBANCE = FieldDrift


def example() -> FieldDrift:
    """Ten microtesla in four seconds."""
    return FieldDrift(field_N_uT=(0.0, 10.0, 0.0), start=-1.0, end=3.0)
