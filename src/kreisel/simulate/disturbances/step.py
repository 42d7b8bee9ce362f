"""Turns a field and two times into a field that is switched on and off between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array, interval, vector


@dataclass(frozen=True, slots=True, eq=False)
class FieldStep:
    """A field that is there from `start` on, until `end`: a lift that stops beside the body, a motor that runs.

    field_N_uT: (3,) microtesla in N, the same at every place. start, end: s on the clock of the motion.
    """

    field_N_uT: Sequence[float]
    start: float
    end: float = np.inf

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "field_N_uT", vector("field_N_uT", self.field_N_uT, "uT in N"))
        for name, time in zip(("start", "end"), interval(self.start, self.end), strict=True):
            put(self, name, time)

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
