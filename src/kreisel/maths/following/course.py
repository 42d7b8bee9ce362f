"""Turns a path known from samples into the attitude of a body that follows it, resting where the path only trembles.

`exact` trusts every derivative of an exact path, however small. Behind samples there is a floor of speed
under which the direction is noise: there the last heading is held, and where the body leaves the floor in
another direction than it came, a jump is reported.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.derivatives import Signal
from kreisel.maths.following.tangent import Attitude, Directions, Stillness, attitude_along, tangent_motion

Array = npt.NDArray[np.float64]

# Halvings of one sampling step: to a millionth of it.
_HALVINGS = 20


class Course(NamedTuple):
    """Where a path has no horizontal direction of its own, and the heading held there."""

    floor: float  # m/s, horizontal speed under which the direction is noise
    left: Array  # (m,) s, begin of each stretch under the floor
    right: Array  # (m,) s, its end; infinite where the path ends in it
    heading: Array  # (m, 2) cosine and sine of the heading held in it
    turn: Array  # (m,) rad, by how much the heading jumps at its end; 0 where the path ends


def course(position: Signal, t: Array, floor: float, response: float = 0.0) -> Course:
    """Stretches without a direction of the path `position`, found between its sample times `t` (n,) s.

    floor: m/s, horizontal speed under which the direction is noise; movements within `response` s of an end of
    the path that stop again are noise, whatever their speed.
    """
    left, right = _stretches(position, t, floor)
    left[left - t[0] < response], right[t[-1] - right < response] = t[0], t[-1]
    before, after = (_direction(position, edge) for edge in (left, right))
    # A path that begins at rest has the heading of its first movement; one that never moves heads east.
    before[left <= t[0]] = after[left <= t[0]]
    before[(left <= t[0]) & (right >= t[-1])] = [1.0, 0.0]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turn = np.abs(np.arctan2(cross, np.sum(before * after, axis=1)))
    ended = right >= t[-1]
    return Course(floor, left, np.where(ended, np.inf, right), before, np.where(ended, 0.0, turn))


def attitude_on(course: Course, t: Array, v: Array, a: Array, j: Array) -> Attitude:
    """Attitude at times t (n,) of a body along `course`, from velocity, acceleration and jerk (n, 3) in N."""
    attitude, headless = tangent_motion(t, v, a, j, Stillness(speed=0.0, instant=0.0))
    if not len(course.left):
        return attitude
    stretch = np.searchsorted(course.left, t, side="right") - 1
    held = headless | ((stretch >= 0) & (t < course.right[stretch]))
    held &= stretch >= 0
    if held.any():
        directions = _held(course, stretch[held], v[held], a[held], j[held])
        for whole, part in zip(attitude, attitude_along(directions), strict=True):
            whole[held] = part
    return attitude


def _held(course: Course, stretch: npt.NDArray[np.intp], v: Array, a: Array, j: Array) -> Directions:
    """The vertical plane of the heading held: pitch turns in it where the body climbs, and rests where it does not."""
    forward = course.heading[stretch]
    heading = np.concatenate([forward, np.zeros_like(forward)], axis=1)
    climb = np.empty((len(v), 6))
    for k, derivative in enumerate((v, a, j)):
        climb[:, k] = np.sum(derivative[:, :2] * forward, axis=1)
        climb[:, 3 + k] = derivative[:, 2]
    climb[np.linalg.norm(v, axis=1) <= course.floor] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    return Directions(heading, climb)


def _lowest(position: Signal, t: Array) -> Array:
    """Times between samples at which the horizontal speed is lowest, and the samples' own."""
    falling = _slope(position, t)
    k = np.flatnonzero((falling[:-1] < 0.0) & (falling[1:] > 0.0))
    left, right = t[k].copy(), t[k + 1].copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (left + right)
        down = _slope(position, middle) < 0.0
        left, right = np.where(down, middle, left), np.where(down, right, middle)
    return np.union1d(t, 0.5 * (left + right))


def _stretches(position: Signal, t: Array, floor: float) -> tuple[Array, Array]:
    """Begins and ends of the stretches under the floor."""
    looks = _lowest(position, t)
    low = _speed(position, looks) <= floor
    steps = np.diff(np.concatenate([[False], low, [False]]).astype(np.int8))
    first, last = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1
    left, right = looks[first], looks[last]
    inner = first > 0
    left[inner] = _crossing(position, left[inner], looks[first[inner] - 1], floor)
    inner = last < len(looks) - 1
    right[inner] = _crossing(position, right[inner], looks[last[inner] + 1], floor)
    return left, right


def _crossing(position: Signal, low: Array, high: Array, floor: float) -> Array:
    """Where between a time under the floor and one above it the horizontal speed meets it; above it, just."""
    if not len(low):
        return low
    for _ in range(_HALVINGS + 16):
        middle = 0.5 * (low + high)
        under = _speed(position, middle) <= floor
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    return high


def _speed(position: Signal, t: Array) -> Array:
    v = position(t, 1)[1]
    return np.asarray(np.hypot(v[:, 0], v[:, 1]))


def _slope(position: Signal, t: Array) -> Array:
    """Half the derivative of the squared horizontal speed."""
    _, v, a = position(t, 2)
    return np.asarray(v[:, 0] * a[:, 0] + v[:, 1] * a[:, 1])


def _direction(position: Signal, t: Array) -> Array:
    """Cosine and sine (m, 2) of the heading at times t."""
    v = position(t, 1)[1, :, :2]
    return np.asarray(v / np.maximum(np.hypot(v[:, :1], v[:, 1:]), 1e-300))
