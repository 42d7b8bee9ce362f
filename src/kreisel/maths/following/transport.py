"""Turns a path into the attitude of a body that keeps its x axis along it and never twists about it.

Parallel transport: omega = kappa = v x a / |v|^2, which has no component along the path. Unlike a level y
axis it knows no vertical and no reversal: where the velocity changes sign, the body simply runs backwards.
Attitude needs no differential equation: it is the direction of the path and one roll angle, an integral.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.exact import BLOCK, Followed, Joints, follow
from kreisel.maths.following.heading import Span
from kreisel.maths.following.joints import RATE, TURN
from kreisel.maths.following.rolling import Cells, cells
from kreisel.maths.following.tangent import (
    AFTER,
    BEFORE,
    DERIVATIVES,
    EXACT,
    Array,
    Attitude,
    Path,
    Stillness,
    leading_series,
    unfilled,
)
from kreisel.maths.kernels import argument, kernel

Integers = npt.NDArray[np.integer]


class _Course(NamedTuple):
    """How a body goes through the cells."""

    sign: Array  # (m,) +1 nose first, -1 tail first
    roll: Array  # (m,) rad against the pole, after the start
    R_first: Array  # (m, 3, 3) after the start
    R_last: Array  # (m, 3, 3) before the end


def follow_without_twist(
    path: Path, t: Array, span: Span = (-np.inf, np.inf), still: Stillness = EXACT
) -> Followed:
    """Motion at times t (n,), increasing and inside `span`, of a body parallel-transported along the path.

    At the start of the span, or at t = 0 where it has none (or ends before), the body has the level attitude
    of `follow`; what it is at other times does not depend on which times are asked for. After a rest, or at a
    corner, it turns by the smallest angle that brings its x axis into line, nose or tail first.
    """
    reference = span[0] if np.isfinite(span[0]) else min(0.0, span[1])
    there = follow(path, np.array([reference]), span, still)
    if not len(t):
        return follow(path, t, span, still)
    pieces = cells(path, min(float(t[0]), reference), max(float(t[-1]), reference), span, still)
    course = _course(pieces, reference, there.attitude.R_NB[0])
    unturned, *_ = _sampled(path, np.array([reference]), pieces, course, np.eye(3), span, still)
    # A constant roll (and reversal) of the whole course makes it meet the level attitude there.
    Q = unturned.R_NB[0].T @ there.attitude.R_NB[0]
    attitude, p, v, a = _sampled(path, t, pieces, course, Q, span, still)
    return Followed(
        p, v, a, attitude, _joints(t, pieces, course, Q), there.aimless and bool((pieces.pole < 0).all())
    )


def _course(pieces: Cells, reference: float, R_reference: Array) -> _Course:
    m = len(pieces.left)
    out = _Course(np.empty(m), np.empty(m), np.empty((m, 3, 3)), np.empty((m, 3, 3)))
    moving = np.flatnonzero(pieces.pole >= 0)
    # Before its first movement the body lies as that begins, unless the reference brings it from elsewhere.
    origin = moving[0] if moving.size and pieces.left[moving[0]] <= reference else -1
    R = R_reference.copy()
    if origin >= 0:
        x = pieces.first[0, origin] / np.linalg.norm(pieces.first[0, origin])
        _turn_onto(R, x if x @ R[:, 0] >= 0.0 else -x)
    half = 0.5 * (pieces.right - pieces.left)
    _sweep(half, pieces.inset, pieces.pole, pieces.rate, pieces.first[0], pieces.last[0], R, *out)
    return out


def _sampled(
    path: Path, t: Array, pieces: Cells, course: _Course, Q: Array, span: Span, still: Stillness
) -> tuple[Attitude, Array, Array, Array]:
    """Attitude, position, velocity and acceleration at times t."""
    n = len(t)
    p, v, a = (np.empty((n, 3)) for _ in range(3))
    out = unfilled(n)
    for low in range(0, n, BLOCK):
        rows = slice(low, low + BLOCK)
        p[rows], v[rows], a[rows], jerk = path(t[rows], 3)
        cell = np.clip(np.searchsorted(pieces.left, t[rows], side="right") - 1, 0, len(pieces.left) - 1)
        series = np.stack([v[rows], a[rows], jerk])
        sign = course.sign[cell]
        _replace_nil(path, t[rows], series, sign, cell, pieces, course, span, still)
        _roll_along(
            argument(t[rows]), series, cell, sign, pieces.left, pieces.right, pieces.pole, pieces.rate,
            course.roll, course.R_first, Q, *(column[rows] for column in out),
        )  # fmt: skip
    return out, p, v, a


def _replace_nil(
    path: Path, t: Array, series: Array, sign: Array, cell: Integers, pieces: Cells, course: _Course,
    span: Span, still: Stillness,
) -> None:  # fmt: skip
    """Where the velocity is nil, put what the movement begins with, signed as the body lies there."""
    speed, push = np.linalg.norm(series[0], axis=1), np.linalg.norm(series[1], axis=1)
    nil = np.flatnonzero(speed <= 4.0 * (still.speed + (still.instant + 8.9e-16 * np.abs(t)) * push))
    if not nil.size:
        return
    derivatives = path(t[nil], DERIVATIVES)[1:]
    coarse = still.coarser(4.0)
    series[:, nil] = np.where(
        (t[nil] < span[1])[:, None],
        leading_series(t[nil], derivatives, AFTER, coarse),
        leading_series(t[nil], derivatives, BEFORE, coarse),
    )
    c = cell[nil]
    at_start = (t[nil] - pieces.left[c] < pieces.right[c] - t[nil])[:, None]
    x_B = np.where(at_start, course.R_first[c, :, 0], course.R_last[c, :, 0])
    sign[nil] = np.where(np.sum(series[0, nil] * x_B, axis=1) < 0.0, -1.0, 1.0)


def _joints(t: Array, pieces: Cells, course: _Course, Q: Array) -> Joints:
    """Cell ends inside the times asked for at which attitude or rate step."""
    inside = np.flatnonzero((pieces.left[1:] > t[0]) & (pieces.left[1:] <= t[-1]))
    before = _attitude(course.R_last[inside] @ Q, pieces.last[:, inside])
    after = _attitude(course.R_first[inside + 1] @ Q, pieces.first[:, inside + 1])
    joints = Joints(pieces.left[inside + 1], before, after)
    real = (joints.turns > TURN) | (joints.rate_steps > RATE)
    keep = [Attitude(*(column[real] for column in side)) for side in (before, after)]
    return Joints(joints.t[real], keep[0], keep[1])


def _attitude(R: Array, u: Array) -> Attitude:
    """Attitude with the rates of a movement u (3, m, 3); none at rest."""
    squared = np.sum(u[0] * u[0], axis=1)[:, None]
    kappa = np.cross(u[0], u[1]) / squared
    change = np.cross(u[0], u[2]) / squared - 2.0 * np.sum(u[0] * u[1], axis=1)[:, None] / squared * kappa
    in_B = (np.nan_to_num(np.einsum("nji,nj->ni", R, vector)) for vector in (kappa, change))
    return Attitude(R, *in_B)


@kernel
def _sweep(
    half: Array, inset: Array, pole: Integers, rate: Array, first: Array, last: Array, R: Array,
    sign: Array, roll: Array, R_first: Array, R_last: Array,
) -> None:  # fmt: skip
    """Carry R through the cells in order."""
    x = np.empty(3)
    for c in range(half.shape[0]):
        sign[c], roll[c] = 1.0, 0.0
        if pole[c] >= 0:
            along = R[0, 0] * first[c, 0] + R[1, 0] * first[c, 1] + R[2, 0] * first[c, 2]
            sign[c] = -1.0 if along < 0.0 else 1.0
            _unit(first[c], sign[c], x)
            _turn_onto(R, x)
            # The roll at the start itself; both ends are looked at a little inside.
            edge = inset[c] / half[c] - 1.0
            roll[c] = _roll_of(R, pole[c]) + sign[c] * half[c] * _antiderivative(rate[c], edge)
        R_first[c] = R
        if pole[c] >= 0:
            _unit(last[c], sign[c], x)
            _place(R, x, pole[c], roll[c] - sign[c] * half[c] * _antiderivative(rate[c], -edge))
        R_last[c] = R


@kernel
def _roll_along(
    t: Array, series: Array, cell: Integers, sign: Array, left: Array, right: Array, pole: Integers,
    rate: Array, roll: Array, R_first: Array, Q: Array, R: Array, omega: Array, alpha: Array,
) -> None:  # fmt: skip
    x, body = np.empty(3), np.empty((3, 3))
    for k in range(t.shape[0]):
        c = cell[k]
        u, du, ddu = series[0, k], series[1, k], series[2, k]
        squared = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
        if pole[c] < 0 or not squared > 0.0:
            _times(R_first[c], Q, R[k])
            omega[k], alpha[k] = 0.0, 0.0
            continue
        _unit(u, sign[k], x)
        half = 0.5 * (right[c] - left[c])
        twist = half * _antiderivative(rate[c], min((t[k] - left[c]) / half - 1.0, 1.0))
        _place(body, x, pole[c], roll[c] - sign[k] * twist)
        _times(body, Q, R[k])
        _rates(u, du, ddu, squared, R[k], omega[k], alpha[k])


@kernel
def _rates(u: Array, du: Array, ddu: Array, squared: float, R: Array, omega: Array, alpha: Array) -> None:
    """kappa = u x u' / |u|^2 and its derivative, in B; d/dt (R^T kappa) = R^T kappa', as R turns with it."""
    slow = 2.0 * (u[0] * du[0] + u[1] * du[1] + u[2] * du[2]) / squared
    kx, ky, kz = (
        (u[1] * du[2] - u[2] * du[1]) / squared,
        (u[2] * du[0] - u[0] * du[2]) / squared,
        (u[0] * du[1] - u[1] * du[0]) / squared,
    )
    cx = (u[1] * ddu[2] - u[2] * ddu[1]) / squared - slow * kx
    cy = (u[2] * ddu[0] - u[0] * ddu[2]) / squared - slow * ky
    cz = (u[0] * ddu[1] - u[1] * ddu[0]) / squared - slow * kz
    # By definition there is nothing about x.
    omega[0], alpha[0] = 0.0, 0.0
    for i in range(1, 3):
        omega[i] = R[0, i] * kx + R[1, i] * ky + R[2, i] * kz
        alpha[i] = R[0, i] * cx + R[1, i] * cy + R[2, i] * cz


@kernel
def _unit(v: Array, sign: float, out: Array) -> None:
    scale = sign / np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    out[0], out[1], out[2] = scale * v[0], scale * v[1], scale * v[2]


@kernel
def _times(A: Array, B: Array, out: Array) -> None:
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@kernel
def _antiderivative(coefficients: Array, x: float) -> float:
    """Integral from -1 to x of a Legendre series: that of P_k is (P_k+1 - P_k-1) / (2 k + 1)."""
    total: float = coefficients[0] * (x + 1.0)
    below, here = 1.0, x
    for k in range(1, coefficients.shape[0]):
        above = ((2 * k + 1) * x * here - k * below) / (k + 1)
        total += coefficients[k] * (above - below) / (2 * k + 1)
        below, here = here, above
    return total


@kernel
def _pole_frame(x: Array, pole: int, frame: Array) -> None:
    """Columns x, y = e x x / |e x x|, z = x x y for the axis e number `pole`."""
    i, j = (pole + 1) % 3, (pole + 2) % 3
    size = np.sqrt(x[i] * x[i] + x[j] * x[j])
    frame[0, 0], frame[1, 0], frame[2, 0] = x[0], x[1], x[2]
    frame[pole, 1], frame[i, 1], frame[j, 1] = 0.0, -x[j] / size, x[i] / size
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        frame[k, 2] = x[m] * frame[n, 1] - x[n] * frame[m, 1]


@kernel
def _place(out: Array, x: Array, pole: int, roll: float) -> None:
    """The pole's frame along x, rolled."""
    _pole_frame(x, pole, out)
    c, s = np.cos(roll), np.sin(roll)
    for k in range(3):
        y, z = out[k, 1], out[k, 2]
        out[k, 1], out[k, 2] = c * y + s * z, c * z - s * y


