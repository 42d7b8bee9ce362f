"""Ellipsoids are found exactly without noise, and with noise as surely as the fit says."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.maths.ellipsoid import fit_ellipsoid, spread_of_inverse

SOFT = np.array([[1.05, 0.02, -0.01], [0.02, 0.97, 0.03], [-0.01, 0.03, 1.01]])
CENTRE = np.array([12.0, -30.0, 7.0])


def directions(rng, n):
    u = rng.standard_normal((n, 3))
    return u / np.linalg.norm(u, axis=1)[:, None]


@pytest.mark.parametrize("size", [1e-3, 1.0, 48.0])
def test_points_on_an_ellipsoid_give_it_back(size) -> None:
    y = size * (directions(np.random.default_rng(1), 40) @ SOFT + CENTRE)
    found = fit_ellipsoid(y)
    # Round-off of forty points whose centre lies thirty radii away.
    np.testing.assert_allclose(found.centre, size * CENTRE, rtol=1e-10)
    np.testing.assert_allclose(np.linalg.inv(found.W), size * SOFT, atol=1e-10 * size)


def test_an_hour_of_points_needs_no_square_of_its_memory() -> None:
    y = directions(np.random.default_rng(2), 200_000) @ SOFT + CENTRE
    np.testing.assert_allclose(fit_ellipsoid(y).centre, CENTRE, rtol=1e-9)


def test_six_sides_give_centre_and_scale_along_the_axes() -> None:
    y = np.vstack([np.eye(3), -np.eye(3)]) * [9.7, 9.9, 9.8] + [0.1, -0.2, 0.3]
    found = fit_ellipsoid(y, diagonal=True, sigma=0.01)
    np.testing.assert_allclose(found.centre, [0.1, -0.2, 0.3], atol=1e-12)
    np.testing.assert_allclose(np.diagonal(found.W), 1.0 / np.array([9.7, 9.9, 9.8]), rtol=1e-12)
    # Two readings a side of an axis, half their sum: sigma / sqrt(2).
    np.testing.assert_allclose(np.sqrt(np.diagonal(found.covariance))[:3], 0.01 / np.sqrt(2.0), rtol=1e-6)


def test_points_in_a_plane_are_on_no_ellipsoid() -> None:
    angle = np.linspace(0.0, 6.0, 100)
    assert fit_ellipsoid(np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])) is None
    assert fit_ellipsoid(np.ones((20, 3))) is None


def test_hard_iron_lies_within_three_standard_errors_in_95_of_100_draws() -> None:
    seed = 4
    print("seed", seed)
    rng = np.random.default_rng(seed)
    within, far = 0, []
    for _ in range(100):
        y = 48.0 * directions(rng, 150) @ SOFT + CENTRE + rng.standard_normal((150, 3))
        found = fit_ellipsoid(y)
        off = (found.centre - CENTRE) / np.sqrt(np.diagonal(found.covariance)[:3])
        within += bool((np.abs(off) < 3.0).all())
        far.append(off)
    assert within >= 95
    # 300 numbers of deviation one: four standard errors of their root mean square are 0.16.
    assert 0.84 < np.sqrt(np.mean(np.square(far))) < 1.16


def test_scale_is_as_sure_as_it_says_and_noise_does_not_swell_it() -> None:
    rng = np.random.default_rng(6)
    off = []
    for _ in range(60):
        # Noise of a tenth of the radius: uncorrected the ellipsoid is 1 % too large, an error or more.
        found = fit_ellipsoid(directions(rng, 300) @ SOFT + 0.1 * rng.standard_normal((300, 3)))
        error = spread_of_inverse(found.W, found.covariance)
        off.append(np.diagonal((np.linalg.inv(found.W) - SOFT) / error))
    # Means of sixty numbers of deviation one, four standard errors: 0.52.
    assert (np.abs(np.mean(off, axis=0)) < 0.52).all()
