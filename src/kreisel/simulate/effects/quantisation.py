"""Turns readings into whole multiples of the least significant bit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import ROW, argument, kernel, row_of_axes
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class Quantisation:
    """Readings rounded to the nearest multiple of `step`, ties to even. step: unit of the sensor, one or per axis."""

    step: Any = 0.0
    name: str = field(default="quantisation", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "step", per_axis("step", self.step, "unit of the sensor", 0.0))

    @property
    def idle(self) -> bool:
        """True when every reading can be shown."""
        return not self.step.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing to remember."""
        return np.zeros(0)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3), rounded."""
        out = np.empty_like(block)
        with np.errstate(divide="ignore"):
            per_step = 1.0 / self.step
        _round(argument(block), self.step, argument(per_step), out)
        return out


@kernel
def _round(block: Array, step: Array, per_step: Array, out: Array) -> None:
    size, per_size = row_of_axes(step), row_of_axes(per_step)
    flat, flat_out = block.reshape(-1), out.reshape(-1)
    for start in range(0, flat.shape[0], ROW):
        x, y = flat[start : start + ROW], flat_out[start : start + ROW]
        for k in range(x.shape[0]):
            coarse = size[k] * np.rint(x[k] * per_size[k])
            y[k] = coarse if size[k] > 0.0 else x[k]


def example() -> Quantisation:
    """Sixteen bits over 2000 deg/s."""
    return Quantisation(step=1.0652644360316954e-3)


def zero() -> Quantisation:
    """No steps."""
    return Quantisation()
