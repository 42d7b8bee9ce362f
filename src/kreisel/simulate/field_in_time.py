"""Turns a field and two times into what disturbances that are everywhere at once have in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kreisel.data.checks import interval, vector


@dataclass(frozen=True, slots=True, eq=False)
class FieldInTime:
    """field_N_uT: (3,) microtesla in N, the same at every place. start, end: s on the clock of the motion."""

    field_N_uT: Sequence[float]
    start: float
    end: float

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "field_N_uT", vector("field_N_uT", self.field_N_uT, "uT in N"))
        for name, time in zip(("start", "end"), interval(self.start, self.end), strict=True):
            put(self, name, time)
