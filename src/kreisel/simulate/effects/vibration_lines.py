"""Turns readings into readings with vibration at given frequencies."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from kreisel.data.checks import Array, as_array, finite, shaped
from kreisel.maths.random import Stream
from kreisel.maths.waves import add_mean_waves, add_waves
from kreisel.simulate.context import Context


@dataclass(frozen=True, slots=True, eq=False)
class VibrationLines:
    """Sines of constant amplitude, as engines and rotors make them; every run draws their phases.

    frequency: (m,) Hz, or one number; amplitude: (m, 3) unit of the sensor, peak; (3,) or one number for every line.
    A line above half the sampling rate appears where sampling folds it to, as it does in a sensor without a filter.
    """

    frequency: Any = ()
    amplitude: Any = field(default_factory=lambda: np.zeros((0, 3)))
    name: str = field(default="vibration_lines", kw_only=True)
    is_bias: ClassVar[bool] = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        frequency = finite("frequency", shaped("frequency", np.atleast_1d(self.frequency), ("m",)))
        if (frequency <= 0.0).any():
            raise ValueError(f"frequency must be positive, Hz; got {frequency}.")
        put(self, "frequency", frequency)
        amplitude = as_array("amplitude", self.amplitude)
        if amplitude.shape in ((), (3,)):
            amplitude = np.tile(amplitude, (len(frequency), 3 if amplitude.ndim == 0 else 1))
        amplitude = finite("amplitude", shaped("amplitude", amplitude, (len(frequency), 3)))
        if (amplitude < 0.0).any():
            raise ValueError(f"amplitude must not be negative, unit of the sensor; got {amplitude.tolist()}.")
        put(self, "amplitude", amplitude)

    @property
    def idle(self) -> bool:
        """True when nothing vibrates."""
        return not self.amplitude.any()

    def start(self, context: Context, stream: Stream) -> Array:
        """Coefficients of cosines and sines, (2, m, 3) flat."""
        phase = 2.0 * np.pi * stream.uniforms(0, len(self.frequency))
        return np.stack([self.amplitude * np.cos(phase), self.amplitude * np.sin(phase)]).reshape(-1)

    def apply(self, state: Array, block: Array, context: Context, stream: Stream) -> Array:
        """Block (n, 3) with vibration added."""
        cosines, sines = state.reshape(2, -1, 3)
        waves = (self.frequency, cosines, sines)
        if context.averaged:
            return add_mean_waves(block, context.t, context.dt, *waves)
        return add_waves(block, context.t, *waves)


def example() -> VibrationLines:
    """An engine at 35 Hz with its first harmonic."""
    return VibrationLines(frequency=(35.0, 70.0), amplitude=((0.5, 0.2, 1.0), (0.1, 0.1, 0.3)))


def zero() -> VibrationLines:
    """Nothing vibrates."""
    return VibrationLines(frequency=(35.0,), amplitude=((0.0, 0.0, 0.0),))
