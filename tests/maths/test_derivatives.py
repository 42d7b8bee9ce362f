"""Noise is told from motion, and splines differentiate what they go through."""

import numpy as np
import pytest

from kreisel.maths.derivatives import interpolating_spline, noise_level

T = np.arange(0.0, 10.0, 0.005)


def path(t):
    return np.stack([np.cos(2 * np.pi * t), np.sin(6 * np.pi * t), 0.3 * t], axis=1)


@pytest.mark.parametrize("sigma", [1e-7, 1e-4, 1e-2])
def test_white_noise_is_measured_whatever_its_level(rng, sigma):
    noisy = path(T) + sigma * rng.normal(size=(len(T), 3))
    # 2000 differences, of which neighbours share most of their samples, leave a standard error of 5 %: six of them.
    np.testing.assert_allclose(noise_level(T, noisy), sigma, rtol=0.3)


def test_uneven_steps_are_no_noise(rng):
    t = np.sort(T + rng.uniform(-0.001, 0.001, len(T)))
    # Under a tenth of a nanometre: round-off, a millionth of what a camera resolves.
    assert noise_level(t, path(t)).max() < 1e-10


@pytest.mark.parametrize("rate", [20.0, 50.0, 200.0, 1000.0])
def test_clean_motion_has_no_noise_at_any_rate_that_resolves_it(rate):
    t = np.arange(0.0, 10.0, 1.0 / rate)
    assert noise_level(t, path(t)).max() < 1e-8


def test_a_few_jumps_in_velocity_are_no_noise():
    t = np.arange(0.0, 10.0, 0.005)
    saw = np.abs((t % 2.0) - 1.0)
    assert noise_level(t, saw[:, None]).max() < 1e-12


def test_rounding_to_millimetres_is_seen_as_its_own_noise():
    rounded = np.round(path(T)[:, :2], 3)
    # A uniform error of one step has a standard deviation of 1 / sqrt(12) of it.
    np.testing.assert_allclose(noise_level(T, rounded), 1e-3 / np.sqrt(12.0), rtol=0.3)


def test_spline_reproduces_polynomials_of_its_degree_and_their_derivatives(rng):
    t = np.linspace(0.0, 2.0, 40)
    t[1:-1] += rng.uniform(-0.3, 0.3, 38) * (t[1] - t[0])
    polynomial = np.polynomial.Polynomial(rng.normal(size=10))
    at = np.linspace(0.0, 2.0, 101)
    found = interpolating_spline(t, polynomial(t)[:, None])(at, 3)
    for k in range(4):
        exact = polynomial.deriv(k)(at) if k else polynomial(at)
        # Round-off of the values, some 1e3, grows by the inverse of the shortest step, 0.02 s, with each
        # derivative, and by a factor of hundreds at the ends of degree nine.
        np.testing.assert_allclose(found[k, :, 0], exact, rtol=0, atol=1e-10 * 50.0**k)


@pytest.mark.parametrize("n", [6, 7, 8, 9, 10, 11])
def test_few_samples_lower_the_degree(n):
    t = np.linspace(0.0, 1.0, n)
    np.testing.assert_allclose(interpolating_spline(t, (t**3)[:, None])(t, 2)[2, :, 0], 6.0 * t, atol=1e-9)
