"""Turns points, or values with slopes, into piecewise polynomials that know all their derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Polynomials:
    """One polynomial in x - breaks[k] from each break to the next; at a break the later one counts."""

    breaks: Array  # (m + 1,) increasing
    coefficients: Array  # (m, degree + 1, c), constant term first

    def __call__(self, x: Array, order: int) -> Array:
        """(order + 1, n, c): values and derivatives at x (n,); the first and last polynomial go on outside."""
        pieces, _, columns = self.coefficients.shape
        piece = np.clip(np.searchsorted(self.breaks, x, side="right") - 1, 0, pieces - 1)
        out = np.empty((order + 1, len(x), columns))
        _evaluate(argument(x - self.breaks[piece]), piece, argument(self.coefficients), out)
        return out


@kernel
def _evaluate(x: Array, piece: npt.NDArray[np.int64], coefficients: Array, out: Array) -> None:
    """Horner's scheme, repeated: remainders of division by x - x0 are the derivatives over their factorials."""
    terms = coefficients.shape[1]
    orders = out.shape[0]
    for k in range(x.shape[0]):
        for c in range(out.shape[2]):
            out[:, k, c] = 0.0
            for i in range(terms - 1, -1, -1):
                for d in range(orders - 1, 0, -1):
                    out[d, k, c] = out[d, k, c] * x[k] + out[d - 1, k, c]
                out[0, k, c] = out[0, k, c] * x[k] + coefficients[piece[k], i, c]
            factorial = 1.0
            for d in range(2, orders):
                factorial *= d
                out[d, k, c] *= factorial


def smoothest_through(
    x: Array, points: Array, m: int, closed: bool = False, known: Array | None = None
) -> Polynomials:
    """The curve through `points` (n, c) at x (n,) with the least integral of its squared derivative number m.

    m: 3 for least jerk, 4 for least snap. Through fewer points than m it is the polynomial that they determine.
    closed: whether it goes on at its end as it began, with all derivatives up to 2 m - 2 that are free.
    known: (n, m - 1, c) first and further derivatives at the points, NaN where free; with none it is the natural
        spline of degree 2 m - 1.

    The derivatives at the points are the unknowns of a sparse positive definite system; a polynomial follows from
    those at its ends. Source: Richter, Bry and Roy 2016, Polynomial trajectory planning for aggressive quadrotor
    flight, the formulation by free derivatives.
    """
    n, c = points.shape
    if known is None:
        m = m if closed else min(m, n)
        known = np.full((n, m - 1, c), np.nan)
    # In steps of about one: the matrix holds powers of them up to 1 - 2 m.
    unit = float((x[-1] - x[0]) / (n - 1))
    scale = unit ** np.arange(m)[:, None]
    ends = np.concatenate([points[:, None], known], axis=1) * scale
    for column in range(c):
        _fill(np.diff(x) / unit, ends[..., column], m, closed)
    ends /= scale
    return hermite(x, np.stack([ends[:-1], ends[1:]], axis=1))


