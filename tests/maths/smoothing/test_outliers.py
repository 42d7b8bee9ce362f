"""Samples that do not belong to a motion are found and named; what belongs to it stays."""

import numpy as np
import pytest

from kreisel.maths.smoothing import smoothing_spline

T = np.arange(1001) / 200.0
SIGMA = 1e-4


def path(derivative: int = 0) -> np.ndarray:
    w = 2.0 * np.pi * np.array([1.0, 1.0, 3.0])
    turn = np.array([0.0, -np.pi / 2, 0.0]) + derivative * np.pi / 2
    return np.array([0.8, 0.8, 0.3]) * w**derivative * np.cos(T[:, None] * w + turn)


def noisy(rng: np.random.Generator) -> np.ndarray:
    return path() + SIGMA * rng.normal(size=(len(T), 3))


def error(smooth) -> float:
    """RMS of the acceleration, m/s^2; 0.11 to 0.2 for clean samples, from draw to draw."""
    return float(np.sqrt(np.mean(np.square(smooth(T, 2)[2] - path(2)))))


@pytest.mark.parametrize("size", [0.02, 1.0])
def test_outliers_of_any_size_are_set_aside_and_do_no_harm(rng, size):
    x = noisy(rng)
    rows = np.sort(rng.choice(len(T), 30, replace=False))
    x[rows] += size * rng.normal(size=(30, 3)) + size
    smooth = smoothing_spline(T, x)
    # Those by chance within the noise are no outliers; all three axes are, for none of thirty here.
    np.testing.assert_array_equal(smooth.outliers, T[rows])
    np.testing.assert_allclose(smooth.sigma, SIGMA, rtol=0.15)
    assert error(smooth) < 0.35


def test_clean_noise_has_no_outliers(rng):
    smooth = smoothing_spline(T, noisy(rng))
    assert not smooth.outliers.size and not smooth.jumps.size and not smooth.rough.size


@pytest.mark.parametrize("length", [2, 5, 15])
def test_a_burst_of_outliers_is_set_aside_as_a_whole(rng, length):
    x = noisy(rng)
    x[400 : 400 + length] += [0.03, 0.01, 0.0]
    smooth = smoothing_spline(T, x)
    np.testing.assert_array_equal(smooth.outliers, T[400 : 400 + length])
    assert not smooth.jumps.size
    # The middle of a bridge of 75 ms is known four times less well.
    assert error(smooth) < 0.4


@pytest.mark.parametrize("size", [3e-3, 0.05, 0.5])
def test_a_jump_is_found_named_and_taken_off(rng, size):
    x = noisy(rng)
    x[300:] += [size, 0.0, -0.5 * size]
    smooth = smoothing_spline(T, x)
    np.testing.assert_allclose(smooth.jumps, 0.5 * (T[299] + T[300]), atol=1e-12)
    # Each side knows its end to about the noise of a sample.
    np.testing.assert_allclose(smooth.sizes[0], [size, 0.0, -0.5 * size], atol=4.0 * SIGMA)
    assert error(smooth) < 0.3
    # The longest part stays where it is.
    assert np.abs(smooth(T[400:], 0)[0] - x[400:]).max() < 6.0 * SIGMA


def test_two_jumps_and_a_marker_that_comes_back(rng):
    x = noisy(rng)
    x[300:360] += [0.02, 0.0, 0.01]
    smooth = smoothing_spline(T, x)
    np.testing.assert_allclose(smooth.jumps, [T[299] + 0.0025, T[359] + 0.0025], atol=1e-12)
    assert error(smooth) < 0.35


def test_a_corner_of_the_path_is_motion(rng):
    """At a sample or between two."""
    place = rng.uniform(1.0, 4.0)
    for corner in (2.5, place):
        x = np.abs(T - corner)[:, None] * [0.8, 0.3, 0.1] + SIGMA * rng.normal(size=(len(T), 3))
        smooth = smoothing_spline(T, x)
        assert not smooth.outliers.size and not smooth.jumps.size
        np.testing.assert_allclose(smooth.rough, corner, atol=0.03)


def test_knocks_are_motion(rng):
    """Velocity steps of up to a metre per second, some ten on each axis."""
    knocks = np.where(rng.random((len(T), 3)) < 0.01, 0.5 * rng.normal(size=(len(T), 3)), 0.0)
    x = 0.005 * np.cumsum(np.cumsum(knocks, axis=0), axis=0) + SIGMA * rng.normal(size=(len(T), 3))
    smooth = smoothing_spline(T, x)
    # Of two knocks within some samples one may pass for outliers: 2 samples in one of 40 draws.
    assert smooth.outliers.size < 10 and smooth.jumps.size < 2


def test_a_burst_of_motion_in_a_rest_is_motion(rng):
    active = (T > 2.0) & (T < 2.5)
    x = np.where(active, 0.1 * np.sin(12.0 * np.pi * (T - 2.0)) ** 3, 0.0)[:, None] * [1.0, 0.5, 0.2]
    smooth = smoothing_spline(T, x + SIGMA * rng.normal(size=(len(T), 3)))
    assert not smooth.outliers.size and not smooth.jumps.size


def test_a_jump_of_attitude_is_taken_off_as_a_turn_of_the_body(rng):
    half = 0.4 * np.sin(2.0 * np.pi * T)
    q = np.stack([np.cos(half), 0.6 * np.sin(half), 0.8 * np.sin(half), 0.0 * T], axis=1)
    q += SIGMA * rng.normal(size=q.shape)
    q /= np.linalg.norm(q, axis=1)[:, None]
    turn = np.array([np.cos(0.01), 0.0, 0.0, np.sin(0.01)])
    jumping = q.copy()
    w, v = q[600:, :1], q[600:, 1:]
    jumping[600:, 0] = w[:, 0] * turn[0] - v @ turn[1:]
    jumping[600:, 1:] = w * turn[1:] + turn[0] * v + np.cross(v, turn[1:])
    smooth, plain = smoothing_spline(T, jumping, dimensions=3), smoothing_spline(T, q, dimensions=3)
    np.testing.assert_allclose(smooth.jumps, T[599] + 0.0025, atol=1e-12)
    # The turn is known to the noise of one sample, and turns nothing else.
    np.testing.assert_allclose(smooth(T, 0)[0], plain(T, 0)[0], atol=4.0 * SIGMA)
