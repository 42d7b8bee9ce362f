"""Turns a series of any length into a short one that draws the same picture.

A screen has some thousand pixel columns; a recording has millions of samples. All samples of one column draw
a vertical stroke from its smallest to its largest value, entered at the first and left at the last, so those
four are kept and every peak survives (Jugel et al. 2014, "M4: a visualization-oriented time series data
aggregation").
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array

Indices = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

COLUMNS = 2500
"""Time columns kept apart: more than a figure has pixels across."""


def drawable(t: Array, y: Array, jump: float = np.inf, columns: int = COLUMNS) -> tuple[Array, Array]:
    """Times and values to draw for samples `y` (n,) at `t` (n,): a NaN wherever the line must break.

    The line breaks where samples are missing (NaN or infinite) and where neighbours differ by more than
    `jump`. A sensor that delivers only every tenth row has no gaps: missing means later than its own usual
    step. Gaps narrower than a column would not be seen and are bridged.
    """
    good = np.flatnonzero(np.isfinite(y))
    t_good, y_good = t[good], y[good]
    if len(good) < 2:
        return t_good, y_good
    width = (t_good[-1] - t_good[0]) / columns
    step = np.diff(t_good)
    late = step > max(1.5 * float(np.median(step)), width if len(good) > 4 * columns else 0.0)
    gap = late & (np.diff(good) > 1)
    jumps = np.abs(np.diff(y_good)) > jump
    if len(good) <= 4 * columns:
        return _separated(t_good, y_good, gap | jumps)
    column = np.minimum(((t_good - t_good[0]) / width).astype(np.intp), columns - 1)
    order, cut = _thinned(column, y_good, gap | jumps)
    return _separated(t_good[order], y_good[order], cut)


def alone(y: Array) -> Indices:
    """Rows of `y` (n,) that no line reaches because both neighbours are NaN or beyond the ends."""
    good = np.isfinite(y)
    linked = np.zeros(len(y), dtype=bool)
    pair = good[1:] & good[:-1]
    linked[1:] |= pair
    linked[:-1] |= pair
    return np.flatnonzero(good & ~linked)


def along_path(p: Array, finest: float, most: int = 100_000) -> Indices:
    """Rows of a path `p` (n, 3) that stand for all: the first of each piece of length `finest`, and the ends.

    No point of the path lies further than `finest` from the line through them; where that takes more than
    `most` rows, the pieces grow.
    """
    if len(p) < 3:
        return np.arange(len(p))
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    finest = max(finest, length[-1] / most)
    piece = np.floor(length / finest) if finest > 0.0 else np.zeros(len(p))
    starts = np.flatnonzero(np.diff(piece, prepend=-1.0) > 0)
    return np.unique(np.append(starts, len(p) - 1))


def _thinned(column: Indices, y: Array, broken: Mask) -> tuple[Indices, Mask]:
    """Rows to draw in drawing order, and whether the line breaks after each (one fewer).

    `broken` (n - 1,) says where the line through all samples breaks. A column with several breaks (angles
    that wrap there again and again) becomes one stroke for its negative and one for its other values.
    """
    busy = np.bincount(column[1:][broken], minlength=int(column[-1]) + 1) > 1
    smooth = np.flatnonzero(~busy[column])
    kept = [smooth[_corners(column[smooth], y[smooth])]]
    sides = [breaks := np.flatnonzero(broken), breaks + 1]
    kept += [rows[~busy[column[rows]]] for rows in sides]
    rows = np.flatnonzero(busy[column])
    side = 2 * column + (y >= 0.0)
    rows = rows[np.argsort(side[rows], kind="stable")]
    kept.append(rows[_corners(side[rows], y[rows], ends=False)])
    order = np.unique(np.concatenate(kept))
    in_busy = busy[column[order]]
    rank = np.where(in_busy, y[order], order)
    order = order[np.lexsort((rank, np.where(in_busy, side[order], 0), column[order]))]
    return order, _cuts(order, side, busy[column[order]], broken)


def _cuts(order: Indices, side: Indices, in_busy: Mask, broken: Mask) -> Mask:
    """Where the line through rows `order` breaks: at a break between two of them, and around every stroke."""
    breaks_before = np.concatenate([[0], np.cumsum(broken)])
    apart = np.diff(breaks_before[order]) != 0
    stroke = in_busy[1:] | in_busy[:-1]
    return np.asarray(np.where(stroke, np.diff(side[order]) != 0, apart))


def _corners(group: Indices, y: Array, ends: bool = True) -> Indices:
    """Rows with the smallest and largest `y` of each run of equal `group`, and with `ends` its ends too."""
    if not len(group):
        return np.empty(0, dtype=np.intp)
    starts = np.flatnonzero(np.diff(group, prepend=group[0] - 1))
    sizes = np.diff(np.append(starts, len(group)))
    found = [starts, starts + sizes - 1] if ends else []
    for extreme in (np.minimum, np.maximum):
        hits = np.flatnonzero(y == np.repeat(extreme.reduceat(y, starts), sizes))
        found.append(hits[np.diff(group[hits], prepend=group[0] - 1) != 0])
    return np.unique(np.concatenate(found))


def _separated(t: Array, y: Array, cut: Mask) -> tuple[Array, Array]:
    """`t` and `y` with a NaN value put in after every row of which `cut` is true."""
    places = np.flatnonzero(cut) + 1
    return np.insert(t, places, 0.5 * (t[places - 1] + t[places])), np.insert(y, places, np.nan)
