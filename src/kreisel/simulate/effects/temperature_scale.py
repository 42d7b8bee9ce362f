"""Turns readings into readings whose scale follows the temperature."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context
from kreisel.simulate.temperature_slope import FollowsTemperature


@dataclass(frozen=True, slots=True, eq=False)
class TemperatureScale(FollowsTemperature):
    """Readings times 1 + slope times the temperature above `reference_degC`, which the IMU's history tells.

    slope: 1/K, one or per axis; to it comes one draw of deviation `sigma` per run and axis.
    reference_degC: degrees Celsius, where there is no error. Without a history the temperature is 25 degrees Celsius.
    """

    name: str = field(default="temperature_scale", kw_only=True)
    is_bias: ClassVar[bool] = False
    unit: ClassVar[str] = "1/K"

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) at the temperature it has."""
        out = np.empty_like(block)
        _follow(argument(block), argument(self.above(context)), state, out)
        return out


@kernel
def _follow(block: Array, above: Array, slope: Array, out: Array) -> None:
    for k in range(block.shape[0]):
        for a in range(3):
            out[k, a] = block[k, a] + slope[a] * above[k] * block[k, a]


def example() -> TemperatureScale:
    """A cheap sensor, away from its reference."""
    return TemperatureScale(slope=5e-4, reference_degC=20.0, sigma=1e-4)


def zero() -> TemperatureScale:
    """Temperature does not matter."""
    return TemperatureScale()
