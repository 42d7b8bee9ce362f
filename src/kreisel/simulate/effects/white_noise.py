"""Turns readings into readings with white noise of a given density."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class WhiteNoise:
    """White noise: the angle random walk of a gyro, the velocity random walk of an accelerometer.

    density: unit/sqrt(Hz), one or per axis; the coefficient N of IEEE 952: the Allan deviation is
        N / sqrt(tau) and the two-sided power spectral density N^2. Of a one-sided density, whose square
        times the bandwidth is a variance, it is 1/sqrt(2).

    A sample stands for the time dt since the one before, whatever that is: its deviation is
    density / sqrt(dt), which is density * sqrt(rate) at an even rate.
    """

    density: Any = 0.0
    name: str = field(default="white_noise", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "density", per_axis("density", self.density, "unit/sqrt(Hz)", 0.0))

    @property
    def idle(self) -> bool:
        """True without noise."""
        return not self.density.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing to remember."""
        return np.zeros(0)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with noise added."""
        out = stream.normals(context.first, len(block))
        _add_noise(argument(block), context.dt, self.density, out)
        return out

    def allan_deviation(self, tau: Array) -> Array:
        """Allan deviation (m, 3) at averaging times tau (m,) s."""
        return self.density / np.sqrt(tau)[:, None]


@kernel
def _add_noise(block: Array, dt: Array, density: Array, out: Array) -> None:
    step, x, y, z = 0.0, 0.0, 0.0, 0.0
    for k in range(block.shape[0]):
        # A root and a division cost more than all else, and most clocks are even.
        if dt[k] != step:
            step = dt[k]
            per_root_s = 1.0 / np.sqrt(step)
            x, y, z = density[0] * per_root_s, density[1] * per_root_s, density[2] * per_root_s
        out[k, 0] = block[k, 0] + x * out[k, 0]
        out[k, 1] = block[k, 1] + y * out[k, 1]
        out[k, 2] = block[k, 2] + z * out[k, 2]


def example() -> WhiteNoise:
    """A phone's gyro."""
    return WhiteNoise(density=1.2e-4)


def zero() -> WhiteNoise:
    """No noise."""
    return WhiteNoise()
