"""Smoothest curves, and slopes that do not swing past their points."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from kreisel.maths.polynomials import Polynomials, even_slopes, hermite, joined, smoothest_through


def points(rng, n):
    return np.cumsum(rng.uniform(0.5, 2.0, n)), rng.normal(size=(n, 3))


def test_derivatives_are_those_of_numpy(rng):
    coefficients = rng.normal(size=(1, 8, 2))
    x = np.linspace(-1.0, 2.0, 7)
    found = Polynomials(np.array([0.5, 9.0]), coefficients)(x, 9)
    for c in range(2):
        one = np.polynomial.Polynomial(coefficients[0, :, c])
        for d in range(10):
            # Eight terms of up to 7! x 1.5^7.
            np.testing.assert_allclose(
                found[d, :, c], one.deriv(d)(x - 0.5) if d else one(x - 0.5), atol=1e-10
            )


@pytest.mark.parametrize("m", [3, 4])
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("n", [5, 40])
def test_the_smoothest_curve_is_the_natural_spline(m, closed, n, rng):
    x, y = points(rng, n)
    if closed:
        y[-1] = y[0]
    ends = [(d, np.zeros(3)) for d in range(m, 2 * m - 1)]
    spline = make_interp_spline(x, y, k=2 * m - 1, bc_type="periodic" if closed else (ends, ends))
    curve = smoothest_through(x, y, m, closed)
    t = np.linspace(x[0], x[-1], 301)
    # Two ways to solve systems whose condition is some 1e4.
    np.testing.assert_allclose(curve(t, 0)[0], spline(t), atol=1e-10 * np.abs(spline(t)).max())
    np.testing.assert_allclose(curve(x, 0)[0], y, atol=1e-12)


@pytest.mark.parametrize("m", [3, 4])
def test_derivatives_that_are_given_hold_and_the_rest_is_least(m, rng):
    x, y = points(rng, 6)
    known = np.full((6, m - 1, 3), np.nan)
    known[0], known[-1], known[2, 0] = 0.0, 0.0, [1.0, -2.0, 0.5]
    curve = smoothest_through(x, y, m, known=known)
    derivatives = curve(x, m - 1)
    np.testing.assert_allclose(derivatives[1:, [0, -1]], 0.0, atol=1e-10)
    np.testing.assert_allclose(derivatives[1, 2], known[2, 0], atol=1e-12)
    least = cost(curve, m)
    for row in (1, 2, 3, 4):
        nudged = known.copy()
        nudged[row, -1] = derivatives[-1, row] + 0.1
        assert cost(smoothest_through(x, y, m, known=nudged), m) > least


def cost(curve, m):
    """Integral of the squared derivative number m, by Gauss's rule, which is exact."""
    u, w = np.polynomial.legendre.leggauss(m + 1)
    half = 0.5 * np.diff(curve.breaks)
    t = curve.breaks[:-1, None] + half[:, None] * (1.0 + u)
    return float(np.sum(half[:, None] * w * (curve(t.ravel(), m)[m] ** 2).sum(axis=1).reshape(t.shape)))


def test_two_points_are_joined_by_a_straight_line():
    line = smoothest_through(np.array([0.0, 2.0]), np.array([[0.0, 1.0], [4.0, -1.0]]), 4)
    np.testing.assert_allclose(
        line(np.array([0.5, 1.0]), 2), [[[1, 0.5], [2, 0]], [[2, -1]] * 2, [[0, 0]] * 2], atol=1e-14
    )


def test_the_smoothest_way_from_rest_to_rest_is_the_known_quintic():
    known = np.zeros((2, 2, 1))
    curve = smoothest_through(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]), 3, known=known)
    # Flash and Hogan 1985: 10 t^3 - 15 t^4 + 6 t^5.
    np.testing.assert_allclose(curve.coefficients[0, :, 0], [0, 0, 0, 10, -15, 6], atol=1e-12)


def test_parts_become_one():
    one = smoothest_through(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]), 3)
    other = smoothest_through(np.array([1.0, 2.0, 3.0]), np.array([[1.0], [0.0], [2.0]]), 3)
    both = joined([one, other])
    t = np.array([0.5, 1.0, 2.9])
    np.testing.assert_array_equal(both(t, 2)[:, 0], one(t[:1], 2)[:, 0])
    np.testing.assert_array_equal(both(t, 2)[:, 1:], other(t[1:], 2))


@pytest.mark.parametrize("m", [3, 4])
def test_even_slopes_do_not_swing_past_the_points(m, rng):
    for closed in (False, True):
        x = np.cumsum(rng.uniform(0.1, 3.0, 30))
        y = np.cumsum(rng.exponential(size=30) ** 3)
        slopes = even_slopes(x, y, closed)
        ends = np.zeros((30, m, 1))
        ends[:, 0, 0], ends[:, 1, 0] = y, slopes
        curve = hermite(x, np.stack([ends[:-1], ends[1:]], axis=1))
        # Round-off of a slope that may touch zero.
        assert curve(np.linspace(x[0], x[-1], 4001), 1)[1].min() > -1e-9 * slopes.max()


def test_even_slopes_keep_what_is_even():
    x = np.array([0.0, 1.0, 3.0, 4.0])
    np.testing.assert_allclose(even_slopes(x, 2.0 * x), [0.0, 2.0, 2.0, 0.0])
    np.testing.assert_allclose(even_slopes(x, 2.0 * x, closed=True), 2.0)
