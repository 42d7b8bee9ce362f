"""Turns the noise of a gyroscope or accelerometer into the few numbers that Allan plots, kalibr and presets share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kreisel.data.cards import Shown
from kreisel.data.checks import LARGEST, Array, per_axis

ALLAN_FLOOR = float(np.sqrt(2.0 * np.log(2.0) / np.pi))
"""0.664: the flat floor of the Allan deviation over the coefficient B of bias instability; IEEE Std 952, annex C."""

_UNITS = {
    "white_noise": "unit/sqrt(Hz)",
    "bias_instability": "unit",
    "bias_random_walk": "unit/sqrt(s)",
    "gauss_markov": "unit",
    "turn_on_bias": "unit",
}


@dataclass(frozen=True, slots=True, eq=False)
class NoiseModel(Shown):
    """Noise of the three axes of one sensor; its unit is rad/s for a gyroscope, m/s^2 for an accelerometer.

    Every value is one number or one per axis, and (3,) once inside; zero where there is none or it is not known.
    N, B and K are the coefficients of IEEE Std 952. Raises ValueError for negative values.
    """

    white_noise: Any = 0.0  # N, unit/sqrt(Hz): the Allan deviation is N / sqrt(tau)
    bias_instability: Any = 0.0  # B, unit: its floor is 0.664 B, which is what datasheets state
    bias_random_walk: Any = 0.0  # K, unit/sqrt(s): it is K sqrt(tau / 3)
    gauss_markov: Any = 0.0  # unit, standard deviation of a bias that wanders and comes back
    correlation_time: Any = np.inf  # s, of that bias
    turn_on_bias: Any = 0.0  # unit, standard deviation from one turn-on to the next

    def __post_init__(self) -> None:
        put = object.__setattr__
        for name, unit in _UNITS.items():
            put(self, name, per_axis(name, getattr(self, name), unit, 0.0))
        put(self, "correlation_time", per_axis("correlation_time", self.correlation_time, "s", 1e-9, np.inf))
        if self.gauss_markov.any() and not (self.correlation_time <= LARGEST).all():
            raise ValueError(
                "gauss_markov needs a correlation_time, s; for a bias that stays use turn_on_bias."
            )

    def allan_deviation(self, tau: Array) -> Array:
        """Allan deviation (m, 3) at averaging times tau (m,) s from N, B and K alone."""
        t = np.asarray(tau)[:, None]
        white, walk = self.white_noise**2 / t, self.bias_random_walk**2 * t / 3.0
        return np.asarray(np.sqrt(white + (ALLAN_FLOOR * self.bias_instability) ** 2 + walk))
