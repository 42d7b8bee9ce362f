"""Cosine coefficients have the variances predicted, and intervals hold what was put in as often as they say."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.fft import dct

from kreisel.maths.noise_likelihood import likeliest, lower_end, powers, upper_end, without


def covariance(term: int, n: int) -> np.ndarray:
    """Of n samples of one term with coefficient 1, up to what a constant in them could hide."""
    h = np.abs(np.subtract.outer(np.arange(n), np.arange(n))).astype(float)
    if term == 0:
        return np.eye(n)
    if term == 2:  # a walk: lags count the steps that two samples do not share
        return -0.5 * h
    # Samples are differences of a phase of generalised covariance h^2 ln|h| / (2 pi).
    phase = lambda x: x * x * np.log(np.where(x > 0.0, x, 1.0)) / (2.0 * np.pi)  # noqa: E731
    return 2.0 * phase(h) - phase(h + 1.0) - phase(np.abs(h - 1.0))


@pytest.mark.parametrize(("term", "tolerance"), [(0, 1e-9), (1, 1e-3), (2, 1e-9)])
def test_coefficients_have_the_variances_predicted(term, tolerance) -> None:
    n = 400
    cosines = dct(np.eye(n), type=2, norm="ortho", axis=0)[1:]
    exact = np.diagonal(cosines @ covariance(term, n) @ cosines.T)
    found = powers(np.random.default_rng(1).standard_normal(n))
    first = np.r_[0, np.cumsum(found.counts[:-1])].astype(int)
    expected = np.add.reduceat(exact, first) / found.counts
    # White noise and walk to round-off; flicker to the next order of the ends, largest at the highest frequencies.
    np.testing.assert_allclose(found.shapes[:, term], expected, rtol=tolerance)


def test_no_two_coefficients_of_a_walk_are_correlated() -> None:
    n = 100
    cosines = dct(np.eye(n), type=2, norm="ortho", axis=0)[1:]
    every = cosines @ covariance(2, n) @ cosines.T
    off = every - np.diag(np.diagonal(every))
    # Round-off of sums of n^2 terms.
    assert np.abs(off).max() < 1e-9 * np.abs(every).max()


def test_a_constant_and_the_unit_do_not_matter() -> None:
    x = np.random.default_rng(3).standard_normal(500)
    plain, moved = likeliest(powers(x)), likeliest(powers(1e-4 * x + 9.8))
    np.testing.assert_allclose(moved.theta, 1e-8 * plain.theta, rtol=1e-5, atol=1e-13)


def test_intervals_end_where_the_likelihood_has_fallen_and_hold_the_best() -> None:
    rng = np.random.default_rng(4)
    found = powers(rng.standard_normal(4000) + np.cumsum(2e-2 * rng.standard_normal(4000)))
    best = likeliest(found)
    assert without(found, best, 0) > 9.0 and without(found, best, 2) > 9.0
    for term in (0, 2):
        assert lower_end(found, best, term) < best.theta[term] < upper_end(found, best, term)


@pytest.mark.parametrize("walk", [1e-3, 6e-3, 6e-2], ids=["hidden", "hardly visible", "clear"])
def test_intervals_of_a_walk_cover(walk) -> None:
    """The walk reaches the white noise after 3, 0.5 and 0.05 times the length of the record."""
    seed, runs, n = 5, 150, 1000
    print("seed", seed)
    rng = np.random.default_rng(seed)
    white = rng.standard_normal((runs, n))
    covered = 0
    for x in white + np.cumsum(walk * rng.standard_normal((runs, n)), axis=1):
        found = powers(x)
        best = likeliest(found)
        low = lower_end(found, best, 2) if without(found, best, 2) > 9.0 else 0.0
        covered += low <= walk**2 <= upper_end(found, best, 2)
    # Of 150 at 95 %, 132 or fewer have 1 in 1000 of all chances.
    assert covered > 132, covered
