"""Turns readings into readings with white noise of a given density."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, per_axis
from kreisel.maths.kernels import argument, kernel, wide_vectors
from kreisel.maths.random import CHUNK, Stream, Words, fill_normals, normals_abreast
from kreisel.simulate.context import Context
from kreisel.simulate.effects import PutAbreast

# Samples whose normals are made at once: the first-level cache holds them.
_ROWS = 8 * CHUNK


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
        out = np.empty_like(block)
        _add_noise(argument(block), stream.words(context.first), _deviations(context.dt, self.density), out)
        return out

    def abreast(self, block: Array, context: Context) -> PutAbreast:
        """What puts `apply` of `block` (n, 3) to several runs into their lanes."""
        shared, deviations = argument(block), argument(_deviations(context.dt, self.density))
        return lambda words, row, out: normals_abreast(words, 0, shared, deviations, row, out)

    def allan_deviation(self, tau: Array) -> Array:
        """Allan deviation (m, 3) at averaging times tau (m,) s."""
        return self.density / np.sqrt(tau)[:, None]


@kernel
def _deviations(dt: Array, density: Array) -> Array:
    wide_vectors()
    out = np.empty((dt.shape[0], 3))
    for k in range(dt.shape[0]):
        per_root_s = 1.0 / np.sqrt(dt[k])
        out[k, 0], out[k, 1], out[k, 2] = (
            density[0] * per_root_s,
            density[1] * per_root_s,
            density[2] * per_root_s,
        )
    return out


@kernel
def _add_noise(block: Array, words: Words, deviations: Array, out: Array) -> None:
    wide_vectors()
    noise, words = np.empty((_ROWS, 3)), words.copy()
    for begin in range(0, block.shape[0], _ROWS):
        n = min(_ROWS, block.shape[0] - begin)
        fill_normals(words, 0, noise[:n])
        x, by = noise.ravel(), deviations[begin : begin + n].ravel()
        clean, noisy = block[begin : begin + n].ravel(), out[begin : begin + n].ravel()
        for k in range(3 * n):
            noisy[k] = clean[k] + by[k] * x[k]
        words[3] += np.uint64(n)


def example() -> WhiteNoise:
    """A phone's gyro."""
    return WhiteNoise(density=1.2e-4)


def zero() -> WhiteNoise:
    """No noise."""
    return WhiteNoise()
