"""Local polynomials: exact for polynomials, of tenth order, calm in gaps, local."""

import numpy as np
import pytest

from kreisel.maths.stencils import LARGEST_GAIN, WIDTH, between, derivatives

SHARES = np.array([0.1, 0.5, 0.8])


def uneven(rng, n=40):
    return 7.0 + np.cumsum(rng.uniform(0.7, 1.3, n)) / n


def places(t):
    return (t[:-1, None] + SHARES * np.diff(t)[:, None]).ravel()


def test_polynomials_as_high_as_the_width_allows_are_met_exactly(rng):
    t = uneven(rng)
    middle = t.mean()
    polynomial = np.polynomial.Polynomial(rng.normal(size=WIDTH))
    x = polynomial(t - middle)[:, None]
    # Values of order one, weights of sum below 20: round-off is 1e-15 times a few. Near the ends uneven steps
    # may reach the limit of gain and cost an order.
    values, inside = between(t, x, SHARES).ravel(), slice(5 * len(SHARES), -5 * len(SHARES))
    np.testing.assert_allclose(values[inside], polynomial(places(t) - middle)[inside], rtol=0, atol=1e-13)
    value, slope, bend = derivatives(t, x, 2)[..., 0]
    np.testing.assert_array_equal(value, x[:, 0])
    # A difference over one step of 1/40 multiplies round-off by some hundreds, two by the square of that.
    np.testing.assert_allclose(slope, polynomial.deriv()(t - middle), rtol=0, atol=1e-10)
    np.testing.assert_allclose(bend, polynomial.deriv(2)(t - middle), rtol=0, atol=1e-7)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_few_samples_carry_the_polynomial_through_them(rng, n):
    t = uneven(rng, n)
    polynomial = np.polynomial.Polynomial(rng.normal(size=n))
    x = polynomial(t)[:, None]
    # As above; coefficients of order one at times of order ten.
    scale = 1e-12 * np.abs(x).max()
    np.testing.assert_allclose(between(t, x, SHARES).ravel(), polynomial(places(t)), rtol=0, atol=scale)
    slopes = derivatives(t, x, 2)[1:, :, 0]
    np.testing.assert_allclose(slopes[0], polynomial.deriv()(t), rtol=0, atol=1e3 * scale)
    np.testing.assert_allclose(slopes[1], polynomial.deriv(2)(t), rtol=0, atol=1e5 * scale)


def test_error_falls_with_the_tenth_power_of_the_step():
    def worst(n):
        t = np.linspace(0.0, 10.0, n + 1)
        values = between(t, np.sin(4.0 * t)[:, None], np.array([0.5])).ravel()
        inside = slice(WIDTH, -WIDTH)
        return np.abs(values - np.sin(4.0 * 0.5 * (t[1:] + t[:-1])))[inside].max()

    # Steps of 0.1 and 0.05 s: 1e-8 and 1e-11, both far above round-off.
    assert np.log2(worst(100) / worst(200)) == pytest.approx(WIDTH, abs=0.3)


def test_noise_is_amplified_within_the_limit_even_in_a_gap():
    t = np.delete(np.arange(100.0), np.arange(40, 60))
    gains = sum(np.abs(between(t, row[:, None], SHARES)) for row in np.eye(len(t)))
    assert gains.max() <= LARGEST_GAIN
    # Without the limit the ten nearest samples would be weighed by far more in the gap's middle.
    weights = [np.prod([(50.0 - b) / (a - b) for b in t[35:45] if b != a]) for a in t[35:45]]
    assert np.abs(weights).sum() > 10.0 * LARGEST_GAIN


def test_what_happens_at_one_sample_stays_near_it():
    t, x = np.arange(100.0), np.zeros((100, 1))
    x[50] = 1.0
    touched = np.flatnonzero(np.abs(between(t, x, SHARES)).max(axis=(1, 2)))
    assert touched.min() >= 50 - WIDTH
    assert touched.max() < 50 + WIDTH
