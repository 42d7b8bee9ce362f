"""Turns samples at uneven times into values between them and slopes at them, by polynomials through the nearest few.

Each place is served by its own neighbours, so that a gap, a jump or an outlier stays where it is; a spline
through all samples would ring. Weights of values are Lagrange's; those of slopes come from the recursion of
Fornberg 1988 (Math. Comp. 51, p. 699), which would serve both at three times the cost.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]

# Samples a polynomial passes through, fewer where there are fewer.
WIDTH = 10

# Largest sum of absolute weights: 1.6 between even steps, 17 in the first and the last of a recording, hundreds in
# the middle of a gap of twenty steps, where fewer samples do better.
LARGEST_GAIN = 25.0


def between(t: Array, x: Array, shares: Array) -> Array:
    """(n - 1, g, c): values of samples x (n, c) at t (n,) s, at `shares` (g,), inside (0, 1), of every step."""
    out = np.empty((max(len(t) - 1, 0), len(shares), x.shape[1]))
    _between(argument(t), argument(x), argument(shares), out)
    return out


def derivatives(t: Array, x: Array, order: int) -> Array:
    """(order + 1, n, c): samples x (n, c) at t (n,) s and their derivatives at the same times.

    Derivatives of higher order than there are neighbours for are 0.
    """
    out = np.zeros((order + 1, *x.shape))
    _derivatives(argument(t), argument(x), out)
    return out


@kernel
def _between(t: Array, x: Array, shares: Array, out: Array) -> None:
    rows = np.empty(WIDTH, dtype=np.int64)
    factors, weights = np.empty(WIDTH), np.empty(WIDTH)
    for k in range(t.shape[0] - 1):
        width = _nearest(t, k, k + 1, 0.5 * (t[k] + t[k + 1]), rows)
        _lagrange_factors(t, rows, width, factors)
        for g in range(shares.shape[0]):
            place = t[k] + shares[g] * (t[k + 1] - t[k])
            while _lagrange(t, rows, width, place, factors, weights) > LARGEST_GAIN and width > 2:
                width -= 1
                _lagrange_factors(t, rows, width, factors)
            _apply(x, rows, width, weights, out[k, g])


@kernel
def _derivatives(t: Array, x: Array, out: Array) -> None:
    rows, weights = np.empty(WIDTH, dtype=np.int64), np.empty((out.shape[0], WIDTH))
    for k in range(t.shape[0]):
        width = _nearest(t, k, k, t[k], rows)
        _fornberg(t, rows, width, t[k], weights)
        for order in range(min(out.shape[0], width)):
            _apply(x, rows, width, weights[order], out[order, k])


@kernel
def _nearest(t: Array, first: int, last: int, place: float, rows: Rows) -> int:
    """Fill `rows` with `first` to `last` and the samples nearest to `place`, nearest first; how many."""
    n = t.shape[0]
    width = 0
    for k in range(first, last + 1):
        rows[width] = k
        width += 1
    while width < min(WIDTH, n):
        if first == 0 or (last < n - 1 and t[last + 1] - place <= place - t[first - 1]):
            last += 1
            rows[width] = last
        else:
            first -= 1
            rows[width] = first
        width += 1
    return width


@kernel
def _lagrange_factors(t: Array, rows: Rows, width: int, factors: Array) -> None:
    """The part of Lagrange's weights that is the same at all places: 1 / product of (t_i - t_j)."""
    for i in range(width):
        product = 1.0
        for j in range(width):
            if j != i:
                product *= t[rows[i]] - t[rows[j]]
        factors[i] = 1.0 / product


@kernel
def _lagrange(t: Array, rows: Rows, width: int, place: float, factors: Array, weights: Array) -> float:
    """Fill `weights` of the value at a `place` that is no sample; the sum of their absolute values."""
    whole = 1.0
    for i in range(width):
        whole *= place - t[rows[i]]
    gain = 0.0
    for i in range(width):
        weights[i] = whole * factors[i] / (place - t[rows[i]])
        gain += abs(weights[i])
    return gain


@kernel
def _fornberg(t: Array, rows: Rows, width: int, place: float, weights: Array) -> None:
    """Weights of the value and the first derivatives at `place` of the polynomial through `rows`."""
    weights[:, :width] = 0.0
    weights[0, 0] = 1.0
    product_before, here = 1.0, t[rows[0]] - place
    for i in range(1, width):
        highest = min(i, weights.shape[0] - 1)
        product, before, here = 1.0, here, t[rows[i]] - place
        for j in range(i):
            gap = t[rows[i]] - t[rows[j]]
            product *= gap
            if j == i - 1:
                ratio = product_before / product
                for d in range(highest, 0, -1):
                    weights[d, i] = ratio * (d * weights[d - 1, j] - before * weights[d, j])
                weights[0, i] = -ratio * before * weights[0, j]
            for d in range(highest, 0, -1):
                weights[d, j] = (here * weights[d, j] - d * weights[d - 1, j]) / gap
            weights[0, j] *= here / gap
        product_before = product


@kernel
def _apply(x: Array, rows: Rows, width: int, weights: Array, out: Array) -> None:
    for c in range(x.shape[1]):
        total = 0.0
        for i in range(width):
            total += weights[i] * x[rows[i], c]
        out[c] = total
