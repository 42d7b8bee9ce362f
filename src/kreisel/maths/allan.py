"""Turns evenly spaced samples into overlapping Allan variances, and a noise model into how sure these are.

Everything is in units of one sample: averaging times are cluster sizes m, the phase is the running sum of the
samples, and a model is theta = (N^2 / dt, B^2, K^2 dt) of step dt, white noise, bias instability, random walk:
variance(m) = theta_0 / m + (2 ln 2 / pi) theta_1 + theta_2 m / 3.
Source: IEEE Std 952, annex C; D. W. Allan, "Statistics of atomic frequency standards", Proc. IEEE 54 (1966).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]
Sizes = npt.NDArray[np.int64]

FLOOR = 2.0 * np.log(2.0) / np.pi
"""Allan variance of bias instability B = 1."""

# Squares are summed in blocks, so that round-off grows with the number of blocks and not of samples.
_BLOCK = 1024


def overlapping_variances(samples: Array, sizes: Sizes) -> Array:
    """Allan variance (k,) of `samples` (n,) over all overlapping pairs of clusters of m samples, for each size m.

    variance(m) = mean over j of (x_(j+2m) - 2 x_(j+m) + x_j)^2 / (2 m^2), x the running sum of n + 1 values.
    A constant is taken off first, which changes no variance, and the sum is compensated: each x is right to its
    last digit, however long the record.
    """
    phase = np.empty(len(samples) + 1)
    _running_sum(argument(samples), float(np.mean(samples)), phase)
    return np.array([_mean_square(phase, int(m)) / (2.0 * float(m) ** 2) for m in sizes])


@kernel
def _running_sum(samples: Array, constant: float, phase: Array) -> None:
    total, lost = 0.0, 0.0
    phase[0] = 0.0
    for k in range(samples.shape[0]):
        y = samples[k] - constant
        after = total + y
        # Neumaier's: what the sum could not hold of the smaller of the two.
        lost += (total - after) + y if abs(total) >= abs(y) else (y - after) + total
        total = after
        phase[k + 1] = total + lost


@kernel
def _mean_square(phase: Array, m: int) -> float:
    n = phase.shape[0] - 2 * m
    total = 0.0
    for start in range(0, n, _BLOCK):
        part = 0.0
        for k in range(start, min(start + _BLOCK, n)):
            d = (phase[k + 2 * m] - phase[k + m]) - (phase[k + m] - phase[k])
            part += d * d
        total += part
    mean: float = total / n
    return mean


def terms(sizes: Sizes) -> Array:
    """(k, 3): variance(m) of the model is `terms(sizes) @ theta`."""
    m = sizes.astype(np.float64)
    return np.column_stack([1.0 / m, np.full(len(m), FLOOR), m / 3.0])


def variance_forms(samples: int, sizes: Sizes) -> Array:
    """Forms Q (k, 3, 3): the estimate at size i from one record has variance theta^T Q_i theta.

    samples : length of the record.
    An estimate is the mean square of Gaussian second differences d of the phase, and the covariance of two
    squares is twice the square of that of d. Of d it follows from generalised covariances of the phase at lag h,
    -|h| / 2 for white noise, h^2 ln|h| / (2 pi) for flicker and |h|^3 / 12 for random walk: what those leave
    open is a polynomial that second differences remove.
    Source: C. A. Greenhall and W. J. Riley, "Uncertainty of stability variances based on finite differences",
    35th PTTI meeting (2003); the sums over lags are ours.
    """
    return np.array([_form(samples + 1 - 2 * int(m), int(m)) for m in sizes])


def _form(count: int, m: int) -> Array:
    lag, weight = _lags(count, m)
    c = _covariances(lag, m)
    scale = 2.0 / (4.0 * float(m) ** 4 * float(count) ** 2)
    return np.asarray(scale * (c * (weight * (count - np.abs(lag)))) @ c.T)


def _covariances(lag: Array, m: int) -> Array:
    """Covariances (3, lags) of second differences over m, for theta of ones."""
    shift = m * np.arange(-2.0, 3.0)
    sign = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
    h = np.abs(lag[:, None] + shift)
    # Any unit of h inside the logarithm does: the difference is a polynomial. This one keeps digits.
    logarithm = np.log(np.where(h > 0.0, h, 1.0) / m)
    return np.stack([-0.5 * h @ sign, (h * h * logarithm) @ sign / (2.0 * np.pi), h**3 @ sign / 12.0])


# Intervals of lags up to this are summed one by one; longer ones are integrated.
_FEW = 48
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)

# Beyond the last of these, in units of 2 m, the covariance (flicker's, the square of h^-2) adds < 1e-5.
_TAILS = (1, 2, 4, 8, 16)


def _lags(count: int, m: int) -> tuple[Array, Array]:
    """Lags and weights that sum any function smooth between its kinks over all lags two of `count` differences have."""
    kinks = {0, m} | {2 * tail * m for tail in _TAILS}
    high = min(count, 2 * _TAILS[-1] * m)
    edges = sorted({side * k for k in {*kinks, high} if k <= high for side in (-1, 1)})
    pieces = [_piece(a, b) for a, b in pairwise(edges)]
    return np.concatenate([p[0] for p in pieces]), np.concatenate([p[1] for p in pieces])


def _piece(a: int, b: int) -> tuple[Array, Array]:
    """Lags from a to b; the ends count half, their other halves belong to the neighbours."""
    if b - a > _FEW:
        half = 0.5 * (b - a)
        return a + half * (1.0 + _NODES), half * _WEIGHTS
    weight = np.ones(b - a + 1)
    weight[[0, -1]] = 0.5
    return np.arange(a, b + 1, dtype=np.float64), weight
