"""Turns a path known from samples into the attitude of a body that follows it, resting where the path only trembles.

`exact` trusts every derivative of an exact path, however small. Behind samples there is a floor of speed
under which a direction is noise: there the body keeps its attitude, or in the vertical its heading, and where
it leaves the floor in another direction than it came, there is a joint.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.derivatives import Signal
from kreisel.maths.following.exact import Joints
from kreisel.maths.following.tangent import Attitude, Directions, Stillness, attitude_along, tangent_motion

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# rad; smaller steps are what a floor leaves of a path that goes on as it came.
JUMP = np.deg2rad(2.0)

# Up to this many floors, a body without a heading of its own rests; above, it rises or falls.
_CLIMBING = 10.0

# Halvings of one sampling step: until time stamps cannot be told apart.
_HALVINGS = 44


class Stretches(NamedTuple):
    """Where a body is too slow, in order; from just above the floor to just above it."""

    left: Array  # (m,) s; minus infinity where the path begins there
    right: Array  # (m,) s; infinity where it ends there

    def holding(self, t: Array, before: bool = False) -> npt.NDArray[np.intp]:
        """Index (n,) of the stretch that holds just after (just `before`) times t; -1 where none does."""
        k = np.searchsorted(self.left, t, side="left" if before else "right") - 1
        if not len(self.left):
            return k
        return np.where((k >= 0) & ((t <= self.right[k]) if before else (t < self.right[k])), k, -1)

    def moving(self, t: Array, before: bool = False) -> tuple[Array, Mask]:
        """Times of the movement whose attitude holds at times t, and where that is a rest.

        The attitude of a rest is that with which it began; before the first movement, that of its begin.
        """
        k = self.holding(t, before)
        at_rest = k >= 0
        when = t.copy()
        known = np.where(np.isfinite(self.left), self.left, self.right)
        when[at_rest] = known[k[at_rest]]
        return np.where(np.isfinite(when), when, t), at_rest

    def settle(self, out: Attitude, t: Array, step: float, attitude: Callable[[Array], Attitude]) -> None:
        """Rates at times t of rest: none, or where a rest is shorter than `step`, those with which it began.

        That is no rest but a turning point, too slow for rates of its own: they are taken a little earlier.
        """
        k = self.holding(t)
        at_rest = k >= 0
        brief = at_rest & (self.right[k] - self.left[k] < step) if at_rest.any() else at_rest
        out.omega_NB_B[at_rest] = out.alpha_NB_B[at_rest] = 0.0
        if brief.any():
            earlier = attitude(self.left[k[brief]] - 0.25 * step)
            out.omega_NB_B[brief], out.alpha_NB_B[brief] = earlier.omega_NB_B, earlier.alpha_NB_B

    @property
    def everywhere(self) -> bool:
        """Whether the body is too slow from the begin of the path to its end."""
        return bool(np.any(np.isinf(self.left) & np.isinf(self.right)))


class Course:
    """A body along the path `position`, known from samples at `t` (n,) s, nose first and y axis level.

    floor: (n,) m/s, speed at the samples under which a direction is noise.
    """

    def __init__(self, position: Signal, t: Array, floor: Array) -> None:
        self._position, self._step = position, float(np.median(np.diff(t)))
        slow = Slowness(position, t, floor)
        self._vertical = slow.stretches(slow.on_the_level)
        self._rest = slow.stretches(slow.at_rest)
        left, right = self._vertical
        # A path that begins without a heading has that of its first movement; one that never has any, east.
        edges = np.where(np.isfinite(left), left, np.where(np.isfinite(right), right, t[0]))
        v = position(edges, 1)[1, :, :2]
        self._heading = v / np.maximum(np.hypot(v[:, :1], v[:, 1:]), 1e-300)
        self.aimless = self._vertical.everywhere
        if self.aimless:
            self._heading[:] = [1.0, 0.0]

    def attitude(self, t: Array, before: bool = False) -> Attitude:
        """Attitude just after (just `before`) increasing times t (n,)."""
        when, at_rest = self._rest.moving(t, before)
        _, v, a, j = self._position(when, 3)
        attitude, headless = tangent_motion(when, v, a, j, Stillness(speed=0.0, instant=0.0))
        # A rest ends in the movement before it, whose heading may itself be one that is held.
        stretch = np.where(
            at_rest, self._vertical.holding(when, before=False), self._vertical.holding(t, before)
        )
        held = np.flatnonzero((stretch >= 0) | headless)
        if held.size:
            forward = self._heading[stretch[held]] if len(self._heading) else np.array([[1.0, 0.0]])
            directions = _in_the_plane(forward, v[held], a[held], j[held])
            for whole, part in zip(attitude, attitude_along(directions), strict=True):
                whole[held] = part
        if self._rest.everywhere:
            attitude.R_NB[:] = np.eye(3)
        self._rest.settle(attitude, t, self._step, self.attitude)
        return attitude

    def joints(self) -> Joints:
        """Where the body leaves a floor with a jump."""
        ends = np.union1d(self._vertical.right, self._rest.right)
        ends = ends[np.isfinite(ends)]
        found = Joints(ends, self.attitude(ends, before=True), self.attitude(ends))
        real = found.turns > JUMP
        before, after = (Attitude(*(c[real] for c in side)) for side in (found.before, found.after))
        return Joints(ends[real], before, after)


def _in_the_plane(forward: Array, v: Array, a: Array, j: Array) -> Directions:
    """The vertical plane of a heading that is held (n, 2): pitch turns in it."""
    forward = np.broadcast_to(forward, (len(v), 2))
    climb = np.empty((len(v), 6))
    for k, derivative in enumerate((v, a, j)):
        climb[:, k] = np.sum(derivative[:, :2] * forward, axis=1)
        climb[:, 3 + k] = derivative[:, 2]
    climb[~np.any(climb[:, [0, 3]] != 0.0, axis=1)] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    return Directions(np.concatenate([forward, np.zeros_like(forward)], axis=1), climb)


class Slowness:
    """Where the path `position`, with samples at `t` (n,) s, is too slow for a `floor` (n,) m/s of speed."""

    def __init__(self, position: Signal, t: Array, floor: Array) -> None:
        self._position, self._t, self._floor = position, t, floor
        self._looks = np.union1d(t, np.concatenate([self._lowest(2), self._lowest(3)]))

    def on_the_level(self, t: Array) -> Mask:
        """Whether the horizontal speed is too low for a heading."""
        return np.asarray(self._speed(t, 2) <= self._floor_at(t))

    def at_rest(self, t: Array) -> Mask:
        """Whether a body without a heading does not rise or fall either."""
        return self.on_the_level(t) & (self._speed(t, 3) <= _CLIMBING * self._floor_at(t))

    def altogether(self, t: Array) -> Mask:
        """Whether the speed is too low for a direction."""
        return np.asarray(self._speed(t, 3) <= self._floor_at(t))

    def stretches(self, slow: Callable[[Array], Mask]) -> Stretches:
        """Stretches that are slow by one of these measures."""
        looks = self._looks
        steps = np.diff(np.concatenate([[False], slow(looks), [False]]).astype(np.int8))
        first, last = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1
        left, right = np.full(len(first), -np.inf), np.full(len(last), np.inf)
        inner = first > 0
        left[inner] = _crossing(slow, looks[first[inner]], looks[first[inner] - 1])
        inner = last < len(looks) - 1
        right[inner] = _crossing(slow, looks[last[inner]], looks[last[inner] + 1])
        return Stretches(left, right)

    def _floor_at(self, t: Array) -> Array:
        return np.interp(t, self._t, self._floor)

    def _speed(self, t: Array, axes: int) -> Array:
        return np.asarray(np.linalg.norm(self._position(t, 1)[1, :, :axes], axis=1))

    def _lowest(self, axes: int) -> Array:
        """Times between samples at which the speed is lowest, where that may be under the floor."""
        _, v, a = self._position(self._t, 2)[:, :, :axes]
        slope, speed, push = np.sum(v * a, axis=1), np.linalg.norm(v, axis=1), np.linalg.norm(a, axis=1)
        # Twice what the accelerations at the samples take away in a whole step.
        within_reach = speed[:-1] <= 2.0 * np.diff(self._t) * np.maximum(push[:-1], push[1:]) + (
            _CLIMBING * np.maximum(self._floor[:-1], self._floor[1:])
        )
        k = np.flatnonzero((slope[:-1] < 0.0) & (slope[1:] > 0.0) & within_reach)
        left, right = self._t[k], self._t[k + 1]
        for _ in range(_HALVINGS if len(k) else 0):
            middle = 0.5 * (left + right)
            down = self._slope(middle, axes) < 0.0
            left, right = np.where(down, middle, left), np.where(down, right, middle)
        return np.asarray(0.5 * (left + right))

    def _slope(self, t: Array, axes: int) -> Array:
        """Half the derivative of the squared speed."""
        _, v, a = self._position(t, 2)[:, :, :axes]
        return np.asarray(np.sum(v * a, axis=1))


def _crossing(slow: Callable[[Array], Mask], low: Array, high: Array) -> Array:
    """Just above the floor, between times under it and above it."""
    for _ in range(_HALVINGS if len(low) else 0):
        middle = 0.5 * (low + high)
        under = slow(middle)
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    return high
