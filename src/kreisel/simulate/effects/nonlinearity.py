"""Turns readings into readings whose scale depends on how large they are."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class Nonlinearity:
    """x + quadratic x^2 + cubic x^3 on each axis.

    quadratic: 1/unit of the sensor; the K2 of an accelerometer, which turns vibration into a bias.
    cubic: 1/unit^2. One or per axis.
    """

    quadratic: Any = 0.0
    cubic: Any = 0.0
    name: str = field(default="nonlinearity", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "quadratic", per_axis("quadratic", self.quadratic, "1/unit of the sensor"))
        put(self, "cubic", per_axis("cubic", self.cubic, "1/unit^2 of the sensor"))

    @property
    def idle(self) -> bool:
        """True for a straight characteristic."""
        return not (self.quadratic.any() or self.cubic.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing to remember."""
        return np.zeros(0)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3), bent."""
        out = np.empty_like(block)
        _bend(argument(block), self.quadratic, self.cubic, out)
        return out


@kernel
def _bend(block: Array, quadratic: Array, cubic: Array, out: Array) -> None:
    for k in range(block.shape[0]):
        for a in range(3):
            x = block[k, a]
            out[k, a] = x + x * x * (quadratic[a] + cubic[a] * x)


def example() -> Nonlinearity:
    """A few parts in a thousand at full scale."""
    return Nonlinearity(quadratic=1e-4, cubic=(2e-6, 0.0, -1e-6))


def zero() -> Nonlinearity:
    """A straight characteristic."""
    return Nonlinearity()
