"""Turns any number of samples into the spline of a given smoothness, block by block, with its uncertainty.

What a sample says is forgotten within some dozens of knots: blocks that overlap by MARGIN knots give the coefficients
of the whole to round-off, and take the memory of one block.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline

from kreisel.maths.derivatives import SplineSignal
from kreisel.maths.smoothing.bands import DEGREE, ORDER, inverse_band, knots_at
from kreisel.maths.smoothing.likelihood import Choice
from kreisel.maths.smoothing.system import Samples, System

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.intp]

BLOCK = 8192
"""Coefficients solved for at a time, and times evaluated."""

# An influence falls by exp(-0.309 / penalty^0.1) from knot to knot (the slowest root of 1 + penalty w^10), at the
# largest penalty by exp(-0.12): after this many knots 1e-16 of it is left.
MARGIN = 320

WIDER = 2.0
"""Standard errors are those of this many times the penalty found, which count two fifths of the error that the prior
foresees for what it smooths away: see docs/decisions/0043-standard-errors-of-smoothed-poses.md"""


def lost_share(order: int) -> float:
    """What the smoothing itself loses, of the variance of a derivative as standard errors have it; the rest is noise.

    With H = 1 / (1 + penalty w^(2 ORDER)) variances are integrals of w^(2 order) H, in proportion to penalty^-p,
    p = (2 order + 1) / (2 ORDER); noise has H^2, a share of 1 - p.
    """
    p = (2 * order + 1) / (2 * ORDER)
    return float(1.0 - (1.0 - p) * WIDER**p)


class Block(NamedTuple):
    """Equations of some coefficients of a piece and a margin around them."""

    system: System
    first: int  # coefficient of the piece that is the system's first
    own: slice  # coefficients of the piece that this block answers for


class Piece:
    """Samples (n >= 2) without a break, smoothed."""

    def __init__(self, samples: Samples, choice: Choice) -> None:
        self.smoothness, self.spacing = choice
        # A mean of nil keeps digits where the body is far from the origin.
        self.centre: Array = samples.x.mean(axis=0)
        self.samples = samples._replace(x=samples.x - self.centre)
        self.knots = knots_at(samples.t, self.spacing)
        self.size = len(self.knots) - DEGREE - 1
        self.coefficients = np.empty((self.size, samples.x.shape[1]))
        self.energy = 0.0
        for block in self._blocks(range(0, self.size, BLOCK)):
            c = block.system.solve(self.smoothness).coefficients
            first, last = block.own.start - block.first, block.own.stop - block.first
            self.coefficients[block.own] = c[first:last]
            self.energy += block.system.penalised_squares(c, self.smoothness, first, last)

    def _blocks(self, starts: Iterator[int] | range) -> Iterator[Block]:
        for start in starts:
            stop = min(start + BLOCK, self.size)
            first, last = max(0, start - MARGIN), min(self.size, stop + MARGIN)
            t, knots = self.samples.t, self.knots[first : last + DEGREE + 1]
            # The last sample lies on the last knot.
            end = len(t) if last == self.size else np.searchsorted(t, self.knots[last])
            part = self.samples.part(slice(np.searchsorted(t, knots[DEGREE]), end))
            yield Block(System(part, knots, self.spacing), first, slice(start, stop))

    def first_coefficients(self, t: Array) -> Rows:
        """(n,) the first coefficient that times t see."""
        k = np.searchsorted(self.knots, t, side="right") - 1 - DEGREE
        return np.clip(k, 0, self.size - DEGREE - 1)

    def __call__(self, t: Array, order: int, out: Array) -> None:
        """Fill `out` (order + 1, n, c) with value and derivatives at increasing times t (n,)."""
        for begin in range(0, len(t), BLOCK):
            part = t[begin : begin + BLOCK]
            first, last = self.first_coefficients(part[[0, -1]])
            near = self.coefficients[first : last + DEGREE + 1]
            spline = BSpline(self.knots[first : last + 2 * (DEGREE + 1)], near, DEGREE)
            out[:, begin : begin + BLOCK] = SplineSignal(spline)(part, order)
        out[0] += self.centre

    def variances(self, t: Array, orders: range, out: Array) -> None:
        """Fill `out` (len(orders), n) with the variance of a column's derivatives, for noise of variance 1."""
        wide = self.smoothness._replace(penalty=WIDER * self.smoothness.penalty)
        owners = self.first_coefficients(t) // BLOCK
        for block in self._blocks(BLOCK * int(k) for k in np.unique(owners)):
            rows = slice(*np.searchsorted(owners, [block.own.start // BLOCK, block.own.start // BLOCK + 1]))
            band = inverse_band(block.system.factor(wide))
            for k, order in enumerate(orders):
                out[k, rows] = block.system.variance(t[rows], order, band)
