"""Turns a path and instants into the attitude just before or after them, at rest and in the vertical too.

A body at rest keeps the attitude it came with; one that rises or falls vertically keeps its heading. Before
its first movement it already has the heading of that movement; a body that never moves has heading 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kreisel.maths.following.tangent import (
    AFTER,
    BEFORE,
    DERIVATIVES,
    EXACT,
    STEEP,
    Array,
    Attitude,
    Directions,
    Mask,
    Path,
    Stillness,
    attitude_along,
    instant_at,
    limits,
)

Span = tuple[float, float]

# A movement is looked for every 1/32 s over the nearest 1024 s, then in windows that double, up to 36 hours.
WINDOWS = (32.0,) * 32 + tuple(1024.0 * 2.0**k for k in range(7))
LOOKS = 1025
NARROWING = 65
BLOCK = 8192


class Settled(NamedTuple):
    """Attitudes at single instants, and which of them stand for a body that has no heading at all."""

    attitude: Attitude
    aimless: Mask  # (n,) no horizontal movement was found before or after: heading 0
    at_rest: Mask  # (n,) held


def one_sided(path: Path, t: Array, side: int, span: Span, still: Stillness = EXACT) -> Settled:
    """Attitude just `BEFORE` or `AFTER` times t (n,), increasing; from inside at the ends of the span."""
    with np.errstate(all="ignore"):
        return _held(path, t, _from_inside(path, t, side, span, still), np.empty(0), span, still)


def settled(path: Path, t: Array, moving: Array, span: Span, still: Stillness = EXACT) -> Settled:
    """Attitude at increasing times t (n,) at which the body has no horizontal velocity.

    An instant of rest belongs to the movement that begins there; where none begins, the last attitude is
    held. `moving` are times at which the body is known to move; they need not be all.
    """
    with np.errstate(all="ignore"):
        blocks = [_what_follows(path, t[k : k + BLOCK], span, still) for k in range(0, len(t), BLOCK)]
        directions = Directions(*(np.concatenate(columns) for columns in zip(*blocks, strict=True)))
        return _held(path, t, directions, moving, span, still)


def _what_follows(path: Path, t: Array, span: Span, still: Stillness) -> Directions:
    """Directions after t; whether a piecewise function has its seam before or after t does not matter."""
    here = _from_inside(path, t, AFTER, span, still)
    soon = t + 2.0 * instant_at(t, still)
    then = _from_inside(path, np.where(soon > span[1], t, soon), AFTER, span, still)
    astray = ~_agree(here, then)
    for column, replacement in zip(here, then, strict=True):
        column[astray] = replacement[astray]
    return here


def _from_inside(path: Path, t: Array, side: int, span: Span, still: Stillness) -> Directions:
    out = _directions(path, t, side, span, still)
    turned = t >= span[1] if side == AFTER else t <= span[0]
    if turned.any():
        inner = _directions(path, t, -side, span, still)
        for column, replacement in zip(out, inner, strict=True):
            column[turned] = replacement[turned]
    return out


def _agree(one: Directions, other: Directions) -> Mask:
    """Rows that head the same way to a thousandth; what is unknown agrees with nothing."""
    level = np.sum(one.heading[:, :2] * other.heading[:, :2], axis=1) > 1.0 - 1e-6
    steep = np.isnan(one.heading[:, 0]) & np.isnan(other.heading[:, 0])
    return np.asarray((level | steep) & (one.climb[:, 3] * other.climb[:, 3] >= 0.0))


def _held(
    path: Path, t: Array, directions: Directions, moving: Array, span: Span, still: Stillness
) -> Settled:
    at_rest = np.isnan(directions.climb[:, 0])
    aimless = _hold(path, t, directions.heading, False, moving, span, still)
    _hold(path, t, directions.climb, True, moving, span, still)
    return Settled(attitude_along(directions), aimless, at_rest)


def _hold(
    path: Path, t: Array, column: Array, climb: bool, moving: Array, span: Span, still: Stillness
) -> Mask:
    """Fill the unknown rows of heading or climb with the last movement's; returns those without any.

    Done from the latest row back: all rows since the stop that it finds share its answer.
    """
    without = np.zeros(len(t), dtype=np.bool_)
    unknown = np.flatnonzero(np.isnan(column[:, 0]))
    while unknown.size:
        last = float(t[unknown[-1]])
        earlier = int(np.searchsorted(moving, last))
        near = (float(moving[earlier - 1]) if earlier else span[0], span[1])
        since, value = _last_direction(path, last, climb, near, still)
        shared = t[unknown] >= since
        column[unknown[shared]] = 0.0
        column[unknown[shared], 0] = 1.0 if value is None else value[0]
        column[unknown[shared], 3 if climb else 1] = 0.0 if value is None else value[1]
        without[unknown[shared]] = value is None
        unknown = unknown[~shared]
    return without


def _last_direction(
    path: Path, t: float, climb: bool, span: Span, still: Stillness
) -> tuple[float, tuple[float, float] | None]:
    """Since when the direction is held, and its cosine and sine; else those of the first movement."""
    stop = _nearest_movement(path, t, BEFORE, climb, span, still)
    start = _nearest_movement(path, t, AFTER, climb, span, still) if stop is None else None
    when, side = (stop, BEFORE) if stop is not None else (start, AFTER)
    if when is None:
        return -np.inf, None
    found = _directions(path, np.array([when]), side, span, still)
    x, y = (found.climb[0, 0], found.climb[0, 3]) if climb else (found.heading[0, 0], found.heading[0, 1])
    size = float(np.hypot(x, y))
    return (-np.inf if stop is None else stop), (float(x) / size, float(y) / size)


def _directions(path: Path, t: Array, side: int, span: Span, still: Stillness) -> Directions:
    """Directions on one side of times t as far as the body is seen to move along them there.

    A series promises a movement where the velocity is nil. A smooth stop, like that of exp(-1 / (2 - t)),
    promises a reversal long before its end and never keeps the promise.
    """
    derivatives = path(t, DERIVATIVES)[1:]
    found, delay = limits(t, derivatives, side, still)
    level = np.nan_to_num(found.heading[:, :2])
    forward = found.climb[:, :1] * level
    promises = level, np.concatenate([forward, found.climb[:, 3:4]], axis=1)
    for promise, wait, column in zip(promises, delay.T, found, strict=True):
        rows = np.flatnonzero((wait > 0.0) & ~np.isnan(column[:, 0]))
        if rows.size:
            then = np.clip(t[rows] + side * 2.0 * wait[rows], *span)
            v = path(then, 1)[1][:, : promise.shape[1]]
            along = np.sum(v * promise[rows], axis=1) / np.linalg.norm(promise[rows], axis=1)
            column[rows[~(along > still.speed)]] = np.nan
    slanted = np.linalg.norm(forward, axis=1) > STEEP * np.abs(found.climb[:, 3])
    found.climb[slanted & np.isnan(found.heading[:, 0])] = np.nan
    found.heading[np.isnan(found.climb[:, 0])] = np.nan
    return found


def _nearest_movement(
    path: Path, t: float, side: int, climb: bool, span: Span, still: Stillness
) -> float | None:
    """The nearest instant to t, or t, before (after) it at which the body moves; None where it never does."""
    edge, end = t, span[0] if side == BEFORE else span[1]
    for window in WINDOWS:
        far = max(edge - window, end) if side == BEFORE else min(edge + window, end)
        looks = np.linspace(edge, far, LOOKS)
        moving = _moving(path, looks, side, climb, span, still)
        if moving.any():
            k = int(np.argmax(moving))
            return (
                float(looks[0]) if k == 0 else _narrowed(path, looks[k - 1 : k + 1], side, climb, span, still)
            )
        edge = far
        if edge == end:
            break
    return None


def _narrowed(path: Path, bracket: Array, side: int, climb: bool, span: Span, still: Stillness) -> float:
    """The moving end of `bracket` (resting, moving), brought as near to the resting one as it goes."""
    resting, moving = float(bracket[0]), float(bracket[1])
    while True:
        looks = np.linspace(resting, moving, NARROWING)
        k = max(int(np.argmax(_moving(path, looks, side, climb, span, still))), 1)
        closer = abs(looks[k] - looks[k - 1])
        if closer >= abs(moving - resting) or closer <= 1e-3 * still.instant:
            return moving
        resting, moving = float(looks[k - 1]), float(looks[k])


def _moving(path: Path, t: Array, side: int, climb: bool, span: Span, still: Stillness) -> Mask:
    found = _directions(path, t, side, span, still)
    return ~np.isnan(found.climb[:, 0] if climb else found.heading[:, 0])
