"""Turns samples into a function of time that can be differentiated, and says how noisy the samples are."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

Array = npt.NDArray[np.float64]

# Degree of the interpolating spline. Truncation falls with the degree, while round-off in a second
# derivative grows with the square of the rate and, at the ends, with the degree: the two meet here.
DEGREE, DEGREE_FAST, FAST_HZ = 9, 7, 500.0

# Noise of the second derivative of an interpolating spline, per noise of the samples and per squared step:
# pi^2 / sqrt(5) = 4.4 for the ideal interpolator, 10.5 measured for white noise at degree 9.
SECOND_DERIVATIVE_GAIN = 10.5

# A direction is unknown where the derivative is less than this many times its error: 3 degrees.
UNKNOWN = 20.0

# After a step of velocity a spline rings by less than this share of it, for this many samples (0.61^20 = 5e-5
# at degree 9); samples whose noise is too small to be smoothed stay under this share of the largest speed.
_RINGS, _MEMORY, _AT_MOST = 0.3, 20, 1e-3

# The two degrees differ by 0.01 of a step of velocity, and by 1e-5 of a smooth one at 20 samples a period.
_CORNER = 2e-3


class Signal(Protocol):
    """A function of time that knows its derivatives."""

    @property
    def floor(self) -> Array:
        """(n,) size of the first derivative at the samples, per second, under which its direction is noise."""
        ...

    def __call__(self, t: Array, order: int) -> Array:
        """(order + 1, n, c): value and derivatives at increasing times t (n,)."""
        ...


def interpolating_spline(t: Array, x: Array) -> Signal:
    """Spline through samples `x` (n, c) at `t` (n,) s; of lower degree where there are few samples."""
    degree = DEGREE_FAST if 1.0 / np.median(np.diff(t)) > FAST_HZ else DEGREE
    most = len(t) - 1 - len(t) % 2
    return Interpolation(t, x, max(1, min(degree, most)))


class SplineSignal:
    """A SciPy BSpline with all its derivatives evaluated in one pass.

    They share the search for the interval and the triangle of basis functions: 2.3 times faster than one
    evaluation each, and these are half the cost of a motion.
    """

    def __init__(self, spline: BSpline) -> None:
        self._spline = spline

    def __call__(self, t: Array, order: int) -> Array:
        spline = self._spline
        count = len(spline.t) - spline.k - 1
        coefficients = np.zeros((order + 1, count, spline.c.shape[1]))
        for k in range(min(order, spline.k) + 1):
            coefficients[k, k:] = spline.derivative(k).c[: count - k] if k else spline.c[:count]
        out = np.empty((order + 1, len(t), spline.c.shape[1]))
        _evaluate(argument(spline.t), spline.k, coefficients, argument(t), out)
        return out


class Interpolation(SplineSignal):
    """The spline of a degree through samples `x` (n, c) at `t` (n,) s, which knows where it is not to be trusted."""

    def __init__(self, t: Array, x: Array, degree: int) -> None:
        from scipy.interpolate import make_interp_spline

        super().__init__(make_interp_spline(t, x, k=degree, check_finite=False))
        self._t, self._x, self._degree = t, x, degree

    @cached_property
    def ringing(self) -> Array:
        """(n,) how far off the first derivative may be around each sample, per second: by as much as that of
        another degree differs."""
        from scipy.ndimage import maximum_filter1d

        other = Interpolation(self._t, self._x, max(self._degree - 2, 1))
        middle = 0.5 * (self._t[:-1] + self._t[1:])
        at, between = (np.linalg.norm(self(t, 1)[1] - other(t, 1)[1], axis=1) for t in (self._t, middle))
        at[:-1] = np.maximum(at[:-1], between)
        # Both ring with alternating sign, and cross each other now and then.
        return np.asarray(maximum_filter1d(at, 7))

    @property
    def corners(self) -> Array:
        """Times (m,) s around which this rings for a step in the first derivative of the samples."""
        size = np.linalg.norm(self(self._t, 1)[1], axis=1)
        loud = np.concatenate([[False], self.ringing > _CORNER * size.max(), [False]])
        edges = np.flatnonzero(np.diff(loud.astype(np.int8)))
        return np.asarray(0.5 * (self._t[edges[::2]] + self._t[edges[1::2] - 1]))

    @cached_property
    def floor(self) -> Array:
        """As `Signal` has it."""
        from scipy.ndimage import maximum_filter1d

        size = np.linalg.norm(self(self._t, 1)[1], axis=1)
        # Coarse samples of a path without any rest must not count as ringing from end to end.
        most = np.maximum(_RINGS * maximum_filter1d(size, 2 * _MEMORY + 1), _AT_MOST * size.max())
        round_off = 1e-13 * np.abs(self._x).max() / np.diff(self._t).min()
        return np.asarray(np.minimum(UNKNOWN * self.ringing, most) + round_off)


@kernel
def _evaluate(knots: Array, degree: int, coefficients: Array, t: Array, out: Array) -> None:
    """Derivative k of the spline is one of degree - k with coefficients[k], aligned to the same intervals.

    Basis functions by the triangle of Cox and de Boor (de Boor 1978, chapter X).
    """
    orders, count, columns = coefficients.shape
    triangle = np.zeros((degree + 1, degree + 1))  # row d: basis functions of degree d
    left, right = np.empty(degree + 1), np.empty(degree + 1)
    triangle[0, 0] = 1.0
    i = degree
    for row in range(t.shape[0]):
        while i < count - 1 and t[row] >= knots[i + 1]:
            i += 1
        for d in range(1, degree + 1):
            left[d], right[d] = t[row] - knots[i + 1 - d], knots[i + d] - t[row]
            carried = 0.0
            for r in range(d):
                share = triangle[d - 1, r] / (right[r + 1] + left[d - r])
                triangle[d, r] = carried + right[r + 1] * share
                carried = left[d - r] * share
            triangle[d, d] = carried
        for k in range(orders):
            d = degree - k
            for c in range(columns):
                total = 0.0
                for r in range(d + 1):
                    total += triangle[d, r] * coefficients[k, i - d + r, c]
                out[k, row, c] = total


def noise_level(t: Array, x: Array, places: int = 2000) -> Array:
    """Standard deviation (c,) of white noise in samples `x` (n, c) at `t` (n,) s; 0 where none can be seen.

    Differences of rising order, scaled to leave white noise as it is, make everything smooth vanish: what
    stops shrinking is noise. Divided differences serve, so that uneven steps do no harm, and a median over
    the recording, at up to `places` places, so that a few jumps of the signal do not look like noise.
    """
    orders = [k for k in (8, 12, 16, 20, 24) if k <= (len(t) - 1) // 3]
    if len(orders) < 2:
        return np.zeros(x.shape[1])
    levels = np.array([_difference_level(t, x, k, places) for k in orders[-2:]])
    # Four orders more shrink a tone of frequency f by sin(pi f / rate)^4: 0.5 stands for a third of the rate.
    settled = levels[-1] > 0.5 * levels[-2]
    return np.where(settled, levels[-1], 0.0)


def _difference_level(t: Array, x: Array, order: int, places: int) -> Array:
    """Robust scale (c,) of normalised divided differences of `order` at up to `places` places."""
    starts = np.unique(np.linspace(0, len(t) - order - 1, places).astype(int))
    rows = starts[:, None] + np.arange(order + 1)
    local = t[rows]
    # Scaled to a length of 4, the capacity of the interval, so that the products neither vanish nor overflow.
    local = 4.0 * (local - local[:, :1]) / (local[:, -1:] - local[:, :1])
    gaps = local[:, :, None] - local[:, None, :] + np.eye(order + 1)
    weights = 1.0 / gaps.prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    differences = np.einsum("mk,mkc->mc", weights, x[rows])
    # The median of the absolute value of a normal variable is 0.6745 standard deviations.
    return np.asarray(np.median(np.abs(differences), axis=0) / 0.6745)
