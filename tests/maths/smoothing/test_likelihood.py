"""The likelihood finds the noise: its level, whether it is given or not, and whether it remembers."""

import numpy as np
import pytest

from kreisel.maths.smoothing import smoothing_spline

T = np.arange(1001) / 200.0
SIGMA = 1e-4


def motion(derivative: int = 0) -> np.ndarray:
    w = 2.0 * np.pi
    return 0.8 * w**derivative * np.cos(w * T + derivative * np.pi / 2)[:, None]


def noise(rng: np.random.Generator, memory: float) -> np.ndarray:
    x = rng.normal(size=(len(T), 1))
    kept = np.exp(-0.005 / memory)
    for k in range(1, len(T)):
        x[k] = kept * x[k - 1] + np.sqrt(1.0 - kept**2) * x[k]
    return SIGMA * x


@pytest.mark.parametrize("memory", [0.005, 0.01, 0.02])
def test_correlated_noise_is_not_taken_for_motion(rng, memory):
    smooth = smoothing_spline(T, motion() + noise(rng, memory))
    # What is new from sample to sample: a thousand of them know it to 2 %, and the memory's error takes a part.
    news = smooth.sigma * np.sqrt(-np.expm1(-0.01 / smooth.memory))
    np.testing.assert_allclose(news, SIGMA * np.sqrt(-np.expm1(-0.01 / memory)), rtol=0.15)
    # As many independent samples as there are memories: 250 at the least know a memory to a factor of 1.2; the
    # slow part of longer ones is hardly told from motion.
    assert 0.4 * memory < smooth.memory[0] < 2.6 * memory
    error = np.sqrt(np.mean(np.square(smooth(T, 2)[2] - motion(2))))
    # 0.03 to 0.05 measured; interpolation would leave 10 m/s^2.
    assert error < 0.15


def test_white_noise_has_no_memory(rng):
    smooth = smoothing_spline(T, motion() + SIGMA * rng.normal(size=(len(T), 1)))
    assert smooth.memory[0] == 0.0


def test_a_level_that_is_given_is_taken(rng):
    x = motion() + SIGMA * rng.normal(size=(len(T), 1))
    found, given = smoothing_spline(T, x), smoothing_spline(T, x, sigma=np.array([SIGMA]))
    assert given.sigma[0] == SIGMA
    # Half of the noise is left in doubt by neither: the two accelerations differ by less than their error.
    np.testing.assert_allclose(
        given(T, 2)[2], found(T, 2)[2], atol=3.0 * np.sqrt(found.variances(T, range(2, 3)).max())
    )
    np.testing.assert_allclose(given.found, SIGMA, rtol=0.15)


def test_noise_that_is_given_too_small_is_followed(rng):
    x = motion() + SIGMA * rng.normal(size=(len(T), 1))
    tight = smoothing_spline(T, x, sigma=np.array([0.1 * SIGMA]))
    assert np.sqrt(np.mean(np.square(tight(T, 0)[0] - x))) < 0.5 * SIGMA


def test_motion_at_the_edge_of_its_sampling_is_not_taken_for_noise(rng):
    """Seven samples a period: a smoothness that follows them is more likely than one that sees noise of 0.3 m."""
    t = np.arange(200) / 20.0
    x = 0.3 * np.cos(6.0 * np.pi * t)[:, None] + SIGMA * rng.normal(size=(200, 1))
    smooth = smoothing_spline(t, x)
    assert np.abs(smooth(t, 0)[0] - x).max() < 0.01
