"""Turns readings into readings with a bias that walks at random."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class BiasRandomWalk:
    """A bias that starts at zero and gains variance density^2 in every second: rate random walk.

    density: unit/sqrt(s), the same as unit/s/sqrt(Hz), one or per axis; the coefficient K of IEEE 952.
    The Allan deviation is K sqrt(tau / 3).
    """

    density: Any = 0.0
    name: str = field(default="bias_random_walk", kw_only=True)
    is_bias: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "density", per_axis("density", self.density, "unit/sqrt(s)", 0.0))

    @property
    def idle(self) -> bool:
        """True when the bias stays where it is."""
        return not self.density.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """No bias (3,) yet."""
        return np.zeros(3)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with the walking bias added."""
        out = stream.normals(context.first, len(block))
        if context.first == 0:
            out[0] = 0.0
        _walk(state, argument(block), context.dt, self.density, out)
        return out

    def allan_deviation(self, tau: Array) -> Array:
        """Allan deviation (m, 3) at averaging times tau (m,) s."""
        return self.density * np.sqrt(tau / 3.0)[:, None]


@kernel
def _walk(bias: Array, block: Array, dt: Array, density: Array, out: Array) -> None:
    # In local variables, since the compiler cannot know that `out` and `bias` do not overlap.
    x, y, z = bias
    step, a, b, c = 0.0, 0.0, 0.0, 0.0
    for k in range(block.shape[0]):
        if dt[k] != step:
            step = dt[k]
            root_s = np.sqrt(step)
            a, b, c = density[0] * root_s, density[1] * root_s, density[2] * root_s
        x, y, z = x + a * out[k, 0], y + b * out[k, 1], z + c * out[k, 2]
        out[k, 0], out[k, 1], out[k, 2] = block[k, 0] + x, block[k, 1] + y, block[k, 2] + z
    bias[0], bias[1], bias[2] = x, y, z


def example() -> BiasRandomWalk:
    """A phone's gyro."""
    return BiasRandomWalk(density=2e-5)


def zero() -> BiasRandomWalk:
    """A bias that stays where it is."""
    return BiasRandomWalk()
