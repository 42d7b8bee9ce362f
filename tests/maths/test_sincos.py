"""The SIMD sine and cosine against 30-digit arithmetic."""

import mpmath
import numpy as np
import pytest

from kreisel.maths.sincos import FARTHEST, sincos


def both(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    sine, cosine = np.empty_like(angle), np.empty_like(angle)
    sincos(angle, sine, cosine)
    return sine, cosine


def exact(angle: np.ndarray) -> tuple[list[object], list[object]]:
    with mpmath.workdps(40):
        return [mpmath.sin(x) for x in angle.tolist()], [mpmath.cos(x) for x in angle.tolist()]


def around_quadrants(rng: np.random.Generator) -> np.ndarray:
    """Angles beside multiples of pi/4, where quadrants change, to the last bit and a little further."""
    edges = np.pi / 4 * np.concatenate([np.arange(-20, 21), rng.integers(-1_200_000, 1_200_000, 50)])
    return np.concatenate([edges, np.nextafter(edges, 9e9), np.nextafter(edges, -9e9), edges + 1e-7])


@pytest.mark.parametrize("reach", [1.0, 10.0, 1e3, FARTHEST, 1e12])
def test_error_stays_below_three_units_of_the_last_place(reach: float, rng: np.random.Generator) -> None:
    angle = np.concatenate([rng.uniform(-reach, reach, 1000), around_quadrants(rng)])
    for ours, theirs in zip(both(angle), exact(angle), strict=True):
        assert max(abs(float(a - b)) for a, b in zip(ours.tolist(), theirs, strict=True)) < 3e-16


def test_zero_is_exact() -> None:
    """A body level and heading east must have the identity for its matrix."""
    sine, cosine = both(np.array([0.0, -0.0, 1e-300]))
    np.testing.assert_array_equal(sine, [0.0, 0.0, 1e-300])
    np.testing.assert_array_equal(cosine, 1.0)


def test_nan_stays_nan_and_leaves_its_neighbours_alone() -> None:
    sine, cosine = both(np.array([0.5, np.nan, np.inf, 1.0]))
    np.testing.assert_allclose(sine, [np.sin(0.5), np.nan, np.nan, np.sin(1.0)], rtol=1e-15)
    np.testing.assert_allclose(cosine, [np.cos(0.5), np.nan, np.nan, np.cos(1.0)], rtol=1e-15)
