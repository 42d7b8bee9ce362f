"""Turns knots and time stamps into the banded matrices of a penalised spline, and their factors into variances.

Every row of such a matrix is a few numbers and the column of the first: a sample sees ten basis functions, and two
more where it is taken together with the sample before it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

ORDER = 5
"""The penalty is on this derivative. An accelerometer sees the second one and, with a lever arm, the second
one of the attitude; on the loop of figure 1 with 0.1 mm of noise at 200 Hz orders 3, 4, 5 leave 1.3, 0.35
and 0.19 m/s^2."""

DEGREE = 2 * ORDER - 1
"""Degree of the spline that minimises such a penalty (Schoenberg 1964)."""

REACH = 2
"""Two samples are taken together where their basis functions begin at most this many apart."""

# Knots lie at samples at least this share of the spacing apart: stamps jitter.
_LEAST = 0.75


class Rows(NamedTuple):
    """A matrix with one narrow band of numbers in each row."""

    values: Array  # (n, width)
    starts: Integers  # (n,) column of the first number


def knots_at(t: Array, spacing: float) -> Array:
    """Knots (m,) at samples `t` about `spacing` s apart, none where there are no samples; DEGREE beyond each end.

    Splines that minimise the penalty have their knots at samples; a gap without knots keeps the equations sound.
    """
    inside = np.empty(len(t))
    inner = inside[: _thinned(argument(t), _LEAST * spacing, inside)]
    beyond = spacing * np.arange(1.0, DEGREE + 1.0)
    return np.concatenate([inner[0] - beyond[::-1], inner, inner[-1] + beyond])


@kernel
def _thinned(t: Array, least: float, out: Array) -> int:
    """Fill `out` with the first sample, the last, and those between that are `least` apart; how many."""
    out[0], count, last = t[0], 1, t[-1]
    for k in range(1, t.shape[0] - 1):
        if t[k] - out[count - 1] >= least and last - t[k] >= least:
            out[count] = t[k]
            count += 1
    out[count] = last
    return count + 1


def derivative_bands(knots: Array, order: int) -> Array:
    """(order + 1, m): derivative k of the spline has the coefficients sum over r of bands[r, i] c[i + r].

    Source: de Boor 1978, chapter X, eq. (15), repeated.
    """
    size = len(knots) - DEGREE - 1
    bands = np.ones((1, size))
    for k in range(1, order + 1):
        i = np.arange(size - k)
        slope = (DEGREE - k + 1) / (knots[i + DEGREE + 1] - knots[i + k])
        wider = np.zeros((k + 1, size - k))
        wider[:-1] = -slope * bands[:, :-1]
        wider[1:] += slope * bands[:, 1:]
        bands = wider
    return bands


def penalty_rows(knots: Array, unit: float) -> Rows:
    """Matrix whose squared product with the coefficients is the penalty, with time counted in `unit` s.

    The integral of the squared derivative, each basis function of it lumped into one number; on even knots these are
    the fifth differences of Eilers and Marx (1996), on others the general P-splines of Li and Cao (2022).
    """
    bands = derivative_bands(knots / unit, ORDER)
    i = np.arange(bands.shape[1])
    support = (knots[i + 2 * ORDER] - knots[i + ORDER]) / (ORDER * unit)
    return Rows(np.ascontiguousarray((bands * np.sqrt(support)).T), i)


def basis_rows(knots: Array, t: Array, order: int = 0) -> Rows:
    """Matrix from coefficients to derivative `order` of the spline at increasing times `t` (n,)."""
    rows = Rows(np.zeros((len(t), DEGREE + 1)), np.empty(len(t), dtype=np.int64))
    _basis(argument(knots), argument(t), order, argument(derivative_bands(knots, order)), *rows)
    return rows


@kernel
def _basis(knots: Array, t: Array, order: int, bands: Array, values: Array, starts: Integers) -> None:
    """Basis functions of degree DEGREE - order by the triangle of Cox and de Boor, spread by `bands`."""
    count, degree = knots.shape[0] - DEGREE - 1, DEGREE - order
    now, left, right = np.empty(DEGREE + 1), np.empty(DEGREE + 1), np.empty(DEGREE + 1)
    i = DEGREE
    for row in range(t.shape[0]):
        while i < count - 1 and t[row] >= knots[i + 1]:
            i += 1
        now[0] = 1.0
        for d in range(1, degree + 1):
            left[d], right[d] = t[row] - knots[i + 1 - d], knots[i + d] - t[row]
            carried = 0.0
            for r in range(d):
                share = now[r] / (right[r + 1] + left[d - r])
                now[r] = carried + right[r + 1] * share
                carried = left[d - r] * share
            now[d] = carried
        starts[row] = i - DEGREE
        for r in range(degree + 1):
            for s in range(order + 1):
                values[row, r + s] += now[r] * bands[s, i - DEGREE + r]


def correlated(t: Array, starts: Integers, time: float) -> tuple[Array, Array]:
    """Share (n,) of the noise before that a sample still has, and the size (n,) of what is new, of noise 1.

    Noise that forgets with the time constant `time` s: exp(-dt / time), on steps of any length. Samples too far
    apart to be taken together, and all where `time` is 0, are new altogether.
    """
    kept, new = np.zeros(len(t)), np.ones(len(t))
    if time > 0.0:
        step = np.diff(t) / time
        near = np.diff(starts) <= REACH
        kept[1:] = np.where(near, np.exp(-step), 0.0)
        new[1:] = np.where(near, np.sqrt(-np.expm1(-2.0 * step)), 1.0)
    return kept, new


def whitened_rows(rows: Rows, kept: Array, new: Array) -> Rows:
    """Rows of what is new in each sample, per its size."""
    out = Rows(np.zeros((len(kept), DEGREE + 1 + REACH)), rows.starts.copy())
    _whiten(argument(rows.values), argument(kept), argument(new), rows.starts, *out)
    return out


@kernel
def _whiten(values: Array, kept: Array, new: Array, starts: Integers, out: Array, first: Integers) -> None:
    for k in range(values.shape[0]):
        shift = 0
        if kept[k] != 0.0:
            shift = starts[k] - starts[k - 1]
            first[k] = starts[k - 1]
            for r in range(DEGREE + 1):
                out[k, r] = -kept[k] * values[k - 1, r] / new[k]
        for r in range(DEGREE + 1):
            out[k, r + shift] += values[k, r] / new[k]


def whitened(x: Array, kept: Array, new: Array) -> Array:
    """What is new in each sample of `x` (n, c), per its size."""
    out = x.copy()
    out[1:] -= kept[1:, None] * x[:-1]
    return out / new[:, None]


def gram(rows: Rows, size: int) -> Array:
    """Lower diagonals (width, size) of the product of the transposed matrix and itself, as LAPACK wants them."""
    band = np.zeros((rows.values.shape[1], size))
    _gram(argument(rows.values), rows.starts, band)
    return band


@kernel
def _gram(values: Array, starts: Integers, band: Array) -> None:
    for k in range(values.shape[0]):
        first = starts[k]
        width = min(values.shape[1], band.shape[1] - first)
        for p in range(width):
            for q in range(p, width):
                band[q - p, first + p] += values[k, p] * values[k, q]


def transposed(rows: Rows, x: Array, size: int) -> Array:
    """(size, c) product of the transposed matrix and `x` (n, c)."""
    out = np.zeros((size, x.shape[1]))
    _transposed(argument(rows.values), rows.starts, argument(x), out)
    return out


@kernel
def _transposed(values: Array, starts: Integers, x: Array, out: Array) -> None:
    for k in range(values.shape[0]):
        for p in range(min(values.shape[1], out.shape[0] - starts[k])):
            for c in range(x.shape[1]):
                out[starts[k] + p, c] += values[k, p] * x[k, c]


def product(rows: Rows, coefficients: Array) -> Array:
    """(n, c) product of the matrix and `coefficients` (size, c)."""
    out = np.zeros((len(rows.starts), coefficients.shape[1]))
    _product(argument(rows.values), rows.starts, argument(coefficients), out)
    return out


@kernel
def _product(values: Array, starts: Integers, coefficients: Array, out: Array) -> None:
    for k in range(values.shape[0]):
        for p in range(min(values.shape[1], coefficients.shape[0] - starts[k])):
            for c in range(coefficients.shape[1]):
                out[k, c] += values[k, p] * coefficients[starts[k] + p, c]


def inverse_band(factor: Array) -> Array:
    """Band (width, size) of the inverse of a matrix from that of its Cholesky factor."""
    band = np.zeros_like(factor)
    _inverse_band(argument(factor), band)
    return band


@kernel
def _inverse_band(factor: Array, out: Array) -> None:
    """From the last column back (Takahashi 1973)."""
    width, size = factor.shape
    for i in range(size - 1, -1, -1):
        reach = min(width - 1, size - 1 - i)
        for k in range(reach, 0, -1):
            total = 0.0
            for m in range(1, reach + 1):
                total += factor[m, i] * out[abs(m - k), i + min(m, k)]
            out[k, i] = -total / factor[0, i]
        total = 1.0 / factor[0, i]
        for m in range(1, reach + 1):
            total -= factor[m, i] * out[m, i]
        out[0, i] = total / factor[0, i]


def quadratic_forms(rows: Rows, band: Array) -> Array:
    """(n,) r^T Z r for every row r and a symmetric Z, given by its band."""
    out = np.empty(len(rows.starts))
    _quadratic_forms(argument(rows.values), rows.starts, argument(band), out)
    # Round-off of a sum whose terms cancel.
    return np.maximum(out, 0.0)


@kernel
def _quadratic_forms(values: Array, starts: Integers, band: Array, out: Array) -> None:
    for k in range(values.shape[0]):
        width = min(values.shape[1], band.shape[1] - starts[k])
        total = 0.0
        for p in range(width):
            i = starts[k] + p
            total += values[k, p] * values[k, p] * band[0, i]
            for q in range(p + 1, width):
                total += 2.0 * values[k, p] * values[k, q] * band[q - p, i]
        out[k] = total