@kernel
def _roll_of(R: Array, pole: int) -> float:
    frame = np.empty((3, 3))
    _pole_frame(R[:, 0], pole, frame)
    y = R[0, 1] * frame[0, 1] + R[1, 1] * frame[1, 1] + R[2, 1] * frame[2, 1]
    z = R[0, 1] * frame[0, 2] + R[1, 1] * frame[1, 2] + R[2, 1] * frame[2, 2]
    return math.atan2(z, y)


@kernel
def _turn_onto(R: Array, x: Array) -> None:
    """Turn R by the smallest angle, at most a right one, that brings its first column onto unit vector x."""
    cosine = R[0, 0] * x[0] + R[1, 0] * x[1] + R[2, 0] * x[2]
    wx, wy, wz = (
        R[1, 0] * x[2] - R[2, 0] * x[1],
        R[2, 0] * x[0] - R[0, 0] * x[2],
        R[0, 0] * x[1] - R[1, 0] * x[0],
    )
    for k in range(3):
        a, b, c = R[0, k], R[1, k], R[2, k]
        dot = (wx * a + wy * b + wz * c) / (1.0 + cosine)
        R[0, k] = cosine * a + wy * c - wz * b + dot * wx
        R[1, k] = cosine * b + wz * a - wx * c + dot * wy
        R[2, k] = cosine * c + wx * b - wy * a + dot * wz
