"""How many independent samples correlated ones are worth."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from kreisel.evaluate.align.correlation import correlation_length, effective_samples, long_run_sum, window_of

N = 20000


def autoregressive(rng, phi):
    return lfilter([np.sqrt(1.0 - phi * phi)], [1.0, -phi], rng.normal(size=(N, 3)), axis=0)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_first_order_noise_has_the_effective_number_of_the_textbook(rng, phi):
    x = autoregressive(rng, phi)
    # 0.1 is where correlation is cut off: phi^k = 0.1. Its estimate scatters by a fifth.
    length = correlation_length(x)
    assert length == pytest.approx(np.log(0.1) / np.log(phi) if phi else 0.0, rel=0.4, abs=1.0)
    assert effective_samples(x, length) == pytest.approx(N * (1.0 - phi) / (1.0 + phi), rel=0.3)
    total = long_run_sum(x, window_of(length, N))
    np.testing.assert_allclose(np.diagonal(total) / N, (1.0 + phi) / (1.0 - phi), rtol=0.4)


def test_many_lags_are_summed_in_groups(rng):
    """A window of thousands of rows gives the same sum as one lag after another, within the scatter of either."""
    x = autoregressive(rng, 0.98)
    window = 600
    lags = range(1, window + 1)
    exact = sum((1.0 - k / (window + 1)) * 2.0 * np.sum(x[k:] * x[:-k], axis=0) for k in lags)
    exact = (exact + np.sum(x * x, axis=0)) / (1.0 - window / N)
    np.testing.assert_allclose(np.diagonal(long_run_sum(x, window)), exact, rtol=0.05)
