"""Turns a path known from samples into the attitude of a body carried along it without twisting about it.

The twin of `transport` for signals whose small derivatives are noise: under a floor of speed the body
keeps its attitude, and goes on with the smallest turn that brings its x axis back into line, nose or tail first.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.derivatives import Signal
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.kernels import argument, kernel
from kreisel.maths.rotations import matrix_from_euler

Array = npt.NDArray[np.float64]

# Steps per sample: with 0.1 rad of turn a sample, 1e-7 rad are lost over a thousand samples.
_STEPS = 4

# The two points of Gauss and Legendre in a step of length one.
_GAUSS = 0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0


def carried_along(position: Signal, samples: Array, floor: float, t: Array) -> Attitude:
    """Attitude at times t (n,) of a body carried along `position`, level where it first moves.

    samples: (m,) s, the sample times of the path; floor: m/s, speed under which it is taken to rest.
    The axes turn with kappa = v x a / |v|^2, the rate without a component along the path, integrated by
    Magnus' series to fourth order (Iserles and Norsett 1999).
    """
    nodes = np.interp(np.arange((len(samples) - 1) * _STEPS + 1) / _STEPS, np.arange(len(samples)), samples)
    v = position(nodes, 1)[1]
    turns = _turns(position, nodes[:-1], nodes[1:], floor)
    R_nodes = np.empty((len(nodes), 3, 3))
    _carry(argument(v), argument(turns), floor, argument(_level_start(v, floor)), R_nodes)
    return _at(position, t, nodes, R_nodes, floor)


def _at(position: Signal, t: Array, nodes: Array, R_nodes: Array, floor: float) -> Attitude:
    """Attitude at times t, each one step from the node before it."""
    k = np.clip(np.searchsorted(nodes, t, side="right") - 1, 0, len(nodes) - 1)
    _, v, a, j = position(t, 3)
    R = np.ascontiguousarray(R_nodes[k])
    _step_each(argument(v), argument(_turns(position, nodes[k], t, floor)), floor, R)
    kappa, dkappa = _rate(v, a, floor), _rate(v, j, floor)
    square = np.maximum(np.sum(v * v, axis=1), floor**2)
    dkappa -= 2.0 * kappa * (np.sum(v * a, axis=1) / square)[:, None]
    omega, alpha = (np.einsum("nji,nj->ni", R, vector) for vector in (kappa, dkappa))
    # Zero by construction; what is left is round-off of the projection.
    omega[:, 0] = alpha[:, 0] = 0.0
    return Attitude(R, omega, alpha)


def _turns(position: Signal, start: Array, stop: Array, floor: float) -> Array:
    """Rotation vectors (n, 3) in N over the steps from `start` to `stop`."""
    h = (stop - start)[:, None]
    first, second = (_kappa(position, start + c * (stop - start), floor) for c in _GAUSS)
    return np.asarray(0.5 * h * (first + second) + np.sqrt(3.0) / 12.0 * h * h * np.cross(second, first))


def _kappa(position: Signal, t: Array, floor: float) -> Array:
    _, v, a = position(t, 2)
    return _rate(v, a, floor)


def _rate(v: Array, a: Array, floor: float) -> Array:
    """v x a / |v|^2 (n, 3), zero at rest."""
    square = np.sum(v * v, axis=1)
    moving = square > floor**2
    return np.asarray(np.cross(v, a) * np.where(moving, 1.0 / np.where(moving, square, 1.0), 0.0)[:, None])


def _level_start(v: Array, floor: float) -> Array:
    """Level attitude (3, 3) with the nose along the first movement; north-east-up axes where there is none."""
    moving = np.flatnonzero(np.sum(v * v, axis=1) > floor**2)
    if not moving.size:
        return np.eye(3)
    x, y, z = v[moving[0]]
    return matrix_from_euler(np.array([0.0, -np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)]))


@kernel
def _carry(v: Array, turns: Array, floor: float, R_start: Array, R_nodes: Array) -> None:
    R_nodes[0] = R_start
    for k in range(turns.shape[0]):
        R_nodes[k + 1] = R_nodes[k]
        _turn(turns[k, 0], turns[k, 1], turns[k, 2], R_nodes[k + 1])
        _line_up(v[k + 1, 0], v[k + 1, 1], v[k + 1, 2], floor, R_nodes[k + 1])


@kernel
def _step_each(v: Array, turns: Array, floor: float, R: Array) -> None:
    for k in range(turns.shape[0]):
        _turn(turns[k, 0], turns[k, 1], turns[k, 2], R[k])
        _line_up(v[k, 0], v[k, 1], v[k, 2], floor, R[k])


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
def _line_up(x: float, y: float, z: float, floor: float, R: Array) -> None:
    """Turn R by the smallest angle that lays its first column along (x, y, z) or against it."""
    size = np.sqrt(x * x + y * y + z * z)
    if size <= floor or size == 0.0:
        return
    if x * R[0, 0] + y * R[1, 0] + z * R[2, 0] < 0.0:
        size = -size
    x, y, z = x / size, y / size, z / size
    # Axis times sine of the angle between them; at most a right angle, as the nearer of nose and tail was taken.
    a, b, c = R[1, 0] * z - R[2, 0] * y, R[2, 0] * x - R[0, 0] * z, R[0, 0] * y - R[1, 0] * x
    sine = np.sqrt(a * a + b * b + c * c)
    if sine > 0.0:
        angle = np.arctan2(sine, x * R[0, 0] + y * R[1, 0] + z * R[2, 0])
        _turn(a * angle / sine, b * angle / sine, c * angle / sine, R)
