"""Turns readings into whole numbers of pulses, each of which stands for a small angle or a small velocity."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class IncrementQuantisation:
    """The integral of the readings, counted in pulses of `step`; what is less than one waits for the next reading.

    step: unit of the sensor times s (rad for a gyro, m/s for an accelerometer), one or per axis.

    Nothing is lost: the sum of the increments is never more than half a step from what it should be, where rounding
    each reading, as `Quantisation` does, adds up to a random walk. The Allan deviation of a moving sensor's error is
    that of quantisation noise, sqrt(3) Q / tau with Q = step / sqrt(12).
    Source: IEEE Std 952, annex C.
    """

    step: Any = 0.0
    name: str = field(default="increment_quantisation", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "step", per_axis("step", self.step, "unit of the sensor times s", 0.0))

    @property
    def idle(self) -> bool:
        """True when every increment can be shown."""
        return not self.step.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """Nothing (3,) waits yet."""
        return np.zeros(3)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3), each reading a whole number of pulses over its dt."""
        out = np.empty_like(block)
        _count(state, argument(block), context.dt, self.step, out)
        return out


@kernel
def _count(waiting: Array, block: Array, dt: Array, step: Array, out: Array) -> None:
    for a in range(3):
        left = waiting[a]
        for k in range(block.shape[0]):
            if step[a] > 0.0:
                whole = block[k, a] * dt[k] + left
                counted = step[a] * np.rint(whole / step[a])
                left = whole - counted
                out[k, a] = counted / dt[k]
            else:
                out[k, a] = block[k, a]
        waiting[a] = left


def example() -> IncrementQuantisation:
    """A tenth of an arc second."""
    return IncrementQuantisation(step=4.848e-7)


def zero() -> IncrementQuantisation:
    """No pulses."""
    return IncrementQuantisation()
