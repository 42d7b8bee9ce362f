"""Turns readings into readings that are a little too large or too small."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import ROW, argument, kernel, row_of_axes
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class ScaleFactor:
    """Readings times 1 + error; to `error`, the same in every run, comes one draw of deviation `sigma` per run.

    error, sigma: relative (0.01 reads 1 % too much), one or per axis; the draws of the axes are independent.
    """

    error: Any = 0.0
    sigma: Any = 0.0
    name: str = field(default="scale_factor", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        # At -1 nothing would be read at all.
        object.__setattr__(self, "error", per_axis("error", self.error, "relative", -0.999))
        object.__setattr__(self, "sigma", per_axis("sigma", self.sigma, "relative", 0.0))

    @property
    def idle(self) -> bool:
        """True when the scale is right."""
        return not (self.error.any() or self.sigma.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """The error (3,) of this run."""
        return np.asarray(self.error + self.sigma * stream.normals(0, 1)[0])

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3), scaled."""
        out = np.empty_like(block)
        _scale(argument(block), state, out)
        return out


@kernel
def _scale(block: Array, error: Array, out: Array) -> None:
    e = row_of_axes(error)
    flat, flat_out = block.reshape(-1), out.reshape(-1)
    for start in range(0, flat.shape[0], ROW):
        x, y = flat[start : start + ROW], flat_out[start : start + ROW]
        for k in range(x.shape[0]):
            y[k] = x[k] + e[k] * x[k]


def example() -> ScaleFactor:
    """Wrong by different amounts on the three axes."""
    return ScaleFactor(error=(0.01, -0.005, 0.002), sigma=1e-3)


def zero() -> ScaleFactor:
    """The right scale."""
    return ScaleFactor()
