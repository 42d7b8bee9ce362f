"""Means over windows of time, against polynomials integrated by hand."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.maths.window import mean_over_window


def uneven(rng: np.random.Generator) -> np.ndarray:
    return np.cumsum(rng.uniform(0.5, 1.5, 40))


@pytest.mark.parametrize("window", [0.0, 1e-3, 0.7, 5.0])
def test_a_cubic_is_averaged_exactly(window: float, rng: np.random.Generator) -> None:
    t = uneven(rng)
    x = np.stack([0 * t + 2.0, t**2 - t, 0.01 * t**3], axis=1)
    ends = np.sort(rng.uniform(t[0] + window, t[-1], 300))

    def integral(s: np.ndarray) -> np.ndarray:
        return np.stack([2.0 * s, s**3 / 3.0 - s**2 / 2.0, 0.0025 * s**4], axis=1)

    if window:
        expected = (integral(ends) - integral(ends - window)) / window
    else:
        expected = np.stack([0 * ends + 2.0, ends**2 - ends, 0.01 * ends**3], axis=1)
    # The difference of integrals as large as 6000 loses 1e-12 / window.
    np.testing.assert_allclose(mean_over_window(t, x, ends, window), expected, rtol=1e-12, atol=1e-8)


def test_at_the_samples_it_is_the_samples(rng: np.random.Generator) -> None:
    t = uneven(rng)
    x = rng.normal(size=(len(t), 3))
    np.testing.assert_array_equal(mean_over_window(t, x, t, 0.0), x)


def test_before_the_first_sample_it_is_the_first() -> None:
    t, x = np.arange(5.0), np.tile(np.arange(5.0)[:, None], 3) + 1.0
    ends = np.array([-1.0, 0.0, 1.0, 4.0])
    # Over [-1, 1]: one second of 1, one second of 1 to 2.
    np.testing.assert_allclose(mean_over_window(t, x, ends, 2.0)[:, 0], [1.0, 1.0, 1.25, 4.0], rtol=1e-15)
    np.testing.assert_allclose(mean_over_window(t, x, ends, 0.0)[:, 0], [1.0, 1.0, 2.0, 5.0], rtol=1e-15)
