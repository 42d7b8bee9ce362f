"""Turns evenly spaced samples into how likely white noise, flicker and random walk of any strength made them.

A model is theta = (N^2 / dt, B^2, K^2 dt), as in `kreisel.maths.allan`. The cosine transform of a record tells its
terms apart: coefficient j, of frequency f = j / 2n per sample, has variance
theta_0 + theta_1 g_j + theta_2 / (4 sin^2 (pi f)), and for white noise and random walk no two are correlated, since
cosines are level at both ends of the record and a walk need not come back. For flicker, g_j = 1 / (2 pi f) away from
the ends of the band, they nearly are not.
Source: Whittle's likelihood, with cosines instead of a Fourier transform; the variances are ours.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

TWO_SIDED = 3.841
"""Twice the logarithm of a likelihood ratio that chance exceeds 5 % of the time: chi squared, one degree of freedom."""

# Coefficients taken one by one, whose flicker knows of the ends of the record; beyond, bins of about 5 %.
_SINGLE = 24
_BINS_PER_DECADE = 48

_AT_ONCE = 1 << 20

_PASSES = 60
_ENOUGH = 1e-6  # of twice a log likelihood, of which a confidence interval is 4 wide
_SMALLEST_STEP = 1e-4
_NODES = 400
_ALIASES = 4


class Powers(NamedTuple):
    """Squares of the cosine coefficients of one record, by bins."""

    counts: Array  # (bins,) coefficients in each
    shapes: Array  # (bins, 3): the mean square expected is `shapes @ theta`
    found: Array  # (bins,) mean square


class Fit(NamedTuple):
    """A model and minus twice the logarithm of its likelihood, less a constant."""

    theta: Array  # (3,)
    loss: float


def powers(samples: Array) -> Powers:
    """Powers of `samples` (n,), n of 32 or more; a constant in them changes nothing."""
    from scipy.fft import dct

    first, counts, shapes = _bins(len(samples))
    # In place: of a long record there is no room for many copies.
    squares = dct(samples - np.mean(samples), type=2, norm="ortho", overwrite_x=True)[1:]
    np.square(squares, out=squares)
    return Powers(counts, shapes, np.add.reduceat(squares, first) / counts)


def likeliest(of: Powers) -> Fit:
    """The model that makes `of` likeliest, none of its three terms below zero."""
    lowest = of.found[0] / of.shapes[0]
    return _climb(of, np.array([of.found[-1], lowest[1], lowest[2]]), None)


def without(of: Powers, best: Fit, term: int) -> float:
    """By how much the best model that lacks `term` is less likely than `best`; z^2 of a one-sided test."""
    return _held(of, best, term, 0.0) - best.loss


def lower_end(of: Powers, best: Fit, term: int) -> float:
    """Of a `term` without which the loss rises by more than TWO_SIDED: the lower end of its 95 % interval."""
    return _crossing(of, best, term, 0.0, float(best.theta[term]))


def upper_end(of: Powers, best: Fit, term: int) -> float:
    """The upper end of the 95 % interval of `term`, whether it is there or not."""
    inside, step = float(best.theta[term]), 2.0 * _error(of, best, term)
    while _excess(inside + step, of, best, term) < 0.0:
        inside, step = inside + step, 2.0 * step
    return _crossing(of, best, term, inside, inside + step)


def _crossing(of: Powers, best: Fit, term: int, a: float, b: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(_excess, a, b, args=(of, best, term), xtol=1e-12 * b, rtol=1e-4))


def _excess(value: float, of: Powers, best: Fit, term: int) -> float:
    return _held(of, best, term, value) - best.loss - TWO_SIDED


def _error(of: Powers, best: Fit, term: int) -> float:
    """Standard error of `term` if the others were known."""
    relative = of.shapes[:, term] / (of.shapes @ best.theta)
    return float(np.sqrt(2.0 / np.sum(of.counts * relative**2)))


def _held(of: Powers, best: Fit, term: int, value: float) -> float:
    """Loss of the best model whose `term` is `value`."""
    start = best.theta.copy()
    start[term] = value
    # Without its white noise a model of walk alone would have no power left at the highest frequencies.
    start[0] = value if term == 0 else max(start[0], 1e-3 * of.found[-1])
    if term == 0:
        start[1] = max(start[1], of.found[-1] / of.shapes[-1, 1])
    return _climb(of, start, term).loss


def _climb(of: Powers, theta: Array, held: int | None) -> Fit:
    """Fisher scoring from `theta`, one term `held` where it is; every step is halved until it climbs."""
    from scipy.optimize import nnls

    free = [k for k in range(3) if k != held]
    A = of.shapes[:, free]
    fixed = np.zeros(len(of.counts)) if held is None else of.shapes[:, held] * theta[held]
    expected = of.shapes @ theta
    loss = _loss(of, expected)
    for _ in range(_PASSES):
        root = np.sqrt(of.counts) / expected
        scale = np.linalg.norm(A * root[:, None], axis=0)
        step = np.zeros(3)
        step[free] = nnls(A * root[:, None] / scale, (of.found - fixed) * root)[0] / scale - theta[free]
        part = 1.0
        while part > _SMALLEST_STEP and not _loss(of, expected + part * (of.shapes @ step)) <= loss:
            part *= 0.5
        if part <= _SMALLEST_STEP:
            break
        theta = theta + part * step
        expected = of.shapes @ theta
        before, loss = loss, _loss(of, expected)
        if before - loss < _ENOUGH:
            break
    return Fit(theta, loss)


def _loss(of: Powers, expected: Array) -> float:
    if not (expected > 0.0).all():
        return np.inf
    return float(np.sum(of.counts * (np.log(expected) + of.found / expected)))


@lru_cache(maxsize=8)
def _bins(samples: int) -> tuple[npt.NDArray[np.intp], Array, Array]:
    """First coefficient, number of coefficients and shapes of each bin, for a record of so many samples."""
    count = samples - 1
    single = min(_SINGLE, count)
    many = max(int(_BINS_PER_DECADE * np.log10(samples / single)), 2)
    first = np.unique(np.r_[np.arange(single), np.geomspace(single + 1, samples, many).astype(np.intp) - 1])
    first = first[first < count]
    counts = np.diff(np.append(first, count)).astype(np.float64)
    edges = np.append(first, count)
    # Some bins at a time, for the memory of a long record.
    cuts = np.searchsorted(edges, np.arange(0, count, _AT_ONCE))
    pieces = [edges[a : b + 1] for a, b in pairwise(np.unique([*cuts, len(first)]))]
    sums = np.vstack([_sums(piece, samples, single) for piece in pieces])
    return first, counts, sums / counts[:, None]


def _sums(edges: npt.NDArray[np.intp], samples: int, single: int) -> Array:
    """The three variances for theta of ones, summed over each of the bins between `edges`."""
    j = np.arange(edges[0] + 1.0, edges[-1] + 1.0)
    f = j / (2.0 * samples)
    sine = np.sin(np.pi * f) ** 2
    ends = 1.0 - 2.0 / (np.pi**2 * j)
    if edges[0] < single:
        ends[: single - edges[0]] = _ends(single)[edges[0] : edges[-1]]
    columns = (np.ones(len(j)), ends * _flicker(f, sine), 0.25 / sine)
    return np.column_stack([np.add.reduceat(column, edges[:-1] - edges[0]) for column in columns])


def _flicker(f: Array, sine: Array) -> Array:
    """Density of samples that each average flicker of density 1 / (2 pi f) over one step, all aliases in."""
    near = sum((f + k) ** -3.0 + (k + 1.0 - f) ** -3.0 for k in range(_ALIASES))
    # The rest of the sum as an integral, right to 1e-4 of the whole.
    far = 0.5 * (f + _ALIASES - 0.5) ** -2.0 + 0.5 * (_ALIASES + 0.5 - f) ** -2.0
    return np.asarray(sine / (2.0 * np.pi**3) * (near + far))


def _ends(single: int) -> Array:
    """What flicker's variance in the lowest coefficients is, over that of a record without ends: 0.77, 0.90, ...

    Soon it is 1 - 2 / (pi^2 j).

    The covariance of flicker at lag h is -ln|h| / pi, but for what a cosine does not see: the ratio is -4 j times
    the integral of ln h over the overlap of a cosine with itself h later, h from 0 to 1. Nodes crowd at zero,
    where ln h is steep.
    """
    x, weight = np.polynomial.legendre.leggauss(_NODES)
    u = 0.5 * (1.0 + x)
    h, weight = u**4, 2.0 * u**3 * weight
    j = np.arange(1.0, single + 1.0)[:, None]
    overlap = 0.5 * (1.0 - h) * np.cos(np.pi * j * h) - np.sin(np.pi * j * h) / (2.0 * np.pi * j)
    return np.asarray(-4.0 * j[:, 0] * ((weight * np.log(h)) * overlap).sum(axis=1))
