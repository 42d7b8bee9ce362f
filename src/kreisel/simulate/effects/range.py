"""Turns readings into readings that stop at the ends of a measuring range."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.maths.kernels import ROW, argument, kernel, row_of_axes
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class Range:
    """Readings cut off at -limit and +limit. limit: unit of the sensor, one or per axis; inf has no end."""

    limit: Any = np.inf
    name: str = field(default="range", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        limit = per_axis("limit", self.limit, "unit of the sensor", 0.0, np.inf)
        if not limit.all():
            raise ValueError(f"limit must be positive, unit of the sensor; got {limit}.")
        object.__setattr__(self, "limit", limit)

    @property
    def idle(self) -> bool:
        """True without end."""
        return bool(np.isinf(self.limit).all())

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing to remember; ValueError for an accelerometer that could not even show gravity."""
        g = float(np.linalg.norm(context.environment.g_N))
        if context.sensor == "accel" and self.limit.min() < g:
            raise ValueError(
                f"limit of an accelerometer's range (accel_range_g of a datasheet) must not be below gravity, "
                f"{g:.6g} m/s^2; got {self.limit} m/s^2, which is {self.limit.min() / STANDARD_GRAVITY:.3g} g. "
                "A range in g is to be multiplied by 9.80665."
            )
        return np.zeros(0)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3), cut off."""
        out = np.empty_like(block)
        _cut(argument(block), self.limit, out)
        return out


@kernel
def _cut(block: Array, limit: Array, out: Array) -> None:
    end = row_of_axes(limit)
    flat, flat_out = block.reshape(-1), out.reshape(-1)
    for start in range(0, flat.shape[0], ROW):
        x, y = flat[start : start + ROW], flat_out[start : start + ROW]
        for k in range(x.shape[0]):
            below = end[k] if x[k] > end[k] else x[k]
            y[k] = -end[k] if below < -end[k] else below


def example() -> Range:
    """A range that suits a gyro of 2000 deg/s and an accelerometer of 4 g."""
    return Range(limit=(35.0, 36.0, 40.0))


def zero() -> Range:
    """No end."""
    return Range()