def _fill(steps: Array, ends: Array, m: int, closed: bool) -> None:
    """Put what minimises the cost in place of the NaN in `ends` (n, m): values and derivatives at the points."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import spsolve

    n = len(ends)
    # Number of each unknown in the system; a closed curve has those of its first point again at its last.
    number = np.arange(n * m).reshape(n, m)
    if closed:
        number[-1, 1:] = number[0, 1:]
    values = np.zeros(n * m)
    values[number] = ends
    free = np.isnan(values)
    rows = np.concatenate([number[:-1], number[1:]], axis=1)
    powers = np.tile(steps[:, None] ** np.arange(m), 2)
    costs = powers[:, :, None] * _cost(m) * powers[:, None, :] * (steps ** (1 - 2 * m))[:, None, None]
    across = np.broadcast_to(rows[:, :, None], costs.shape), np.broadcast_to(rows[:, None, :], costs.shape)
    system = csc_array((costs.ravel(), (across[0].ravel(), across[1].ravel())), shape=(n * m, n * m))
    unknown, given = np.flatnonzero(free), np.flatnonzero(~free)
    if unknown.size:
        to = system[unknown]
        values[unknown] = spsolve(to[:, unknown].tocsc(), -(to[:, given] @ values[given]))
    ends[:] = values[number]


@cache
def _basis(m: int) -> Array:
    """(2 m, 2 m): coefficients in t from 0 to 1 of the polynomial with given derivatives 0 to m - 1 at both ends."""
    at_ends = np.zeros((2 * m, 2 * m))
    for d in range(m):
        at_ends[d, d] = math.factorial(d)
        for power in range(d, 2 * m):
            at_ends[m + d, power] = math.perm(power, d)
    # Its elements are whole multiples of this: rounded, they are exact.
    whole = float(math.factorial(m - 1))
    return np.asarray(np.rint(np.linalg.inv(at_ends) * whole) / whole)


@cache
def _cost(m: int) -> Array:
    """(2 m, 2 m): integral of the squared derivative number m of those polynomials."""
    cost = np.zeros((2 * m, 2 * m))
    for i in range(m, 2 * m):
        for j in range(m, 2 * m):
            cost[i, j] = math.perm(i, m) * math.perm(j, m) / (i + j - 2 * m + 1)
    return np.asarray(_basis(m).T @ cost @ _basis(m))


def joined(parts: list[Polynomials]) -> Polynomials:
    """Parts of which each begins where the one before ends, as one."""
    terms = max(part.coefficients.shape[1] for part in parts)
    padded = [
        np.pad(part.coefficients, ((0, 0), (0, terms - part.coefficients.shape[1]), (0, 0))) for part in parts
    ]
    breaks = [parts[0].breaks, *(part.breaks[1:] for part in parts[1:])]
    return Polynomials(np.concatenate(breaks), np.concatenate(padded))


def hermite(breaks: Array, ends: Array) -> Polynomials:
    """Polynomials of degree 2 m - 1 with values and derivatives `ends` (k, 2, m, c) at begin and end of every piece."""
    steps = np.diff(breaks)
    k, _, m, c = ends.shape
    # Without the value at its begin, so that a long way leaves a short piece its digits.
    rises = ends.copy()
    rises[:, 1, 0] -= rises[:, 0, 0]
    rises[:, 0, 0] = 0.0
    powers = steps[:, None] ** np.arange(2 * m)
    scaled = (rises * powers[:, None, :m, None]).reshape(k, 2 * m, c)
    coefficients = np.einsum("ij,kjc->kic", _basis(m), scaled) / powers[:, :, None]
    coefficients[:, 0] = ends[:, 0, 0]
    return Polynomials(np.array(breaks), coefficients)


def even_slopes(x: Array, y: Array, closed: bool = False) -> Array:
    """Slopes (n,) with which a curve through (x, y) need not swing past its points; none at the ends of an open one.

    Weighted harmonic means of the slopes on either side, at most 1.5 times the smaller one: with no curvature at
    the points a Hermite polynomial of degree 5 or 7 then rises or falls all the way; of degree 7 no longer at 1.85.
    Source: Fritsch and Butland 1984, A method for constructing local monotone piecewise cubic interpolants.
    """
    steps, rise = np.diff(x), np.diff(y) / np.diff(x)
    if closed:
        rise, steps = np.append(rise, rise[0]), np.append(steps, steps[0])
    before, after = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
    same = rise[:-1] * rise[1:] > 0.0
    one, other = np.where(same, rise[:-1], 1.0), np.where(same, rise[1:], 1.0)
    mean = (before + after) / (before / one + after / other)
    most = 1.5 * np.minimum(np.abs(one), np.abs(other))
    inner = np.where(same, np.clip(mean, -most, most), 0.0)
    return np.append(inner[-1:], inner) if closed else np.concatenate([[0.0], inner, [0.0]])
