"""Turns true and estimated attitudes into the angles of the error between them, and these into statistics.

Compiled, and the same to the bit for one run as for a thousand: `attitude_errors` and ensembles both call this.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import Mask
from kreisel.data.checks import Array
from kreisel.maths.arctan import arctan2
from kreisel.maths.kernels import LANES, argument, inlined, kernel, wide_vectors
from kreisel.maths.vectors import Vector, dot, load

CHUNK = 256
"""Samples worked on at a time: their matrices lie in the first-level cache."""

DEGREES = 180.0 / math.pi

# Magnitudes in degrees are counted by the upper bits of their floating-point numbers: exponent and six of mantissa,
# from 2^-31 up. What is smaller counts together.
_SHIFT = np.int64(46)
_LOWEST = np.int64((1023 - 31) << 6)
_BUCKETS = 2560

# Samples that are looked through at once for those of the two ranks.
_SEEN = 64


Counts = npt.NDArray[np.int64]


class Spread(NamedTuple):
    """Statistics of the magnitudes of one angle over a run, deg; NaN where one of them is."""

    rmse: float
    mean: float
    median: float
    p95: float
    max: float


def rows_of(R: Array) -> Array:
    """Matrices (n, 3, 3) as rows (blocks, 9 * CHUNK), one per element: how `error_angles` takes the truth.

    Made once for many estimates; the last block is filled up with zeros.
    """
    blocks = -(-len(R) // CHUNK)
    padded = np.zeros((blocks * CHUNK, 9))
    padded[: len(R)] = R.reshape(len(R), 9)
    return np.ascontiguousarray(padded.reshape(blocks, CHUNK, 9).swapaxes(1, 2)).reshape(blocks, 9 * CHUNK)


def error_angles(truth: Array, R: Array) -> Array:
    """Total, heading (signed) and inclination (3, n) rad of the errors of R (n, 3, 3) against `rows_of` the truth."""
    angles = np.empty((3, len(R)))
    angles_into(argument(truth), argument(R), angles)
    return angles


def spread(angle: Array, counts: Mask | None = None) -> Spread:
    """Statistics of |angle| (n,) rad over the samples that count, all of them for None; at least one has to."""
    chosen = angle if counts is None else angle[counts]
    out = np.empty(len(Spread._fields))
    spread_into(argument(chosen), np.empty((3, len(chosen) + 1)), out)
    return Spread(*out.tolist())


@kernel
def angles_into(truth: Array, R: Array, angles: Array) -> None:
    """`error_angles`, into `angles` (3, n)."""
    wide_vectors()
    e, out = np.zeros(9 * CHUNK), np.empty(3 * CHUNK)
    for block in range(truth.shape[0]):
        begin = block * CHUNK
        m = min(CHUNK, R.shape[0] - begin)
        for i in range(m):
            for row in range(3):
                for c in range(3):
                    e[(3 * row + c) * CHUNK + i] = R[begin + i, row, c]
        _angles(truth[block], e, out)
        for k in range(3):
            for i in range(m):
                angles[k, begin + i] = out[k * CHUNK + i]


@kernel
def angles_abreast(truth: Array, answers: Array, first: int, angles: Array) -> None:
    """`error_angles` of answers (n, 9, LANES) against R (n, 9), into columns from `first` on of (LANES, 3, N)."""
    wide_vectors()
    e, t, out = answers.reshape(-1), np.empty(9), np.empty(3 * LANES)
    for i in range(answers.shape[0]):
        for k in range(9):
            t[k] = truth[i, k]
        _angles_of_lanes(t, e[9 * LANES * i : 9 * LANES * (i + 1)], out)
        for lane in range(LANES):
            for k in range(3):
                angles[lane, k, first + i] = out[k * LANES + lane]


@kernel
def _angles_of_lanes(t: Array, e: Array, out: Array) -> None:
    """`_angles` of one attitude t (9,) against as many estimates e (9 * LANES,) as there are lanes."""
    wide_vectors()
    for j in range(LANES):
        x = e[j], e[LANES + j], e[2 * LANES + j]
        y = e[3 * LANES + j], e[4 * LANES + j], e[5 * LANES + j]
        z = e[6 * LANES + j], e[7 * LANES + j], e[8 * LANES + j]
        found = _angles_between(load(t, 0), load(t, 3), load(t, 6), x, y, z)
        out[j], out[LANES + j], out[2 * LANES + j] = found


@kernel
def figures_into(angles: Array, t: Array, limit_deg: float, room: Array, out: Array) -> None:
    """Into `out` (16,) the `spread` of each of the angles (3, n), and when the total falls below the limit for good.

    That is counted in s after the first of the times t (n,), and infinite where it never does.
    room (3, n + 1) is written to.
    """
    for k in range(3):
        spread_into(angles[k], room, out[5 * k : 5 * k + 5])
    n = t.shape[0]
    last = n - 1
    while last >= 0 and not angles[0, last] * DEGREES >= limit_deg:
        last -= 1
    out[15] = 0.0 if last < 0 else t[last + 1] - t[0] if last + 1 < n else np.inf


@kernel
def _angles(t: Array, e: Array, out: Array) -> None:
    """The angles of a chunk, from rows of elements."""
    wide_vectors()
    for i in range(CHUNK):
        found = _angles_between(
            _row(t, i, 0), _row(t, i, 1), _row(t, i, 2), _row(e, i, 0), _row(e, i, 1), _row(e, i, 2)
        )
        out[i], out[CHUNK + i], out[2 * CHUNK + i] = found


@inlined
def _row(m: Array, i: int, row: int) -> Vector:
    """Of the matrix at sample i."""
    k = 3 * row * CHUNK + i
    return m[k], m[k + CHUNK], m[k + 2 * CHUNK]


@inlined
def _angles_between(tx: Vector, ty: Vector, tz: Vector, ex: Vector, ey: Vector, ez: Vector) -> Vector:
    """Total, heading and inclination of E = R_est R_true^T, whose rows are given.

    Heading is the twist about up of its quaternion, inclination the way of its third axis. With the quaternion
    (w, x, y, z), E10 - E01 = 4 w z and E00 + E11 = 2 (w^2 - z^2), so that
    heading = 2 atan(z / w) = atan2(E10 - E01, E00 + E11); and E22 = cos of the inclination.
    """
    xx, xy, xz = dot(ex, tx), dot(ex, ty), dot(ex, tz)
    yx, yy, yz = dot(ey, tx), dot(ey, ty), dot(ey, tz)
    zx, zy, zz = dot(ez, tx), dot(ez, ty), dot(ez, tz)
    a, b, c = zy - yz, xz - zx, yx - xy
    return (
        arctan2(math.sqrt(a * a + b * b + c * c), xx + yy + zz - 1.0),
        arctan2(c, xx + yy),
        arctan2(math.sqrt(xz * xz + yz * yz), zz),
    )


@kernel
def spread_into(angle: Array, room: Array, out: Array) -> None:
    """`spread` of all samples (n,), into `out` (5,); `room` (3, n + 1) is written to."""
    wide_vectors()
    n = angle.shape[0]
    x = room[0, :n]
    out[0], out[1], out[4] = _moments(angle, x)
    if not out[1] < np.inf:
        out[:] = np.nan
        return
    below = np.zeros(_BUCKETS + 1, np.int64)
    for k in range(n):
        below[_bucket(x[k]) + 1] += 1
    for k in range(_BUCKETS):
        below[k + 1] += below[k]
    out[2], out[3] = _two_ranks(x, below, 0.5 * (n - 1), 0.95 * (n - 1), room[1], room[2])


@kernel
def _moments(angle: Array, x: Array) -> tuple[float, float, float]:
    """Root mean square, mean and largest of the magnitudes, which are put into `x`, deg."""
    wide_vectors()
    n = angle.shape[0]
    sums, squares, largest = np.zeros(CHUNK), np.zeros(CHUNK), np.zeros(CHUNK)
    # Sums of every 256th sample: LLVM keeps the order of a sum, and one sum would wait for itself.
    for begin in range(0, n, CHUNK):
        part, out = angle[begin : begin + CHUNK], x[begin : begin + CHUNK]
        for j in range(part.shape[0]):
            value = abs(part[j]) * DEGREES
            out[j] = value
            sums[j] += value
            squares[j] += value * value
            largest[j] = value if value > largest[j] else largest[j]
    return math.sqrt(squares.sum() / n), sums.sum() / n, largest.max()


@kernel
def _bucket(x: float) -> np.int64:
    bits = np.float64(x).view(np.int64)
    return min(max((bits >> _SHIFT) - _LOWEST, np.int64(0)), np.int64(_BUCKETS - 1))


@kernel
def _two_ranks(
    x: Array, below: Counts, first: float, second: float, of_first: Array, of_second: Array
) -> tuple[float, float]:
    """The numbers of two ranks, counted from 0; between whole ranks those on both sides by their distances."""
    a, b = _around(below, first), _around(below, second)
    m = n = 0
    for begin in range(0, x.shape[0], _SEEN):
        part, hits = x[begin : begin + _SEEN], 0
        # Errors are steady: in most parts of a run there is none to be chosen, which vectors find out.
        for k in range(part.shape[0]):
            hits += ((a[0] <= part[k]) & (part[k] < a[1])) | ((b[0] <= part[k]) & (part[k] < b[1]))
        if hits == 0:
            continue
        # What is not chosen is written too, and written over: no branch to guess.
        for k in range(part.shape[0]):
            of_first[m] = of_second[n] = part[k]
            m += a[0] <= part[k] < a[1]
            n += b[0] <= part[k] < b[1]
    return _of_rank(of_first[:m], first - a[2]), _of_rank(of_second[:n], second - b[2])


@kernel
def _around(below: Counts, rank: float) -> tuple[float, float, float]:
    """Bounds of the buckets that hold the numbers on both sides of a rank, and how many lie below them."""
    low = np.searchsorted(below, math.floor(rank), side="right") - 1
    high = np.searchsorted(below, math.ceil(rank), side="right") - 1
    least = _bound(np.int64(low)) if low > 0 else 0.0
    return least, _bound(np.int64(high + 1)) if high < _BUCKETS - 1 else np.inf, np.float64(below[low])


@kernel
def _bound(bucket: np.int64) -> float:
    """The smallest number of a bucket but the lowest one."""
    return np.int64((bucket + _LOWEST) << _SHIFT).view(np.float64)


@kernel
def _of_rank(found: Array, rank: float) -> float:
    """The number of this rank among `found`, whose order is changed."""
    k = math.floor(rank)
    _select(found, k)
    low = found[k]
    high = found[k + 1 :].min() if rank > k else low
    return 0.5 * (low + high) if rank - k == 0.5 else low + (high - low) * (rank - k)


@kernel
def _select(x: Array, rank: int) -> None:
    """Put the number of this rank in its place, no larger ones before it and no smaller ones behind it.

    Source: Hoare 1961, "Algorithm 65: Find".
    """
    left, right = 0, x.shape[0] - 1
    while left < right:
        pivot, i, j = x[rank], left, right
        while i <= j:
            while x[i] < pivot:
                i += 1
            while x[j] > pivot:
                j -= 1
            if i <= j:
                x[i], x[j] = x[j], x[i]
                i, j = i + 1, j - 1
        left, right = i if rank > j else left, j if rank < i else right
