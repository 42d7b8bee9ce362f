"""Turns a path into the pieces of time over which a body that follows it without twisting rolls smoothly.

Against the frame with x along the path and y at right angles to a fixed pole e, such a body only rolls, at
the rate -(e.x)(e.kappa) / (1 - (e.x)^2) with kappa = v x a / |v|^2: that frame's own twist, taken back.
Each cell holds the twist as a polynomial through Gauss's nodes, with a pole well away from the path there;
cells end where the path stops, reverses or has a corner, and are halved until the polynomial is exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kreisel.maths.heading import Span
from kreisel.maths.joints import brackets, suspects
from kreisel.maths.tangent import (
    AFTER,
    BEFORE,
    DERIVATIVES,
    Array,
    Mask,
    Path,
    Stillness,
    instant_at,
    leading_series,
)

CELL = 1.0 / 16.0  # s
NODES = 16
FINEST = CELL / 2.0**12  # s
BLOCK = 512  # cells at once, 8192 points of the path
AWAY = 0.95  # largest cosine between path and pole; some axis of N stays under 0.58 while a path hardly turns

_X, _W = np.polynomial.legendre.leggauss(NODES)
# Values at the nodes -> Legendre coefficients of the polynomial through them.
_FIT = (np.arange(NODES) + 0.5)[:, None] * np.polynomial.legendre.legvander(_X, NODES - 1).T * _W


class Cells(NamedTuple):
    """Pieces of time in order and without gaps, with the movement just inside both ends."""

    left: Array  # (m,) s
    right: Array  # (m,) s
    pole: Array  # (m,) index of an axis of N; -1 where the body rests
    rate: Array  # (m, NODES) rad/s, Legendre coefficients of the twist of the pole's frame with x along +v
    first: Array  # (3, m, 3) along the movement after `left`, with two derivatives; NaN at rest
    last: Array  # (3, m, 3) the same before `right`


def cells(path: Path, start: float, end: float, span: Span, still: Stillness) -> Cells:
    """Cells that cover [start, end], on a grid that does not depend on these two, inside the span."""
    edges = _edges(path, start, end, span, still)
    work = [
        (edges[k : k + BLOCK + 1][:-1], edges[k + 1 : k + BLOCK + 1]) for k in range(0, len(edges) - 1, BLOCK)
    ]
    done = []
    while work:
        left, right = work.pop()
        pole, rate, resolved = _fitted(path, left, right, still)
        done.append((left[resolved], right[resolved], pole[resolved], rate[resolved]))
        left, right = left[~resolved], right[~resolved]
        if len(left):
            middle = 0.5 * (left + right)
            work += [(left, middle), (middle, right)]
    left, right, pole, rate = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.argsort(left)
    left, right = left[order], right[order]
    return Cells(left, right, pole[order], rate[order], *_ends(path, left, right, still))


def _edges(path: Path, start: float, end: float, span: Span, still: Stillness) -> Array:
    """A grid of fixed times around [start, end], with the seams of the path in between."""
    ticks = CELL * np.arange(np.floor(start / CELL), np.floor(end / CELL) + 2.0)
    grid = np.unique(np.clip(ticks, *span))
    block = BLOCK * NODES
    doubtful = [_doubtful(path, grid[k : k + block + 1], still) for k in range(0, len(grid) - 1, block)]
    rows = np.flatnonzero(np.concatenate(doubtful))
    seams = brackets(path, grid[rows], grid[rows + 1], still).mean(axis=1)
    seams = seams[(seams > grid[0]) & (seams < grid[-1])]
    # A seam on the grid is found to within instants: no sliver of a cell may stand between the two.
    near = np.searchsorted(seams, grid)
    gap = np.full(len(grid), np.inf)
    for side in (near - 1, near):
        known = (side >= 0) & (side < len(seams))
        gap[known] = np.minimum(gap[known], np.abs(seams[side[known]] - grid[known]))
    kept = gap > 16.0 * instant_at(grid, still)
    kept[[0, -1]] = True
    return np.sort(np.concatenate([grid[kept], seams]))


def _doubtful(path: Path, t: Array, still: Stillness) -> Mask:
    _, v, a, j = path(t, 3)
    return suspects(t, v, a, j, still)


def _fitted(path: Path, left: Array, right: Array, still: Stillness) -> tuple[Array, Array, Mask]:
    """Pole, coefficients of the twist, and whether they say it all, for each cell."""
    half = 0.5 * (right - left)
    t = 0.5 * (left + right)[:, None] + half[:, None] * _X
    _, v, a = path(t.ravel(), 2).reshape(3, len(left), NODES, 3)
    speed, push = np.linalg.norm(v, axis=2), np.linalg.norm(a, axis=2)
    at_rest = np.all(speed <= still.speed + still.instant * push, axis=1)
    safe = np.where(speed > 0.0, speed, np.inf)
    x, kappa = v / safe[..., None], np.cross(v, a) / safe[..., None] ** 2
    pole = np.argmin(np.abs(x).max(axis=1), axis=1)
    along = np.take_along_axis(x, pole[:, None, None], axis=2)[..., 0]
    turn = np.take_along_axis(kappa, pole[:, None, None], axis=2)[..., 0]
    twist = np.where(at_rest[:, None], 0.0, along * turn / np.maximum(1.0 - along**2, 1.0 - AWAY**2))
    rate = twist @ _FIT.T
    # Near a reversal kappa is a quotient of small numbers; what round-off makes of it is no reason to halve.
    noise = 1e-15 * (speed.max(axis=1)[:, None] * push + push.max(axis=1)[:, None] * speed) / safe**2
    allowed = 1e-15 + half * (noise @ _W + 1e-14 * np.abs(rate).max(axis=1))
    smooth = (half * np.abs(rate[:, -3:]).max(axis=1) <= allowed) & (np.abs(along).max(axis=1) <= AWAY)
    return np.where(at_rest, -1, pole), rate, at_rest | smooth | (half <= FINEST)


def _ends(path: Path, left: Array, right: Array, still: Stillness) -> tuple[Array, Array]:
    """The movement a few instants inside either end, so that it is this cell's whatever the next one does."""
    out = []
    for t, side in ((left, AFTER), (right, BEFORE)):
        inside = t + side * np.minimum(8.0 * instant_at(t, still), 0.25 * (right - left))
        blocks = [inside[k : k + BLOCK * NODES] for k in range(0, len(t), BLOCK * NODES)]
        coarse = still.coarser(16.0)
        out.append(
            np.concatenate(
                [leading_series(b, path(b, DERIVATIVES)[1:], side, coarse) for b in blocks], axis=1
            )
        )
    return out[0], out[1]
