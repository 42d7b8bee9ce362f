"""Turns derivatives of a path into the attitude, rate and angular acceleration of a body that follows it.

The x axis lies along the velocity and the y axis stays level: phi_z = atan2(v_y, v_x),
phi_y = -asin(v_z / |v|), phi_x = 0 (document 000, eqs. (10)-(13)), differentiated in closed form.

Where the horizontal velocity vanishes these angles still have a limit from either side, given by the first
derivatives that do not vanish, and the two may differ: a path that reverses, or passes through the vertical,
turns the body by half a turn in an instant.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Path = Callable[[Array, int], Array]
"""path(t, order) -> (order + 1, n, 3): position and its derivatives in N at times t (n,)."""

DERIVATIVES = 6
"""Derivatives of position behind a limit: a movement may begin with snap (the fourth), and two more."""

STEEP = 1e-3
"""Horizontal part of a movement, over the vertical one, up to which it can pass for vertical."""

BEFORE, AFTER = -1, 1
"""From which side of an instant a limit is taken."""


class Attitude(NamedTuple):
    """Attitude, rate and angular acceleration of B in N."""

    R_NB: Array  # (n, 3, 3)
    omega_NB_B: Array  # (n, 3) rad/s
    alpha_NB_B: Array  # (n, 3) rad/s^2


def unfilled(n: int) -> Attitude:
    """Room for n rows."""
    return Attitude(np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3)))


class Stillness(NamedTuple):
    """What counts as no movement: more than round-off, less than anything a body does.

    The velocity is nil up to `speed` plus what its derivatives bring about within `instant`, as time stamps
    are not known any better. A body whose velocity is nil begins to move when its derivatives lift it above
    that within 1 / `rate`; otherwise it is at rest.
    """

    speed: float = 1e-12  # m/s
    rate: float = 10.0  # 1/s
    instant: float = 1e-12  # s; four units in the last place of t are added

    def coarser(self, factor: float) -> Stillness:
        """The same, with more counting as nil."""
        return Stillness(factor * self.speed, self.rate, factor * self.instant)


EXACT = Stillness()


def instant_at(t: Array, still: Stillness) -> Array:
    """Seconds (n,) within which times t (n,) cannot be told apart."""
    return np.asarray(still.instant + 8.9e-16 * np.abs(t))


def tangent_motion(t: Array, v: Array, a: Array, j: Array, still: Stillness = EXACT) -> tuple[Attitude, Mask]:
    """Attitude of a body along its path, from velocity, acceleration and jerk (n, 3) in N at times t (n,).

    The mask (n,) marks the rows without a heading, where the horizontal velocity is nil. They are left at
    the identity and at rates of zero; `limits` has their values.
    """
    attitude = unfilled(len(v))
    return attitude, tangent_into(attitude, t, v, a, j, still)


def tangent_into(attitude: Attitude, t: Array, v: Array, a: Array, j: Array, still: Stillness) -> Mask:
    """`tangent_motion` into an attitude that exists; returns the mask."""
    headless = np.empty(len(v), dtype=np.bool_)
    inputs = argument(t), argument(v), argument(a), argument(j)
    _tangent(*inputs, still.speed, still.rate, still.instant, *attitude, headless)
    return headless


class Directions(NamedTuple):
    """Where a path heads, with two derivatives, in numbers that stay finite at rest and in the vertical.

    heading (n, 4): cos phi_z, sin phi_z, and phi_z' and phi_z'' in rad/s and rad/s^2; NaN where unknown.
    climb (n, 6): horizontal and vertical velocity, each with two derivatives, in any unit common to a row;
    NaN where unknown.
    """

    heading: Array
    climb: Array


class Limits(NamedTuple):
    """Directions on one side of instants, and when the series they are read from says that they can be seen."""

    directions: Directions
    delay: Array  # (n, 2) s, until heading and climb are those of a velocity above nil; 0 where it is already


def limits(t: Array, derivatives: Array, side: int, still: Stillness = EXACT) -> Limits:
    """Directions just `BEFORE` or `AFTER` times t (n,), from derivatives (6, n, 3): velocity and five more.

    With v = tau^m u(tau) / m! near the time, the body lies along u after and along (-1)^m u before it.
    """
    n = len(t)
    out = Limits(Directions(np.full((n, 4), np.nan), np.full((n, 6), np.nan)), np.zeros((n, 2)))
    inputs = argument(t), argument(derivatives)
    _limits(*inputs, side, still.speed, still.rate, still.instant, *out.directions, out.delay)
    return out


def leading_series(t: Array, derivatives: Array, side: int, still: Stillness = EXACT) -> Array:
    """u (3, n, 3), two derivatives with it, along the movement just `BEFORE` or `AFTER` t; NaN at rest.

    derivatives (6, n, 3) in N: velocity and five more. Where the velocity is not nil it is u itself.
    """
    out = np.full((3, len(t), 3), np.nan)
    _leading_series(argument(t), argument(derivatives), side, still.speed, still.rate, still.instant, out)
    return out


def attitude_along(directions: Directions) -> Attitude:
    """Attitude (n rows) of a body that lies along `directions`, all of them known."""
    out = unfilled(len(directions.heading))
    _attitude_along(argument(directions.heading), argument(directions.climb), *out)
    return out


@kernel
def _tangent(
    t: Array, v: Array, a: Array, j: Array, speed: float, rate: float, instant: float,
    R: Array, omega: Array, alpha: Array, headless: Mask,
) -> None:  # fmt: skip
    for k in range(t.shape[0]):
        x, y, ax, ay, jx, jy = v[k, 0], v[k, 1], a[k, 0], a[k, 1], j[k, 0], j[k, 1]
        level = x * x + y * y
        h = np.sqrt(level)
        bend = _instant(t[k], instant) * (np.sqrt(ax * ax + ay * ay) + np.sqrt(jx * jx + jy * jy) / rate)
        headless[k] = not h > speed + bend
        if headless[k]:
            _place(k, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, R, omega, alpha)
            continue
        along = x * ax + y * ay
        turn = (x * ay - y * ax) / level
        turn_rate = (x * jy - y * jx) / level - 2.0 * turn * along / level
        dh = along / h
        # h'' = (h phi_z'^2) + the part of the jerk along h: no difference of nearly equal squares.
        ddh = (x * jx + y * jy) / h + h * turn * turn
        _place(k, x / h, y / h, turn, turn_rate, h, dh, ddh, v[k, 2], a[k, 2], j[k, 2], R, omega, alpha)


@kernel
def _instant(t: float, instant: float) -> float:
    return instant + 8.9e-16 * abs(t)


@kernel
def _place(
    k: int, cz: float, sz: float, dz: float, ddz: float,
    h: float, dh: float, ddh: float, u: float, du: float, ddu: float,
    R: Array, omega: Array, alpha: Array,
) -> None:  # fmt: skip
    """Row k from heading and climb; phi_y = -atan2(u, h)."""
    squared = h * h + u * u
    s = np.sqrt(squared)
    cy, sy = h / s, -u / s
    dy = -(h * du - u * dh) / squared
    ddy = -(h * ddu - u * ddh) / squared - 2.0 * dy * (h * dh + u * du) / squared
    R[k, 0, 0], R[k, 0, 1], R[k, 0, 2] = cz * cy, -sz, cz * sy
    R[k, 1, 0], R[k, 1, 1], R[k, 1, 2] = sz * cy, cz, sz * sy
    R[k, 2, 0], R[k, 2, 1], R[k, 2, 2] = -sy, 0.0, cy
    omega[k, 0], omega[k, 1], omega[k, 2] = -dz * sy, dy, dz * cy
    alpha[k, 0], alpha[k, 1], alpha[k, 2] = -ddz * sy - dz * dy * cy, ddy, ddz * cy - dz * dy * sy


@kernel
def _attitude_along(heading: Array, climb: Array, R: Array, omega: Array, alpha: Array) -> None:
    for k in range(heading.shape[0]):
        _place(
            k, heading[k, 0], heading[k, 1], heading[k, 2], heading[k, 3],
            climb[k, 0], climb[k, 1], climb[k, 2], climb[k, 3], climb[k, 4], climb[k, 5], R, omega, alpha,
        )  # fmt: skip


@kernel
def _norm(d: Array, order: int, k: int, axes: int) -> float:
    total = 0.0
    for i in range(axes):
        total += d[order, k, i] * d[order, k, i]
    return math.sqrt(total)


@kernel
def _leading(d: Array, k: int, axes: int, speed: float, rate: float, instant: float) -> tuple[int, float]:
    """Index of the derivative in row k, first `axes` components, that the movement begins with; -1 at rest.

    And the time it takes to lift the velocity above round-off; it is the first to do so. Comparing
    derivatives with fixed thresholds instead would take the tail of a slow beginning for a reversal.
    """
    nil = speed + instant * (_norm(d, 1, k, axes) + _norm(d, 2, k, axes) / rate)
    if _norm(d, 0, k, axes) > nil:
        return 0, 0.0
    first, soonest, factorial = -1, 1.0 / rate, 1.0
    for m in range(1, d.shape[0] - 2):
        factorial *= m
        size = _norm(d, m, k, axes)
        delay = (nil * factorial / size) ** (1.0 / m) if size > 0.0 else np.inf
        if delay < soonest:
            first, soonest = m, delay
    return first, soonest


@kernel
def _leading_series(
    t: Array, d: Array, side: int, speed: float, rate: float, instant: float, out: Array
) -> None:
    for k in range(t.shape[0]):
        m, _ = _leading(d, k, 3, speed, rate, _instant(t[k], instant))
        if m < 0:
            continue
        sign = -1.0 if side < 0 and m % 2 == 1 else 1.0
        for i in range(3):
            out[0, k, i] = sign * d[m, k, i]
            out[1, k, i] = sign * d[m + 1, k, i] / (m + 1)
            out[2, k, i] = sign * d[m + 2, k, i] * 2.0 / ((m + 1) * (m + 2))


@kernel
def _limits(
    t: Array, d: Array, side: int, speed: float, rate: float, instant: float,
    heading: Array, climb: Array, delay: Array,
) -> None:  # fmt: skip
    for k in range(t.shape[0]):
        now = _instant(t[k], instant)
        level, delay[k, 0] = _leading(d, k, 2, speed, rate, now)
        m, delay[k, 1] = _leading(d, k, 3, speed, rate, now)
        if m < 0:
            continue
        if _norm(d, m, k, 2) > STEEP * abs(d[m, k, 2]):
            # A slanted movement has its heading and its climb from one and the same derivative.
            level, delay[k, 0] = m, delay[k, 1]
        up = -1.0 if side < 0 and m % 2 == 1 else 1.0
        climb[k, 3] = up * d[m, k, 2]
        climb[k, 4] = up * d[m + 1, k, 2] / (m + 1)
        climb[k, 5] = up * d[m + 2, k, 2] * 2.0 / ((m + 1) * (m + 2))
        climb[k, 0], climb[k, 1], climb[k, 2] = 0.0, 0.0, 0.0
        if level >= 0:
            _heading_limit(k, d, max(level, m), m, side, heading, climb)


@kernel
def _heading_limit(k: int, d: Array, level: int, m: int, side: int, heading: Array, climb: Array) -> None:
    """Heading and horizontal speed where the horizontal velocity begins with its derivative `level` >= m."""
    scale = 1.0
    for i in range(m + 1, level + 1):
        scale /= i
    first, second = scale / (level + 1), scale * 2.0 / ((level + 1) * (level + 2))
    x, y = scale * d[level, k, 0], scale * d[level, k, 1]
    dx, dy = first * d[level + 1, k, 0], first * d[level + 1, k, 1]
    ddx, ddy = second * d[level + 2, k, 0], second * d[level + 2, k, 1]
    squared = x * x + y * y
    size, along = np.sqrt(squared), x * dx + y * dy
    turn = (x * dy - y * dx) / squared
    sign = -1.0 if side < 0 and level % 2 == 1 else 1.0
    heading[k, 0], heading[k, 1], heading[k, 2] = sign * x / size, sign * y / size, turn
    heading[k, 3] = (x * ddy - y * ddx) / squared - 2.0 * turn * along / squared
    if level == m:
        climb[k, 0], climb[k, 1], climb[k, 2] = (
            size,
            along / size,
            (x * ddx + y * ddy) / size + size * turn * turn,
        )
    elif level == m + 1:
        climb[k, 1], climb[k, 2] = side * size, side * 2.0 * along / size
    elif level == m + 2:
        climb[k, 2] = 2.0 * size
