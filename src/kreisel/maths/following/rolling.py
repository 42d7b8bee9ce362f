"""Turns a path into the pieces of time over which a body that follows it without twisting rolls smoothly.

Against the frame with x along the path and y at right angles to a fixed pole e, such a body only rolls, at
the rate -(e.x)(e.kappa) / (1 - (e.x)^2) with kappa = v x a / |v|^2: that frame's own twist, taken back.
Each cell holds the twist as a polynomial through Gauss's nodes, with a pole well away from the path there;
cells end where the path stops, reverses or has a corner, and are halved until the polynomial is exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.heading import Span
from kreisel.maths.following.joints import brackets, suspects
from kreisel.maths.following.tangent import (
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
FINEST = CELL / 2.0**11  # s
BLOCK = 512  # cells at once, 8192 points of the path
# rad; Gauss's rule over whole cells errs by the square of the remainder, so this does not add up over cells.
ENOUGH = 1e-13
AWAY = 0.95  # largest cosine between path and pole; some axis of N stays under 0.58 while a path hardly turns

_X, _W = np.polynomial.legendre.leggauss(NODES)
# Values at the nodes -> Legendre coefficients of the polynomial through them.
_FIT = (np.arange(NODES) + 0.5)[:, None] * np.polynomial.legendre.legvander(_X, NODES - 1).T * _W


class Cells(NamedTuple):
    """Pieces of time in order and without gaps, with the movement just inside both ends."""

    left: Array  # (m,) s
    right: Array  # (m,) s
    pole: npt.NDArray[np.integer]  # (m,) index of an axis of N; -1 where the body rests
    rate: Array  # (m, NODES) rad/s, Legendre coefficients of the twist of the pole's frame with x along +v
    inset: Array  # (m,) s, how far inside its ends a cell is looked at
    first: Array  # (3, m, 3) along the movement at left + inset, with two derivatives; NaN at rest
    last: Array  # (3, m, 3) the same at right - inset


def cells(path: Path, start: float, end: float, span: Span, still: Stillness) -> Cells:
    """Cells that cover [start, end], on a grid that does not depend on these two, inside the span."""
    edges = _edges(path, start, end, span, still)
    done = []
    for k in range(0, len(edges) - 1, BLOCK):
        left, right = edges[k : k + BLOCK + 1][:-1], edges[k + 1 : k + BLOCK + 1]
        earlier = np.full(len(left), np.inf)
        while len(left):
            pole, rate, rest = _fitted(path, left, right, still)
            # Halving takes a smooth remainder down by thousands; what it merely halves is round-off.
            resolved = (
                (rest <= ENOUGH) | (rest > 0.3 * earlier) & np.isfinite(rest) | (right - left <= FINEST)
            )
            done.append((left[resolved], right[resolved], pole[resolved], rate[resolved]))
            left, right, earlier = left[~resolved], right[~resolved], np.repeat(rest[~resolved], 2)
            middle = 0.5 * (left + right)
            left, right = np.stack([left, middle], axis=1).ravel(), np.stack([middle, right], axis=1).ravel()
    left, right, pole, rate = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.argsort(left)
    left, right = left[order], right[order]
    # A few instants inside, so that what is found is this cell's own whatever the next one does.
    inset = np.minimum(8.0 * instant_at(right, still), 0.25 * (right - left))
    first, last = _at(path, left + inset, AFTER, still), _at(path, right - inset, BEFORE, still)
    return Cells(left, right, pole[order], rate[order], inset, first, last)


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


def _fitted(
    path: Path, left: Array, right: Array, still: Stillness
) -> tuple[npt.NDArray[np.integer], Array, Array]:
    """Pole, coefficients of the twist, and the angle (rad) they may miss, for each cell; inf too near a pole."""
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
    # Near a reversal kappa is a quotient of small numbers, and late times are known to fewer places; what round-off
    # makes of either is no reason to halve.
    noise = 1e-15 * (speed.max(axis=1)[:, None] * push + push.max(axis=1)[:, None] * speed) / safe**2
    tail = (
        np.abs(rate[:, -3:]).max(axis=1)
        - noise @ _W
        - (1e-14 + 4e-15 * np.abs(right) / half) * np.abs(rate).max(axis=1)
    )
    near = ~at_rest & (np.abs(along).max(axis=1) > AWAY)
    return np.where(at_rest, -1, pole), rate, np.where(near, np.inf, half * tail)


def _at(path: Path, t: Array, side: int, still: Stillness) -> Array:
    """The movement (3, n, 3) at times t, with two derivatives."""
    coarse, step = still.coarser(16.0), BLOCK * NODES
    blocks = [t[k : k + step] for k in range(0, len(t), step)]
    series = [leading_series(b, path(b, DERIVATIVES)[1:], side, coarse) for b in blocks]
    return np.concatenate(series, axis=1)
