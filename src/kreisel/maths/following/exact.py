"""Turns a path that can be differentiated at any time into the motion of a body that follows its tangent."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.heading import Span, one_sided, settled
from kreisel.maths.following.joints import PARTS, RATE, TURN, brackets, suspects
from kreisel.maths.following.tangent import (
    AFTER,
    BEFORE,
    EXACT,
    Array,
    Attitude,
    Mask,
    Path,
    Stillness,
    tangent_into,
    unfilled,
)

BLOCK = 32768  # rows at once: bounds the memory, and leaves the cost of a call far behind

WIDER = 8  # doublings of a bracket whose ends were looked at too coarsely to hold the turn itself


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
    """Motion of a body along a path; `aimless` where no horizontal movement ever gives it a heading."""

    p_NB: Array  # (n, 3) m
    v_NB: Array  # (n, 3) m/s
    a_NB: Array  # (n, 3) m/s^2
    attitude: Attitude
    joints: Joints
    aimless: bool


def follow(path: Path, t: Array, span: Span = (-np.inf, np.inf), still: Stillness = EXACT) -> Followed:
    """Motion at times t (n,), increasing and inside `span`, of a body whose x axis lies along the path.

    Each row is what holds just after its time (at the end of the span, just before it), whatever the other
    rows are: where the path reverses, the row belongs to the new direction.
    """
    n = len(t)
    p, v, a = (np.empty((n, 3)) for _ in range(3))
    attitude, headless = unfilled(n), np.empty(n, dtype=np.bool_)
    doubtful = np.zeros(n, dtype=np.bool_)  # whether the interval that ends at a row may hold a joint
    seam: list[Array] = []
    for low in range(0, n, BLOCK):
        rows = slice(low, low + BLOCK)
        p[rows], v[rows], a[rows], jerk = path(t[rows], 3)
        block = (t[rows], v[rows], a[rows], jerk)
        headless[rows] = tangent_into(Attitude(*(column[rows] for column in attitude)), *block, still)
        doubtful[low + 1 : low + BLOCK] = suspects(*block, still)
        if seam:
            before = [np.concatenate([last, column[:1]]) for last, column in zip(seam, block, strict=True)]
            doubtful[low] = suspects(before[0], before[1], before[2], before[3], still)[0]
        seam = [column[-1:] for column in block]
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


def _joints(path: Path, t: Array, ends: npt.NDArray[np.intp], span: Span, still: Stillness) -> Joints:
    """Joints within the intervals that end at rows `ends`; none at the first row, which is after it."""
    instants = brackets(path, t[ends - 1], t[ends], still)
    inside = (instants[:, 0] > t[0]) & (instants[:, 1] < span[1]) if len(t) else np.zeros(0, dtype=np.bool_)
    if not inside.any():
        return Joints(np.empty(0), unfilled(0), unfilled(0))
    left, right = instants[inside].T
    # At the ends of the brackets more must count as nil than inside them.
    before = one_sided(path, left, BEFORE, span, still.coarser(8.0)).attitude
    then = one_sided(path, right, AFTER, span, still.coarser(8.0))
    # A body that comes to rest keeps its attitude; only its rate can step.
    after = then.attitude
    after.R_NB[then.at_rest] = before.R_NB[then.at_rest]
    joints = Joints(0.5 * (left + right), before, after)
    real = (joints.turns > TURN) | (joints.rate_steps > RATE)
    joints = Joints(joints.t[real], _rows(before, real), _rows(after, real))
    return joints._replace(t=_moments(path, joints, left[real], right[real], span, still))


def _moments(path: Path, joints: Joints, left: Array, right: Array, span: Span, still: Stillness) -> Array:
    """When the body turns, in brackets that hold more than an instant: those of slow stops and beginnings."""
    for k in np.flatnonzero((right - left > 1e-6) & (joints.turns > TURN)).tolist():
        low, high = left[k], right[k]
        for _ in range(WIDER):
            if not _turned(path, joints, k, np.array([low]), span, still)[0]:
                break
            low = max(2.0 * low - high, span[0])
        while high - low > 1e-9:
            looks = np.linspace(low, high, PARTS + 1)
            first = max(int(np.argmax(_turned(path, joints, k, looks, span, still))), 1)
            low, high = looks[first - 1], looks[first]
        joints.t[k] = high
    return joints.t


def _rows(attitude: Attitude, mask: Mask) -> Attitude:
    return Attitude(*(column[mask] for column in attitude))


def _turned(path: Path, joints: Joints, k: int, t: Array, span: Span, still: Stillness) -> Mask:
    """Whether at times t the body lies as after joint k rather than as before it."""
    R = one_sided(path, t, AFTER, span, still).attitude.R_NB
    before, after = (np.linalg.norm(R - side.R_NB[k], axis=(1, 2)) for side in (joints.before, joints.after))
    return np.asarray(after < before)
