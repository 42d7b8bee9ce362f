"""Turns readings into whole multiples of the least significant bit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import argument, kernel
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
    for k in range(block.shape[0]):
        for a in range(3):
            coarse = step[a] * np.rint(block[k, a] * per_step[a])
            out[k, a] = coarse if step[a] > 0.0 else block[k, a]


def example() -> Quantisation:
    """Sixteen bits over 2000 deg/s."""
    return Quantisation(step=1.0652644360316954e-3)


def zero() -> Quantisation:
    """No steps."""
    return Quantisation()
