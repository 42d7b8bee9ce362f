"""Turns readings into what a second-order low-pass lets through, with its delay."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from kreisel.data.checks import Array, scalar
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.random import Stream
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class Bandwidth:
    """The low-pass w^2 / (s^2 + 2 d w s + w^2), w = 2 pi cutoff: a sensor's mechanics and its filter.

    cutoff: Hz, natural frequency; inf lets everything through. damping: d, below 1; at 1/sqrt(2), a
        Butterworth filter, the gain at the cutoff is -3 dB.

    Between two samples the input runs straight (first-order hold), and for such an input the output is exact,
    whatever the steps. Preferred to the bilinear transform, which warps frequencies and is wrong for uneven
    steps. Before the first sample the input is taken to have been what it is there.
    """

    cutoff: float = np.inf
    damping: float = 1.0 / np.sqrt(2.0)
    name: str = field(default="bandwidth", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        # Below 1e-6 Hz nothing comes through within the longest of recordings.
        put(self, "cutoff", scalar("cutoff", self.cutoff, "Hz", 1e-6, np.inf))
        put(self, "damping", scalar("damping", self.damping, "without unit", 1e-3, 0.999))

    @property
    def idle(self) -> bool:
        """True when everything comes through."""
        return self.cutoff == np.inf

    @property
    def group_delay(self) -> float:
        """Delay of slow signals, s: 2 d / w."""
        return float(2.0 * self.damping / (2.0 * np.pi * self.cutoff))

    def start(self, context: Context, stream: Stream) -> Array:
        """Step and its transition matrix, then the last input, output and slope of the output, three each."""
        return np.zeros(5 + 9)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3), smoothed and late."""
        if context.first == 0:
            state[5:11] = np.tile(block[0], 2)
        out = np.empty_like(block)
        if self.idle:
            out[:] = block
        else:
            w = 2.0 * np.pi * self.cutoff
            _low_pass(state, w, self.damping, argument(block), context.dt, out)
        return out


@kernel
def _low_pass(state: Array, w: float, d: float, block: Array, dt: Array, out: Array) -> None:
    """The output is the straight line that lags the input's, plus what is left of the difference to it."""
    u, y, v = state[5:8], state[8:11], state[11:14]
    delay = 2.0 * d / w
    for k in range(block.shape[0]):
        # Round-off in the stamps is no new step.
        if abs(dt[k] - state[0]) > 1e-9 * dt[k]:
            _set_transition(state, w, d, dt[k])
        for a in range(3):
            slope = (block[k, a] - u[a]) / dt[k]
            away, drift = y[a] - u[a] + slope * delay, v[a] - slope
            y[a] = block[k, a] - slope * delay + state[1] * away + state[2] * drift
            v[a] = slope + state[3] * away + state[4] * drift
            u[a] = block[k, a]
            out[k, a] = y[a]


@kernel
def _set_transition(state: Array, w: float, d: float, dt: float) -> None:
    root = np.sqrt(1.0 - d * d)
    angle, decay = w * root * dt, np.exp(-d * w * dt)
    c, s = decay * np.cos(angle), decay * np.sin(angle) / root
    state[0] = dt
    state[1], state[2] = c + d * s, s / w
    state[3], state[4] = -w * s, c - d * s


def example() -> Bandwidth:
    """Half the bandwidth of a common gyro."""
    return Bandwidth(cutoff=20.0)


def zero() -> Bandwidth:
    """Everything comes through."""
    return Bandwidth()
