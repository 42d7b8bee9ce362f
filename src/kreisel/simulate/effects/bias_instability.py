"""Turns readings into readings with a bias that flickers: 1/f noise over a stated band."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis, scalar
from kreisel.maths.markov import add_markov, markov_allan_deviation, markov_state
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context

WIDEST_RATIO = 4.0
"""Between neighbouring corner frequencies; at 4 the density waves by 0.25 % about 1/f, at 10 by 6 %."""


@dataclass(frozen=True, slots=True, eq=False)
class BiasInstability:
    """Flicker noise of two-sided density B^2 / (2 pi f) between `lowest` and `highest`: a flat Allan deviation.

    deviation: B, unit of the sensor, one or per axis. The floor of the Allan deviation is
        sqrt(2 ln 2 / pi) B = 0.664 B: a datasheet that states the floor itself means B = floor / 0.664.
    lowest, highest: Hz. Below the band the density is level, above it falls with 1/f^2; at its ends it is
        14 % low, and nowhere more than 0.5 % off in its inner part, a decade away from both.

    A sum of Gauss-Markov processes whose corners f_i lie a factor r <= 4 apart, each of variance
    B^2 ln r / pi, the two outermost r / (r - 1) as much, which is what the corners left out beyond them would
    add inside the band. It is stationary from the first sample on: some of it is there at turn-on.
    Source: IEEE Std 952, annex C, for density and floor; the sum is an integral over time constants,
    integral of 2 T / (1 + (2 pi f T)^2) dT / T = 1 / (2 f), taken in steps of ln r.
    """

    deviation: Any = 0.0
    lowest: float = 1e-4
    highest: float = 1.0
    name: str = field(default="bias_instability", kw_only=True)
    is_bias: ClassVar[bool] = True

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "deviation", per_axis("deviation", self.deviation, "unit of the sensor", 0.0))
        for name in ("lowest", "highest"):
            put(self, name, scalar(name, getattr(self, name), "Hz", 1e-12, 1e9))
        if not self.highest >= 2.0 * self.lowest:
            raise ValueError(
                f"the band must span an octave or more; got lowest {self.lowest:g} Hz, highest {self.highest:g} Hz."
            )

    @property
    def idle(self) -> bool:
        """True without flicker."""
        return not self.deviation.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """State of all processes; the first sample draws from the stationary distribution."""
        return np.array([markov_state() for _ in self._corners()])

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with flicker added."""
        out = block
        for k, (sigma, rate) in enumerate(zip(*self._processes(), strict=True)):
            white = stream.normals(context.first, len(block), 3, channel=3 * k)
            out = add_markov(out, state[k], sigma, rate, context.dt, context.first, white)
        return out

    def allan_deviation(self, tau: Array) -> Array:
        """Allan deviation (m, 3) at averaging times tau (m,) s; 0.664 B well inside the band."""
        return markov_allan_deviation(*self._processes(), tau)

    def _corners(self) -> Array:
        spans = int(np.ceil(np.log(self.highest / self.lowest) / np.log(WIDEST_RATIO) - 1e-9))
        return np.geomspace(self.lowest, self.highest, spans + 1)

    def _processes(self) -> tuple[Array, Array]:
        """Standard deviations and inverse time constants (m, 3)."""
        corners = self._corners()
        ratio = corners[1] / corners[0]
        share = np.full(len(corners), np.log(ratio) / np.pi)
        share[[0, -1]] *= ratio / (ratio - 1.0)
        rate = np.repeat(2.0 * np.pi * corners[:, None], 3, axis=1)
        return np.sqrt(share)[:, None] * self.deviation, rate


def example() -> BiasInstability:
    """A good gyro over a band that a short recording covers."""
    return BiasInstability(deviation=2e-5, lowest=1e-2, highest=1.0)


def zero() -> BiasInstability:
    """No flicker."""
    return BiasInstability()
