"""Turns a path known from samples into the attitude of a body carried along it without twisting about it.

The twin of `transport` for signals whose small derivatives are noise: under a floor of speed the body
keeps its attitude, and goes on with the smallest turn that brings its x axis back into line, nose or tail first.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from kreisel.maths.derivatives import Signal
from kreisel.maths.following.course import JUMP, Slowness
from kreisel.maths.following.exact import Joints
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.rotations import matrix_from_euler

Array = npt.NDArray[np.float64]

# Steps per sample: with 0.1 rad of turn a sample, 1e-7 rad are lost over a thousand samples.
_STEPS = 4

# The two points of Gauss and Legendre in a step of length one.
_GAUSS = 0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0


class Carried:
    """A body carried along `position`, known from samples at `t` (n,) s, level where it first moves.

    floor: (n,) m/s, speed at the samples under which it is taken to rest.
    The axes turn with kappa = v x a / |v|^2, the rate without a component along the path, integrated by
    Magnus' series to fourth order (Iserles and Norsett 1999).
    """

    def __init__(self, position: Signal, t: Array, floor: Array) -> None:
        self._position, self._step = position, float(np.median(np.diff(t)))
        slow = Slowness(position, t, floor)
        self._rest = slow.stretches(slow.altogether)
        self.aimless = self._rest.everywhere
        nodes = np.interp(np.arange((len(t) - 1) * _STEPS + 1) / _STEPS, np.arange(len(t)), t)
        self._nodes = nodes = nodes if self.aimless else self._around(nodes)
        v = position(nodes, 1)[1]
        self._turns = _turns(position, nodes[:-1], nodes[1:])
        self._turns[self._rest.holding(nodes[:-1]) >= 0] = 0.0
        self._R, self._corrections = np.empty((len(nodes), 3, 3)), np.zeros(len(nodes))
        _carry(argument(v), argument(self._turns), argument(_level(v[0])), self._R, self._corrections)

    def _around(self, nodes: Array) -> Array:
        """Nodes outside the rests, and the ends of these."""
        ends = np.concatenate([self._rest.left, self._rest.right])
        return np.union1d(nodes[self._rest.holding(nodes) < 0], ends[np.isfinite(ends)])

    def attitude(self, t: Array) -> Attitude:
        """Attitude at increasing times t (n,), each one step from the node before it."""
        if self.aimless:
            return Attitude(np.tile(np.eye(3), (len(t), 1, 1)), np.zeros((len(t), 3)), np.zeros((len(t), 3)))
        when, _ = self._rest.moving(t)
        k = np.clip(np.searchsorted(self._nodes, when, side="right") - 1, 0, len(self._nodes) - 1)
        _, v, a, j = self._position(when, 3)
        R = np.ascontiguousarray(self._R[k])
        _step_each(argument(v), argument(_turns(self._position, self._nodes[k], when)), R)
        kappa, dkappa = _rate(v, a), _rate(v, j)
        square = np.maximum(np.sum(v * v, axis=1), 1e-300)
        dkappa -= 2.0 * kappa * (np.sum(v * a, axis=1) / square)[:, None]
        omega, alpha = (np.einsum("nji,nj->ni", R, vector) for vector in (kappa, dkappa))
        # Zero by construction; what is left is round-off of the projection.
        omega[:, 0] = alpha[:, 0] = 0.0
        out = Attitude(R, omega, alpha)
        self._rest.settle(out, t, self._step, self.attitude)
        return out

    def joints(self) -> Joints:
        """Where the body is brought back into line with a jump: after a rest, and where the path breaks."""
        k = np.flatnonzero(self._corrections > JUMP)
        after = self.attitude(self._nodes[k])
        R = np.ascontiguousarray(self._R[k - 1])
        _step_each(np.zeros((len(k), 3)), argument(self._turns[k - 1]), R)
        return Joints(self._nodes[k], Attitude(R, np.zeros((len(k), 3)), np.zeros((len(k), 3))), after)


def _turns(position: Signal, start: Array, stop: Array) -> Array:
    """Rotation vectors (n, 3) in N over the steps from `start` to `stop`."""
    h = (stop - start)[:, None]
    first, second = (_kappa(position, start + c * (stop - start)) for c in _GAUSS)
    return np.asarray(0.5 * h * (first + second) + np.sqrt(3.0) / 12.0 * h * h * np.cross(second, first))


def _kappa(position: Signal, t: Array) -> Array:
    _, v, a = position(t, 2)
    return _rate(v, a)


def _rate(v: Array, a: Array) -> Array:
    """v x a / |v|^2 (n, 3), zero where there is no velocity at all."""
    return np.asarray(np.cross(v, a) / np.maximum(np.sum(v * v, axis=1), 1e-300)[:, None])


def _level(v: Array) -> Array:
    """Level attitude (3, 3) with the nose along v."""
    x, y, z = v
    return matrix_from_euler(np.array([0.0, -np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)]))


@kernel
def _carry(v: Array, turns: Array, R_start: Array, R_nodes: Array, corrections: Array) -> None:
    R_nodes[0] = R_start
    for k in range(turns.shape[0]):
        R_nodes[k + 1] = R_nodes[k]
        _turn(turns[k, 0], turns[k, 1], turns[k, 2], R_nodes[k + 1])
        corrections[k + 1] = _line_up(v[k + 1, 0], v[k + 1, 1], v[k + 1, 2], R_nodes[k + 1])


@kernel
def _step_each(v: Array, turns: Array, R: Array) -> None:
    for k in range(turns.shape[0]):
        _turn(turns[k, 0], turns[k, 1], turns[k, 2], R[k])
        _line_up(v[k, 0], v[k, 1], v[k, 2], R[k])


@kernel
def _turn(x: float, y: float, z: float, R: Array) -> None:
    """R = Exp((x, y, z)) R, column by column, by Rodrigues' formula."""
    square = x * x + y * y + z * z
    angle = np.sqrt(square)
    if angle < 1e-4:
        # The next terms are angle^4 / 120 and angle^4 / 720 of these.
        sine, versine = 1.0 - square / 6.0, 0.5 - square / 24.0
    else:
        half = np.sin(0.5 * angle) / angle
        sine, versine = np.sin(angle) / angle, 2.0 * half * half
    for c in range(3):
        a, b, d = R[0, c], R[1, c], R[2, c]
        p, q, r = y * d - z * b, z * a - x * d, x * b - y * a
        R[0, c] = a + sine * p + versine * (y * r - z * q)
        R[1, c] = b + sine * q + versine * (z * p - x * r)
        R[2, c] = d + sine * r + versine * (x * q - y * p)


@kernel
def _line_up(x: float, y: float, z: float, R: Array) -> float:
    """Turn R by the smallest angle that lays its first column along (x, y, z) or against it; returns the angle."""
    size = np.sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return 0.0
    if x * R[0, 0] + y * R[1, 0] + z * R[2, 0] < 0.0:
        size = -size
    x, y, z = x / size, y / size, z / size
    # Axis times sine of the angle between them; at most a right angle, as the nearer of nose and tail was taken.
    a, b, c = R[1, 0] * z - R[2, 0] * y, R[2, 0] * x - R[0, 0] * z, R[0, 0] * y - R[1, 0] * x
    sine = np.sqrt(a * a + b * b + c * c)
    if sine == 0.0:
        return 0.0
    angle = math.atan2(sine, x * R[0, 0] + y * R[1, 0] + z * R[2, 0])
    _turn(a * angle / sine, b * angle / sine, c * angle / sine, R)
    return angle
