"""Turns readings into readings with random vibration of a given spectrum."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, finite, increasing, per_axis, shaped
from kreisel.maths.random import Stream
from kreisel.maths.waves import add_mean_waves, add_waves
from kreisel.simulate.context import Context

LINES = 128
"""Each carries the same variance; with so many the spectrum is filled more finely than most records resolve."""

FREQUENCY, COSINE, SINE = 0, 0, 3
"""Channels of the stream: of its uniforms, and of its normals."""


@dataclass(frozen=True, slots=True, eq=False)
class VibrationNoise:
    """Gaussian vibration whose spectrum is straight between given points on doubly logarithmic paper.

    frequency: (m,) Hz, increasing; density: (m,) (unit of the sensor)^2/Hz, one-sided, as vibration tests state
        it: its integral over frequency is the variance. gain: factor on the readings, one or per axis.

    Made of 128 lines, drawn anew in every run, whose frequencies part the spectrum into pieces of equal
    variance: exact at any times, at any rate. What lies above half the sampling rate folds, as in a sensor
    without a filter.
    Source: Shinozuka and Deodatis 1991, "Simulation of stochastic processes by spectral representation".
    """

    frequency: Any = (1.0, 2.0)
    density: Any = (0.0, 0.0)
    gain: Any = 1.0
    name: str = field(default="vibration_noise", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        frequency = increasing("frequency", shaped("frequency", self.frequency, ("m",)))
        if len(frequency) < 2 or not frequency[0] > 0.0:
            raise ValueError(f"frequency must be two or more positive numbers, Hz; got {frequency}.")
        density = finite("density", shaped("density", self.density, (len(frequency),)))
        if (density < 0.0).any() or (density.any() and not density.all()):
            raise ValueError(
                f"density must be positive everywhere, or zero everywhere, unit^2/Hz; got {density}. A straight "
                "line on logarithmic paper never reaches zero."
            )
        put(self, "frequency", frequency)
        put(self, "density", density)
        put(self, "gain", per_axis("gain", self.gain, "without unit", 0.0))

    @property
    def idle(self) -> bool:
        """True when nothing vibrates."""
        return not (self.density.any() and self.gain.any())

    def start(self, context: Context, stream: Stream) -> Array:
        """Frequencies (m,) and coefficients of cosines and sines (2, m, 3), flat."""
        sigma = np.sqrt(self.variance / LINES) * self.gain
        cosines = sigma * stream.normals(0, LINES, 3, COSINE)
        sines = sigma * stream.normals(0, LINES, 3, SINE)
        lines = self._lines(stream.uniforms(0, LINES, 1, FREQUENCY)[:, 0])
        return np.concatenate([lines, cosines.reshape(-1), sines.reshape(-1)])

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with vibration added."""
        cosines, sines = state[LINES:].reshape(2, LINES, 3)
        waves = (state[:LINES], cosines, sines)
        if context.averaged:
            return add_mean_waves(block, context.t, context.dt, *waves)
        return add_waves(block, context.t, *waves)

    @property
    def variance(self) -> float:
        """Variance of an axis of gain one, (unit of the sensor)^2."""
        return float(self._cumulated()[1][-1])

    def _lines(self, uniform: Array) -> Array:
        """One frequency (m,) from each m-th part of the variance."""
        f, variance = self._cumulated()
        if not variance[-1]:
            return np.full(len(uniform), f[0])
        return np.interp((np.arange(len(uniform)) + uniform) / len(uniform), variance / variance[-1], f)

    def _cumulated(self) -> tuple[Array, Array]:
        """Frequencies (k,) and the variance (k,) below each."""
        f = np.geomspace(self.frequency[0], self.frequency[-1], 4096)
        if not self.density.any():
            return f, np.zeros_like(f)
        density = np.exp(np.interp(np.log(f), np.log(self.frequency), np.log(self.density)))
        pieces = 0.5 * (density[1:] + density[:-1]) * np.diff(f)
        return f, np.concatenate([[0.0], np.cumsum(pieces)])


def example() -> VibrationNoise:
    """A road vehicle."""
    return VibrationNoise(frequency=(5.0, 20.0, 80.0), density=(1e-2, 1e-2, 1e-3), gain=(0.5, 0.5, 1.0))


def zero() -> VibrationNoise:
    """Nothing vibrates."""
    return VibrationNoise()
