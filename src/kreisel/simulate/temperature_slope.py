"""Turns a temperature coefficient and the temperature of a sensor into how far the sensor is from its reference.

What bias and scale over temperature have in common; each is an effect of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis, scalar
from kreisel.data.temperature import HOTTEST_DEGC, ZERO_KELVIN_DEGC
from kreisel.maths.random import Stream
from kreisel.simulate.context import ROOM_DEGC, Context


@dataclass(frozen=True, slots=True, eq=False)
class FollowsTemperature:
    """An error that grows by a slope per kelvin above `reference_degC`, which the IMU's history tells.

    slope: `unit`, one or per axis, the same in every run; to it comes one draw of deviation `sigma` per run and axis.
    reference_degC: degrees Celsius, where there is no error. Without a history the temperature is 25 degrees Celsius.
    """

    slope: Any = 0.0
    reference_degC: float = ROOM_DEGC
    sigma: Any = 0.0
    unit: ClassVar[str] = "unit per K"

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "slope", per_axis("slope", self.slope, self.unit))
        put(self, "sigma", per_axis("sigma", self.sigma, self.unit, 0.0))
        bounds = "deg C", ZERO_KELVIN_DEGC, HOTTEST_DEGC
        put(self, "reference_degC", scalar("reference_degC", self.reference_degC, *bounds))

    @property
    def idle(self) -> bool:
        """True when temperature does not matter."""
        return not (self.slope.any() or self.sigma.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """The slope (3,) of this run."""
        return np.asarray(self.slope + self.sigma * stream.normals(0, 1)[0])

    def above(self, context: Context) -> Array:
        """(n,) K above the reference."""
        return np.asarray(context.temperature_degC - self.reference_degC)
