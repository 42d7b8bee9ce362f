"""Allan variances are those of the definition, keep their digits, and are as uncertain as the theory says."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.maths.allan import FLOOR, overlapping_variances, terms, variance_forms

SIZES = np.array([1, 2, 3, 10, 31, 100, 200])


def by_definition(samples, m):
    """Mean over all pairs of neighbouring clusters of half the squared difference of their means."""
    means = np.convolve(samples, np.ones(m) / m, mode="valid")
    return 0.5 * np.mean((means[m:] - means[:-m]) ** 2)


def test_the_variance_is_that_of_neighbouring_means() -> None:
    y = np.random.default_rng(11).standard_normal(600)
    expected = [by_definition(y, int(m)) for m in SIZES]
    # Six hundred terms of order one: round-off.
    np.testing.assert_allclose(overlapping_variances(y, SIZES), expected, rtol=1e-12)


def test_a_ramp_has_the_variance_of_half_its_square() -> None:
    # Means of neighbours differ by slope * m: the variance is (slope m)^2 / 2 at every pair.
    m = SIZES.astype(float)
    np.testing.assert_allclose(
        overlapping_variances(0.25 * np.arange(600.0), SIZES), 0.5 * (0.25 * m) ** 2, rtol=1e-12
    )


def test_gravity_under_the_noise_of_a_million_samples_costs_no_digits() -> None:
    # Numbers on a grid that both sums hold exactly: what differs is lost by the method alone.
    y = np.random.default_rng(12).integers(-999, 999, 1_000_000) * 2.0**-40
    plain = overlapping_variances(y, SIZES)
    np.testing.assert_allclose(overlapping_variances(y + 1024.0, SIZES), plain, rtol=1e-12)


@pytest.mark.parametrize("theta", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_scatter_over_many_records_is_the_variance_predicted(theta) -> None:
    seed, runs, n = 13, 2000, 300
    print("seed", seed)
    y = np.random.default_rng(seed).standard_normal((runs, n))
    y = y if theta[0] else np.cumsum(y, axis=1)
    sizes = np.array([4, 10, 25, 60])
    found = np.var([overlapping_variances(row, sizes) for row in y], axis=0)
    predicted = np.einsum("a,iab,b->i", theta, variance_forms(n, sizes), theta)
    # Four standard errors of a variance from 2000 heavy-tailed draws, and 3 % for a walk in steps at size 4.
    np.testing.assert_allclose(found, predicted, rtol=0.3)


def test_degrees_of_freedom_agree_with_the_closed_form_for_white_noise() -> None:
    n = 4096
    sizes = np.array([1, 4, 16, 64, 256])
    m, phases = sizes.astype(float), n + 1
    form = variance_forms(n, sizes)[:, 0, 0]
    known = (3 * (phases - 1) / (2 * m) - 2 * (phases - 2) / phases) * 4 * m**2 / (4 * m**2 + 5)
    # Howe, Allan and Barnes 1981, an approximation good to about a percent.
    np.testing.assert_allclose(2.0 / m**2 / form, known, rtol=0.015)


def test_terms_are_white_flat_and_walking() -> None:
    np.testing.assert_allclose(terms(np.array([4])), [[0.25, FLOOR, 4.0 / 3.0]], rtol=1e-15)
