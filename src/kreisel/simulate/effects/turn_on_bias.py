"""Turns readings into readings with a bias that is constant from one turn-on to the next."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class TurnOnBias:
    """A constant bias: `fixed`, the same in every run, plus one draw of deviation `sigma` per run and axis.

    sigma, fixed: unit of the sensor, one or per axis.
    """

    sigma: Any = 0.0
    fixed: Any = 0.0
    name: str = field(default="turn_on_bias", kw_only=True)
    is_bias: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma", per_axis("sigma", self.sigma, "unit of the sensor", 0.0))
        object.__setattr__(self, "fixed", per_axis("fixed", self.fixed, "unit of the sensor"))

    @property
    def idle(self) -> bool:
        """True without any bias."""
        return not (self.sigma.any() or self.fixed.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """The bias (3,) of this run."""
        return np.asarray(self.fixed + self.sigma * stream.normals(0, 1)[0])

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with the bias added."""
        return block + state

    def allan_deviation(self, tau: Array) -> Array:
        """Zero (m, 3) at all averaging times tau (m,) s: a constant does not vary."""
        return np.zeros((len(tau), 3))


def example() -> TurnOnBias:
    """A quarter of a degree per second."""
    return TurnOnBias(sigma=4e-3)


def zero() -> TurnOnBias:
    """No bias."""
    return TurnOnBias()
