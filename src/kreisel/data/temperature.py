"""The temperature of a sensor over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array, finite, increasing, same_length, shaped

ZERO_KELVIN_DEGC = -273.15
HOTTEST_DEGC = 2000.0
"""Beyond, anything a sensor is made of has melted."""

# s; far beyond any recording, and yet interpolation between its ends stays finite.
_FOR_EVER = 1e300


@dataclass(frozen=True, slots=True, eq=False)
class TemperatureHistory:
    """Temperature at times in between which it runs straight."""

    t: Array  # (m,) s, on the clock of the motion
    temperature_degC: Array  # (m,)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("m",))))
        degrees = finite("temperature_degC", shaped("temperature_degC", self.temperature_degC, ("m",)))
        bad = (degrees < ZERO_KELVIN_DEGC) | (degrees > HOTTEST_DEGC)
        if bad.any():
            k = int(np.argmax(bad))
            bounds = f"from {ZERO_KELVIN_DEGC:g} to {HOTTEST_DEGC:g}, deg C"
            raise ValueError(f"temperature_degC must be {bounds}; row {k} is {degrees[k]:g}.")
        put(self, "temperature_degC", degrees)
        same_length(self.t, temperature_degC=self.temperature_degC)

    @classmethod
    def constant(cls, temperature_degC: float) -> TemperatureHistory:
        """The same temperature at all times."""
        return cls(np.array([-_FOR_EVER, _FOR_EVER]), np.full(2, float(temperature_degC)))

    def at(self, t: Array) -> Array:
        """Temperature (n,) in degrees Celsius at times t (n,) s inside the history."""
        return np.interp(t, self.t, self.temperature_degC)

    def check_covers(self, first: float, last: float) -> None:
        """ValueError for a history that does not reach from `first` to `last`, s."""
        if len(self.t) == 0 or first < self.t[0] or self.t[-1] < last:
            span = f"{self.t[0]:.6g} to {self.t[-1]:.6g}" if len(self.t) else "no time at all"
            raise ValueError(
                f"temperature must cover the motion, from {first:.6g} to {last:.6g} s; it covers {span} s."
            )
