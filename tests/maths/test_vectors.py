"""Vector algebra of kernels: at, below and above the switches of its series."""

import numpy as np
import pytest

from kreisel.maths.vectors import inverse_root_near_one, nearest_rotation


@pytest.mark.parametrize("c", [0.0, 3e-14, 3e-13, 0.99e-8, 1.01e-8, 1e-4, 0.1, -0.1, 0.6])
def test_the_nearest_rotation_is_the_polar_factor(c: float, rng: np.random.Generator) -> None:
    Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    x, y = Q[0], c * Q[0] + np.sqrt(1.0 - c * c) * Q[1]
    rows = np.array([x, y, np.cross(x, y)])
    found = np.array(nearest_rotation(tuple(tuple(row) for row in rows.tolist()), float(x @ y)))
    left, _, right = np.linalg.svd(rows)
    # Below 1e-13 the rows are taken as they are; NumPy's factors are off by up to 6e-15 themselves.
    assert np.abs(found - left @ right).max() < (2e-13 if abs(c) < 1e-13 else 1e-14)
    assert np.abs(found @ found.T - np.eye(3)).max() < (2e-13 if abs(c) < 1e-13 else 4e-15)


@pytest.mark.parametrize("e", [0.0, 1e-9, 0.99e-3, -0.99e-3, 1.01e-3, -1.01e-3, 0.3])
def test_the_inverse_root_is_one_on_both_sides_of_its_switch(e: float) -> None:
    assert inverse_root_near_one(e) == pytest.approx(1.0 / np.sqrt(1.0 + e), rel=4e-16)
    if abs(e) < 1e-3:
        assert inverse_root_near_one(e, True) == inverse_root_near_one(e)
