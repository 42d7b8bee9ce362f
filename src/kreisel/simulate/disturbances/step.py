"""Turns a field and two times into a field that is switched on and off between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array
from kreisel.simulate.field_in_time import FieldInTime


@dataclass(frozen=True, slots=True, eq=False)
class FieldStep(FieldInTime):
    """A field that is there from `start` on, until `end`: a lift that stops beside the body, a motor that runs.

    field_N_uT: (3,) microtesla in N, the same at every place. start, end: s on the clock of the motion.
    """

    end: float = np.inf

    @property
    def span(self) -> tuple[float, float]:
        """First and last time at which it acts, s."""
        return self.start, self.end

    def added_N_uT(self, t: Array, p_NS: Array) -> Array:
        """(n, 3) microtesla in N at times t (n,) s, wherever the sensor is."""
        acts = (self.start <= t) & (t < self.end)
        return np.where(acts[:, None], np.asarray(self.field_N_uT), 0.0)


DISTURBANCE = FieldStep


def example() -> FieldStep:
    """A lift that stops for two seconds."""
    return FieldStep(field_N_uT=(5.0, -8.0, 3.0), start=1.0, end=3.0)
