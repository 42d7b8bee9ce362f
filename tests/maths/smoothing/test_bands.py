"""Banded matrices of splines are what dense algebra and SciPy's splines say."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from kreisel.maths.smoothing.bands import (
    DEGREE,
    ORDER,
    Rows,
    basis_rows,
    correlated,
    gram,
    inverse_band,
    knots_at,
    penalty_rows,
    quadratic_forms,
    whitened,
    whitened_rows,
)


def dense(rows: Rows, size: int) -> np.ndarray:
    out = np.zeros((len(rows.starts), size + rows.values.shape[1]))
    for row, values, start in zip(out, *rows, strict=True):
        row[start : start + len(values)] = values
    return out[:, :size]


def from_band(band: np.ndarray) -> np.ndarray:
    lower = sum(np.diag(band[k, : band.shape[1] - k], -k) for k in range(len(band)))
    return lower + np.tril(lower, -1).T


@pytest.fixture
def stamps(rng):
    """Uneven, with a gap."""
    t = np.sort(rng.uniform(0.0, 3.0, 150))
    return t[(t < 1.0) | (t > 1.3)]


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_rows_are_the_derivatives_of_the_spline(stamps, rng, order):
    knots = knots_at(stamps, 0.02)
    c = rng.normal(size=len(knots) - DEGREE - 1)
    exact = (
        BSpline(knots, c, DEGREE).derivative(order)(stamps) if order else BSpline(knots, c, DEGREE)(stamps)
    )
    # Round-off, which every derivative multiplies by a degree over a knot spacing.
    np.testing.assert_allclose(
        dense(basis_rows(knots, stamps, order), len(c)) @ c, exact, rtol=0, atol=1e-12 * (9 / 0.015) ** order
    )


def test_there_are_no_knots_in_a_gap_and_none_too_near(stamps):
    inner = knots_at(stamps, 0.02)[DEGREE:-DEGREE]
    assert not ((inner > 1.0) & (inner < 1.3) & ~np.isin(inner, stamps)).any()
    assert np.diff(inner).min() >= 0.75 * 0.02
    assert (inner[0], inner[-1]) == (stamps[0], stamps[-1])


def test_the_penalty_is_that_of_differences_on_even_knots_and_spares_polynomials_on_all(stamps):
    even = penalty_rows(0.1 * np.arange(40.0), 0.1)
    difference = np.diff(np.eye(30), ORDER, axis=0)
    np.testing.assert_allclose(dense(even, 30), difference, atol=1e-11)
    knots = knots_at(stamps, 0.02)
    size = len(knots) - DEGREE - 1
    # Marsden's identity: the coefficients of t are the means of DEGREE knots.
    line = np.array([knots[k + 1 : k + DEGREE + 1].mean() for k in range(size)])
    assert np.abs(dense(penalty_rows(knots, 0.02), size) @ line).max() < 1e-9


def test_whitening_takes_the_correlation_out(stamps):
    memory = 0.05
    rows = basis_rows(knots_at(stamps, 0.02), stamps)
    kept, new = correlated(stamps, rows.starts, memory)
    together = np.flatnonzero(kept)
    covariance = np.exp(-np.abs(stamps[:, None] - stamps) / memory)
    turned = whitened(covariance, kept, new) @ whitened(np.eye(len(stamps)), kept, new).T
    # Where two samples are taken together nothing of it is left; over the gap they are not.
    np.testing.assert_allclose(np.diag(turned), 1.0, atol=1e-12)
    np.testing.assert_allclose(turned[together, together - 1], 0.0, atol=1e-12)
    size = int(rows.starts.max()) + DEGREE + 1
    np.testing.assert_allclose(
        dense(whitened_rows(rows, kept, new), size), whitened(dense(rows, size), kept, new), atol=1e-12
    )


def test_gram_inverse_and_forms_agree_with_dense_algebra(stamps):
    knots = knots_at(stamps, 0.02)
    rows, size = basis_rows(knots, stamps), len(knots) - DEGREE - 1
    band = gram(rows, size)
    np.testing.assert_allclose(from_band(band), dense(rows, size).T @ dense(rows, size), atol=1e-12)
    band[0] += 1.0
    lower = np.linalg.cholesky(from_band(band))
    factor = np.zeros_like(band)
    for k in range(len(band)):
        factor[k, : size - k] = np.diag(lower, -k)
    inverse = np.linalg.inv(from_band(band))
    found = inverse_band(factor)
    for k in range(len(band)):
        np.testing.assert_allclose(found[k, : size - k], np.diag(inverse, -k), atol=1e-12)
    forms = np.einsum("ni,ij,nj->n", dense(rows, size), inverse, dense(rows, size))
    np.testing.assert_allclose(quadratic_forms(rows, found), forms, rtol=1e-10)
