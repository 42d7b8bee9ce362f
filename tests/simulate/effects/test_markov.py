"""Gauss-Markov processes and the flicker made of them."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.simulate.effects.bias_instability import BiasInstability
from kreisel.simulate.effects.gauss_markov import GaussMarkov
from tests.simulate.effects.recordings import error_at_rest, first_errors, uneven


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**62))


def test_it_is_stationary_from_the_first_sample_whatever_the_steps(rng: np.random.Generator) -> None:
    t = np.array([0.0, 0.01, 0.011, 3.0, 3.5])
    x = first_errors(GaussMarkov(sigma=(1.0, 2.0, 3.0), time_constant=(0.1, 1.0, 10.0)), 400, seed_of(rng), t)
    # 400 runs: 3.5 % standard deviation.
    np.testing.assert_allclose(x.std(axis=0), np.tile([1.0, 2.0, 3.0], (5, 1)), rtol=0.19)
    correlation = [np.corrcoef(x[:, 3, axis], x[:, 4, axis])[0, 1] for axis in range(3)]
    # Standard deviation of a correlation of 400 pairs: at most 0.05.
    np.testing.assert_allclose(correlation, np.exp(-0.5 / np.array([0.1, 1.0, 10.0])), atol=0.25)


def test_the_correlation_falls_to_one_over_e(rng: np.random.Generator) -> None:
    t = np.arange(200_000) / 50.0
    x = error_at_rest(GaussMarkov(sigma=0.5, time_constant=0.4), t, seed_of(rng))
    # 5000 independent spans on three axes: 1 %.
    np.testing.assert_allclose((x[20:] * x[:-20]).mean(), 0.25 / np.e, rtol=0.08)


def test_steps_of_one_length_may_differ_by_round_off(rng: np.random.Generator) -> None:
    """Stamps k / 200 are uneven in their last bits; the process must not care."""
    even, seed = np.arange(2000) / 256.0, seed_of(rng)
    rounded = even + rng.uniform(-1e-13, 1e-13, 2000)
    x, y = (error_at_rest(GaussMarkov(sigma=1.0, time_constant=0.5), t, seed) for t in (even, rounded))
    # Steps differ by 5e-11 of their length.
    np.testing.assert_allclose(x, y, rtol=0.0, atol=1e-9)


def density(effect: BiasInstability, f: np.ndarray) -> np.ndarray:
    """Two-sided spectral density of the sum of processes, from the sum itself."""
    sigma, rate = (column[:, 0] for column in effect._processes())
    T = 1.0 / rate
    return (2.0 * sigma**2 * T / (1.0 + (2.0 * np.pi * f[:, None] * T) ** 2)).sum(axis=1)


@pytest.mark.parametrize("highest", [1.0, 0.5, 7.3])
def test_flicker_has_the_density_it_states(highest: float) -> None:
    effect = BiasInstability(deviation=3.0, lowest=1e-4, highest=highest)
    inner, ends = np.geomspace(1e-3, 0.1 * highest, 200), np.array([1e-4, highest])
    np.testing.assert_allclose(density(effect, inner) * 2.0 * np.pi * inner / 9.0, 1.0, atol=5e-3)
    np.testing.assert_allclose(density(effect, ends) * 2.0 * np.pi * ends / 9.0, 0.86, atol=0.01)


def test_the_floor_of_the_allan_deviation_is_0_664_b() -> None:
    effect = BiasInstability(deviation=(1.0, 2.0, 3.0), lowest=1e-5, highest=100.0)
    floor = effect.allan_deviation(np.geomspace(1.0, 100.0, 20))
    # The density waves by 0.25 %, and a thousandth of the flicker lies beyond the band.
    np.testing.assert_allclose(floor, np.tile([0.664, 1.328, 1.993], (20, 1)), rtol=2e-3)


def test_the_closed_form_and_its_series_meet() -> None:
    tau = np.array([0.999e-3, 1.001e-3])
    for_one = GaussMarkov(sigma=1.0, time_constant=1.0).allan_deviation(tau)[:, 0] / np.sqrt(tau)
    # Between them the value changes by 1e-6; the series leaves as much.
    np.testing.assert_allclose(for_one[0], for_one[1], rtol=2e-6)


def test_flicker_does_not_mind_uneven_steps(rng: np.random.Generator) -> None:
    effect = BiasInstability(deviation=1.0, lowest=0.05, highest=5.0)
    x = error_at_rest(effect, uneven(rng, 100_000), seed_of(rng))
    # Variance of all processes; 1000 s hold some 100 independent spans of the slowest on three axes.
    sigma, _ = effect._processes()
    np.testing.assert_allclose((x**2).mean(), (sigma[:, 0] ** 2).sum(), rtol=0.35)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GaussMarkov(sigma=-1.0), "sigma must be 0 or more, unit of the sensor"),
        (lambda: GaussMarkov(sigma=1.0, time_constant=0.0), "time_constant must be 1e-09 or more, s"),
        (lambda: BiasInstability(deviation=-1.0), "deviation must be 0 or more, unit of the sensor"),
        (lambda: BiasInstability(lowest=0.0), "lowest must be .* Hz"),
        (lambda: BiasInstability(lowest=1.0, highest=0.1), "octave or more; got lowest 1 Hz, highest 0.1 Hz"),
    ],
)
def test_bad_parameters(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
