"""Turns samples into their means over a window of time that ends anywhere between them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]


def mean_over_window(t: Array, x: Array, ends: Array, window: float) -> Array:
    """Means (m, 3) of x over [end - window, end] for increasing `ends` (m,) s; with window 0, values at the ends.

    t: (n,) s, n >= 4; x: (n, 3). Between two samples x is the cubic through the four nearest, which
    Simpson's rule integrates exactly; before the first sample it is the first. No end may lie after t[-1].
    """
    out = np.zeros((len(ends), 3))
    _mean_over_window(argument(t), argument(x), argument(ends), window, out)
    return out


@kernel
def _mean_over_window(t: Array, x: Array, ends: Array, window: float, out: Array) -> None:
    piece = 0
    for j in range(ends.shape[0]):
        end, low = ends[j], ends[j] - window
        while piece < t.shape[0] - 2 and t[piece + 1] <= low:
            piece += 1
        if window == 0.0:
            _add_cubic(t, x, piece, low, 1.0, out[j])
            continue
        if low < t[0]:
            high = min(end, t[0])
            _add_cubic(t, x, 0, low, (high - low) / window, out[j])
            low = high
        p = piece
        while low < end:
            high = end if p == t.shape[0] - 2 else min(end, t[p + 1])
            weight = (high - low) / (6.0 * window)
            _add_cubic(t, x, p, low, weight, out[j])
            _add_cubic(t, x, p, 0.5 * (low + high), 4.0 * weight, out[j])
            _add_cubic(t, x, p, high, weight, out[j])
            low = high
            p += 1


@kernel
def _add_cubic(t: Array, x: Array, piece: int, at: float, weight: float, out: Array) -> None:
    """Add weight times the value at time `at` of the cubic through the four samples around a piece."""
    if at < t[0]:
        for a in range(3):
            out[a] += weight * x[0, a]
        return
    first = max(0, min(piece - 1, t.shape[0] - 4))
    for i in range(first, first + 4):
        share = weight
        for k in range(first, first + 4):
            if k != i:
                share *= (at - t[k]) / (t[i] - t[k])
        for a in range(3):
            out[a] += share * x[i, a]
