"""Turns a path that can be differentiated at any time into the motion of a body that follows its tangent."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kreisel.maths.heading import Span, one_sided, settled
from kreisel.maths.joints import RATE, TURN, brackets, suspects
from kreisel.maths.tangent import AFTER, BEFORE, EXACT, Array, Attitude, Mask, Path, Stillness, tangent_motion

BLOCK = 8192  # rows at once: bounds the memory, and three derivatives of a block stay in the cache


class Joints(NamedTuple):
    """Instants at which attitude or rate step, with the values on either side."""

    t: Array  # (m,) s
    before: Attitude
    after: Attitude

    @property
    def turns(self) -> Array:
        """(m,) rad, angle between the attitudes on either side."""
        # Chord of the rotation: accurate for small angles, where the trace is not.
        chord = np.linalg.norm(self.after.R_NB - self.before.R_NB, axis=(1, 2)) / np.sqrt(8.0)
        return np.asarray(2.0 * np.arcsin(np.minimum(chord, 1.0)))

    @property
    def rate_steps(self) -> Array:
        """(m,) rad/s, length of the step in omega_NB_B."""
        return np.asarray(np.linalg.norm(self.after.omega_NB_B - self.before.omega_NB_B, axis=1))


class Followed(NamedTuple):
    """Motion of a body along a path; `aimless` where no horizontal movement gives it a heading at any time."""

    p_NB: Array  # (n, 3) m
    v_NB: Array  # (n, 3) m/s
    a_NB: Array  # (n, 3) m/s^2
    attitude: Attitude
    joints: Joints
    aimless: bool


def follow(path: Path, t: Array, span: Span = (-np.inf, np.inf), still: Stillness = EXACT) -> Followed:
    """Motion at times t (n,), strictly increasing and inside `span`, of a body whose x axis lies along the path.

    Each row is what holds just after its time (at the end of the span, just before it), whatever the other
    rows are: where the path reverses, the row belongs to the new direction.
    """
    n = len(t)
    p, v, a = (np.empty((n, 3)) for _ in range(3))
    attitude = Attitude(np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3)))
    headless, doubtful = np.empty(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_)
    tail: tuple[Array, ...] = ()
    for low in range(0, n, BLOCK):
        rows = slice(low, low + BLOCK)
        p[rows], v[rows], a[rows], jerk = path(t[rows], 3)
        columns = (t[rows], v[rows], a[rows], jerk)
        part, headless[rows] = tangent_motion(*columns, still)
        for whole, piece in zip(attitude, part, strict=True):
            whole[rows] = piece
        with_tail = (
            tuple(np.concatenate(pair) for pair in zip(tail, columns, strict=True)) if tail else columns
        )
        doubtful[low + (0 if tail else 1) : low + BLOCK] = suspects(*with_tail, still)
        tail = tuple(column[-1:] for column in columns)
    aimless = _settle(path, t, headless, attitude, span, still)
    joints = _joints(path, t, np.flatnonzero(doubtful), span, still)
    return Followed(p, v, a, attitude, joints, aimless)


def _settle(path: Path, t: Array, headless: Mask, out: Attitude, span: Span, still: Stillness) -> bool:
    """Fill the headless rows of `out`; true when one of them has no heading to take from anywhere."""
    if not headless.any():
        return False
    found = settled(path, t[headless], t[~headless], span, still)
    for whole, piece in zip(out, found.attitude, strict=True):
        whole[headless] = piece
    return bool(found.aimless.any())


def _joints(path: Path, t: Array, ends: Array, span: Span, still: Stillness) -> Joints:
    """Joints within the intervals that end at rows `ends`; not one at the first row, which is after it already."""
    instants = brackets(path, t[ends - 1], t[ends], still)
    inside = (instants[:, 0] > t[0]) & (instants[:, 1] < span[1]) if len(t) else np.zeros(0, dtype=np.bool_)
    left, right = instants[inside].T
    # At the ends of the brackets more must count as nil than inside them.
    before = one_sided(path, left, BEFORE, span, still.coarser(8.0)).attitude
    then = one_sided(path, right, AFTER, span, still.coarser(8.0))
    # A body that comes to rest keeps its attitude; only its rate can step.
    after = then.attitude
    after.R_NB[then.at_rest] = before.R_NB[then.at_rest]
    joints = Joints(0.5 * (left + right), before, after)
    real = (joints.turns > TURN) | (joints.rate_steps > RATE)
    return Joints(joints.t[real], _rows(before, real), _rows(after, real))


def _rows(attitude: Attitude, mask: Mask) -> Attitude:
    return Attitude(*(column[mask] for column in attitude))
