"""The temperature of a sensor over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array, finite, increasing, same_length, shaped


@dataclass(frozen=True, slots=True, eq=False)
class TemperatureHistory:
    """Temperature at times in between which it runs straight."""

    t: Array  # (m,) s, on the clock of the motion
    temperature_degC: Array  # (m,)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("m",))))
        degrees = shaped("temperature_degC", self.temperature_degC, ("m",))
        put(self, "temperature_degC", finite("temperature_degC", degrees))
        same_length(self.t, temperature_degC=self.temperature_degC)

    def at(self, t: Array) -> Array:
        """Temperature (n,) in degrees Celsius at times t (n,) s inside the history."""
        return np.interp(t, self.t, self.temperature_degC)

    def covers(self, first: float, last: float) -> bool:
        """Whether the history reaches from `first` to `last`, s."""
        return len(self.t) > 0 and bool(self.t[0] <= first and last <= self.t[-1])
