"""Turns residuals that hang together over time into how much they are worth."""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array

# Autocorrelation under which residuals count as independent, or four standard deviations of that of noise.
_SMALL = 0.1

# Bartlett's weights fall to zero at the end of their window: this many correlation lengths lose a third of the tail.
_WINDOW = 3

# Score sums are taken over at most this many lags; beyond, neighbours are added up first.
_MOST_LAGS = 50


def autocorrelation(x: Array, lags: int) -> Array:
    """Autocorrelation (lags + 1,) of the columns of x (n, c), their products added up; NaN rows weigh nothing."""
    from scipy.fft import irfft, next_fast_len, rfft

    filled = np.nan_to_num(x - np.nanmean(x, axis=0))
    size = next_fast_len(2 * len(x), real=True)
    power = np.square(np.abs(rfft(filled, size, axis=0))).sum(axis=1)
    products = irfft(power, size)[: lags + 1]
    return np.asarray(products / products[0]) if products[0] > 0.0 else np.eye(1, lags + 1)[0]


def correlation_length(x: Array) -> int:
    """Last lag, up to a tenth of the samples, at which the rows of x (n, c) are still correlated."""
    n = int(np.isfinite(x[:, 0]).sum())
    rho = autocorrelation(x, len(x) // 10)
    large = np.flatnonzero(np.abs(rho) > max(_SMALL, 4.0 / np.sqrt(n)))
    return int(large[-1]) if large.size else 0


def effective_samples(x: Array, length: int) -> float:
    """How many independent rows would fix the mean of x (n, c) as well; never more than there are."""
    n = int(np.isfinite(x[:, 0]).sum())
    window = window_of(length, n)
    rho = autocorrelation(x, window)
    weights = 1.0 - np.arange(1, window + 1) / (window + 1)
    return float(n / max(1.0, 1.0 + 2.0 * float(weights @ rho[1:])))


def window_of(length: int, samples: int) -> int:
    """Lags to add up for a correlation of `length` rows; a quarter of the samples at most."""
    return min(_WINDOW * length, samples // 4)


def long_run_sum(scores: Array, window: int) -> Array:
    """Covariance (p, p) of the sum of `scores` (n, p), correlated over fewer than `window` rows.

    Source: Newey and West 1987, Econometrica 55 (3), eq. 5. Scores of a fit add up to zero, which takes window / n
    from the sum over lags; it is given back.
    """
    joined = max(1, window // _MOST_LAGS)
    sums = np.add.reduceat(scores, np.arange(0, len(scores), joined), axis=0)
    lags = window // joined
    total = sums.T @ sums
    for lag in range(1, lags + 1):
        product = sums[lag:].T @ sums[:-lag]
        total += (1.0 - lag / (lags + 1)) * (product + product.T)
    return np.asarray(total / (1.0 - window / len(scores)))
