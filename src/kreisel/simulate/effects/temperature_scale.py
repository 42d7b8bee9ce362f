"""Turns readings into readings whose scale follows the temperature."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis, scalar
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class TemperatureScale:
    """Readings times 1 + slope times the temperature above `reference_degC`, which the IMU's history tells.

    slope: 1/K, one or per axis. reference_degC: degrees Celsius, where there is no error.
    Without a history the temperature is 25 degrees Celsius.
    """

    slope: Any = 0.0
    reference_degC: float = 25.0
    name: str = field(default="temperature_scale", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "slope", per_axis("slope", self.slope, "1/K"))
        # Between absolute zero and the melting of anything a sensor is made of.
        put(self, "reference_degC", scalar("reference_degC", self.reference_degC, "deg C", -273.15, 2000.0))

    @property
    def idle(self) -> bool:
        """True when temperature does not matter."""
        return not self.slope.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing to remember."""
        return np.zeros(0)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) at the temperature it has."""
        out = np.empty_like(block)
        above = context.temperature_degC - self.reference_degC
        _follow(argument(block), argument(above), self.slope, out)
        return out


@kernel
def _follow(block: Array, above: Array, slope: Array, out: Array) -> None:
    for k in range(block.shape[0]):
        for a in range(3):
            out[k, a] = block[k, a] + slope[a] * above[k] * block[k, a]


def example() -> TemperatureScale:
    """A cheap sensor, away from its reference."""
    return TemperatureScale(slope=5e-4, reference_degC=20.0)


def zero() -> TemperatureScale:
    """Temperature does not matter."""
    return TemperatureScale()
