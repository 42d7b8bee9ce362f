"""Turns readings into readings with a first-order Gauss-Markov process on them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from kreisel.data.checks import Array, per_axis
from kreisel.maths.markov import add_markov, markov_allan_deviation, markov_state
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class GaussMarkov:
    """A bias that wanders around zero: exponentially correlated noise, stationary from the first sample on.

    sigma: unit of the sensor, standard deviation at any time; time_constant: s, after which the correlation
        has fallen to 1/e. One or per axis.
    """

    sigma: Any = 0.0
    time_constant: Any = 300.0
    name: str = field(default="gauss_markov", kw_only=True)
    is_bias: ClassVar[bool] = True

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "sigma", per_axis("sigma", self.sigma, "unit of the sensor", 0.0))
        # Below a nanosecond it is white noise, and a density says how much.
        put(self, "time_constant", per_axis("time_constant", self.time_constant, "s", 1e-9))

    @property
    def idle(self) -> bool:
        """True when nothing wanders."""
        return not self.sigma.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """State of one process on three axes; the first sample draws from the stationary distribution."""
        return markov_state()

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with the process added."""
        white, rate = stream.normals(context.first, len(block)), 1.0 / self.time_constant
        return add_markov(block, state, self.sigma, rate, context.dt, context.first, white)

    def allan_deviation(self, tau: Array) -> Array:
        """Allan deviation (m, 3) at averaging times tau (m,) s."""
        return markov_allan_deviation(self.sigma[None], 1.0 / self.time_constant[None], tau)


def example() -> GaussMarkov:
    """Wanders within minutes."""
    return GaussMarkov(sigma=1e-3, time_constant=2.0)


def zero() -> GaussMarkov:
    """Nothing wanders."""
    return GaussMarkov()
