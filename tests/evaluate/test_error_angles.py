"""Compiled angles and statistics of attitude errors are those of NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kreisel.evaluate.error_angles import CHUNK, error_angles, rows_of, spread
from kreisel.maths.arctan import arctan2
from kreisel.maths.rotations import exp_so3, quat_wxyz_from_matrix


def test_arctan2_is_that_of_the_library(rng):
    points = [
        *rng.normal(size=(2000, 2)),
        (0.0, 0.0),
        (0.0, -1.0),
        (1.0, 0.0),
        (-1.0, 0.0),
        (1.0, 1.0),
        (1e-300, 1.0),
    ]
    for y, x in points:
        # Two roundings of pi.
        assert arctan2(float(y), float(x)) == pytest.approx(math.atan2(y, x), rel=5e-16, abs=5e-16)
    assert math.isnan(arctan2(math.nan, 1.0)) and math.isnan(arctan2(1.0, math.nan))


@pytest.mark.parametrize("n", [1, CHUNK - 1, CHUNK, 3 * CHUNK + 7])
@pytest.mark.parametrize("size", [1e-7, 0.1, 2.0])
def test_angles_are_those_of_the_quaternion(n, size, rng):
    truth, by = exp_so3(rng.normal(size=(n, 3))), size * rng.uniform(-1.0, 1.0, (n, 3)) / 1.8
    R = exp_so3(by) @ truth
    w, x, y, z = quat_wxyz_from_matrix((R @ np.swapaxes(truth, 1, 2))[:, None])[:, 0].T
    total, heading, inclination = error_angles(rows_of(truth), R)
    # Sums of three products of rounded matrices.
    near = {"rtol": 0, "atol": 4e-15}
    np.testing.assert_allclose(total, 2.0 * np.arctan2(np.sqrt(x * x + y * y + z * z), w), **near)
    np.testing.assert_allclose(heading, 2.0 * np.arctan2(z, w), **near)
    np.testing.assert_allclose(inclination, 2.0 * np.arctan2(np.hypot(x, y), np.hypot(w, z)), **near)


@pytest.mark.parametrize("n", [1, 2, 3, 15, 16, 17, 20, 21, 1000, 4321])
@pytest.mark.parametrize("kind", ["normal", "equal", "zero", "wide"])
def test_statistics_are_those_of_numpy(n, kind, rng):
    x = {
        "normal": rng.normal(size=n),
        "equal": np.full(n, 0.3),
        "zero": np.zeros(n),
        "wide": 10.0 ** rng.uniform(-15, 0, n) * rng.choice([-1, 1], n),
    }[kind]
    deg = np.degrees(np.abs(x))
    expected = (np.sqrt(np.mean(deg**2)), deg.mean(), np.median(deg), np.percentile(deg, 95.0), deg.max())
    # Sums in another order; a percentile lies between two neighbours either way.
    np.testing.assert_allclose(spread(x), expected, rtol=1e-13)


def test_samples_that_do_not_count_are_left_out_and_nan_is_told():
    x, counts = np.array([1.0, 2.0, np.nan, 3.0]), np.array([True, True, False, True])
    assert spread(x, counts).max == np.degrees(3.0)
    assert all(math.isnan(value) for value in spread(x))
