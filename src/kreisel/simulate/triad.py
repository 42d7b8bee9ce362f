"""Turns the errors of three like sensor axes, as numbers in SI units, into the effects that make them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kreisel.data.noise import NoiseModel
from kreisel.simulate.context import ROOM_DEGC
from kreisel.simulate.effects import Effect
from kreisel.simulate.effects.bandwidth import Bandwidth
from kreisel.simulate.effects.bias_instability import BiasInstability
from kreisel.simulate.effects.bias_random_walk import BiasRandomWalk
from kreisel.simulate.effects.g_sensitivity import GSensitivity
from kreisel.simulate.effects.gauss_markov import GaussMarkov
from kreisel.simulate.effects.misalignment import Misalignment
from kreisel.simulate.effects.nonlinearity import Nonlinearity
from kreisel.simulate.effects.quantisation import Quantisation
from kreisel.simulate.effects.range import Range
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.temperature_bias import TemperatureBias
from kreisel.simulate.effects.temperature_scale import TemperatureScale
from kreisel.simulate.effects.turn_on_bias import TurnOnBias
from kreisel.simulate.effects.white_noise import WhiteNoise

# Flicker goes on until it is one part in so many of the white noise: its end shows nowhere.
_BURIED = 100.0
_FLICKER_HZ = (1.0, 1000.0)


@dataclass(frozen=True, slots=True, eq=False)
class Triad:
    """What a datasheet says of a gyroscope or accelerometer; its unit is rad/s or m/s^2.

    Where nothing is said the sensor is perfect. One number or one per axis, but for the bandwidth.
    """

    noise: NoiseModel = field(default_factory=NoiseModel)
    scale: Any = 0.0  # relative, standard deviation from one sensor to the next
    misalignment: Any = 0.0  # rad, the same; what one axis hears of another
    bandwidth: float = np.inf  # Hz, -3 dB
    limit: Any = np.inf  # unit, end of the range
    step: Any = 0.0  # unit, least significant bit
    g_sensitivity: Any = 0.0  # rad/s per m/s^2, the same as scale; a gyro's
    temperature_bias: Any = 0.0  # unit/K, the same
    temperature_scale: Any = 0.0  # 1/K, the same
    reference_degC: float = ROOM_DEGC  # where temperature makes no error
    cubic: Any = 0.0  # 1/unit^2, bend of the characteristic
    fixed_bias: Any = 0.0  # unit; this and the rest are values of the one sensor, with their sign
    fixed_scale: Any = 0.0  # relative
    fixed_g_sensitivity: Any = 0.0  # rad/s per m/s^2, along each axis
    fixed_temperature_bias: Any = 0.0  # unit/K
    fixed_temperature_scale: Any = 0.0  # 1/K

    def effects(self) -> tuple[Effect, ...]:
        """The effects that change anything, from the outer world to the output.

        Noise comes before the low-pass: what the datasheet states is the density inside the band.
        """
        noise = self.noise
        wanders = bool(noise.gauss_markov.any())
        every: tuple[Effect, ...] = (
            Misalignment(sigma=self.misalignment),
            ScaleFactor(self.fixed_scale, self.scale),
            TemperatureScale(self.fixed_temperature_scale, self.reference_degC, self.temperature_scale),
            Nonlinearity(cubic=self.cubic),
            GSensitivity(self.fixed_g_sensitivity, self.g_sensitivity),
            TurnOnBias(noise.turn_on_bias, self.fixed_bias),
            TemperatureBias(self.fixed_temperature_bias, self.reference_degC, self.temperature_bias),
            BiasInstability(noise.bias_instability, highest=_end_of_flicker(noise)),
            BiasRandomWalk(noise.bias_random_walk),
            GaussMarkov(noise.gauss_markov, noise.correlation_time) if wanders else GaussMarkov(),
            WhiteNoise(noise.white_noise),
            Bandwidth(self.bandwidth),
            Range(self.limit),
            Quantisation(self.step),
        )
        return tuple(effect for effect in every if not effect.idle)


def _end_of_flicker(noise: NoiseModel) -> float:
    """Hz; 1 Hz where there is no white noise to bury it.

    Flicker of density B^2 / (2 pi f) is as strong as white noise of density N^2 at f = B^2 / (2 pi N^2).
    """
    white = noise.white_noise > 0.0
    knee = (noise.bias_instability[white] / noise.white_noise[white]) ** 2 / (2.0 * np.pi)
    return float(np.clip(_BURIED * knee.max(initial=0.0), *_FLICKER_HZ))
