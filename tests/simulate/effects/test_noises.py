"""White noise, turn-on bias and random walk: what a physicist would check with a stopwatch."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.simulate.effects.bias_random_walk import BiasRandomWalk
from kreisel.simulate.effects.turn_on_bias import TurnOnBias
from kreisel.simulate.effects.white_noise import WhiteNoise
from tests.simulate.effects.recordings import error_at_rest, first_errors, uneven


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**62))


def test_white_noise_is_the_stronger_the_shorter_the_step(rng: np.random.Generator) -> None:
    t = uneven(rng, 40_000)
    noise = error_at_rest(WhiteNoise(density=0.01), t, seed_of(rng))[1:]
    for step in (0.004, 0.016):
        sample = noise[np.isclose(np.diff(t), step)]
        # 60 000 numbers: 0.3 % standard deviation.
        np.testing.assert_allclose(sample.std(), 0.01 / np.sqrt(step), rtol=0.015)


def test_its_integral_walks_alike_at_every_rate(rng: np.random.Generator) -> None:
    """Angle random walk: after 4 s the angle has deviation N sqrt(4 s), at 10 Hz as at 1000."""
    for rate in (10.0, 1000.0):
        t = np.arange(int(4000 * rate / 10)) / rate
        span = int(4 * rate) if rate < 100 else int(0.4 * rate)
        noise = error_at_rest(WhiteNoise(density=0.01), t, seed_of(rng))
        angles = noise[: len(t) // span * span].reshape(-1, span, 3).sum(axis=1) / rate
        # 300 or 3000 angles.
        expected = 0.01 * np.sqrt(span / rate)
        np.testing.assert_allclose(angles.std(), expected, rtol=5.0 / np.sqrt(2.0 * angles.size))


def test_an_axis_without_noise_stays_clean(rng: np.random.Generator) -> None:
    noise = error_at_rest(WhiteNoise(density=(0.1, 0.0, 0.2)), np.arange(2000) / 100.0, seed_of(rng))
    assert not noise[:, 1].any()
    # 2000 numbers: 1.6 %.
    np.testing.assert_allclose(noise.std(axis=0)[[0, 2]], [1.0, 2.0], rtol=0.09)


def test_a_turn_on_bias_is_constant_and_new_in_every_run(rng: np.random.Generator) -> None:
    effect = TurnOnBias(sigma=(0.1, 0.2, 0.0), fixed=(0.0, 1.0, 3.0))
    bias = first_errors(effect, 300, seed_of(rng), np.arange(3) / 10.0)
    np.testing.assert_array_equal(bias, np.repeat(bias[:, :1], 3, axis=1))
    np.testing.assert_array_equal(bias[:, 0, 2], 3.0)
    # 300 runs: means within 5 sigma / sqrt(300), deviations within 5 / sqrt(600).
    np.testing.assert_allclose(bias[:, 0].mean(axis=0), [0.0, 1.0, 3.0], atol=0.29 * 0.2)
    np.testing.assert_allclose(bias[:, 0, :2].std(axis=0), [0.1, 0.2], rtol=0.21)


def test_a_random_walk_starts_at_zero_and_gains_variance_with_time(rng: np.random.Generator) -> None:
    t = uneven(rng, 40_000)
    bias = error_at_rest(BiasRandomWalk(density=0.05), t, seed_of(rng))
    assert not bias[0].any()
    for step in (0.004, 0.016):
        gained = np.diff(bias, axis=0)[np.isclose(np.diff(t), step)]
        np.testing.assert_allclose(gained.std(), 0.05 * np.sqrt(step), rtol=0.015)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: WhiteNoise(density=-1.0), r"density must be 0 or more, unit/sqrt\(Hz\); got -1"),
        (lambda: WhiteNoise(density=(0.1, np.nan, 0.1)), r"density must be 0 or more, unit/sqrt\(Hz\)"),
        (lambda: WhiteNoise(density=np.inf), "density must be 0 or more"),
        (lambda: WhiteNoise(density=(0.1, 0.1)), r"one number or three, one per axis, .*got \(2,\)"),
        (lambda: BiasRandomWalk(density=(0.0, -1e-9, 0.0)), r"density must be 0 or more, unit/sqrt\(s\)"),
        (lambda: TurnOnBias(sigma=-0.1), "sigma must be 0 or more, unit of the sensor"),
        (lambda: TurnOnBias(fixed=np.nan), "fixed must be finite, unit of the sensor"),
    ],
)
def test_bad_parameters(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
