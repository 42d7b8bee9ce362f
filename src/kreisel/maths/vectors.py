"""Turns tuples of three floats into others: the vector algebra that kernels inline, faster than on small arrays."""

import math

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import fused, inlined

Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]
Rows = tuple[Vector, Vector, Vector]

NONE: Vector = (0.0, 0.0, 0.0)


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """a x b"""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def dot(a: Vector, b: Vector) -> float:
    """a . b"""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def scaled(k: float, a: Vector) -> Vector:
    """k a"""
    return k * a[0], k * a[1], k * a[2]


@inlined
def added(a: Vector, k: float, b: Vector) -> Vector:
    """a + k b"""
    return a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]


@inlined
def combined(k: Vector, a: Vector, b: Vector, c: Vector) -> Vector:
    """k[0] a + k[1] b + k[2] c"""
    return (
        k[0] * a[0] + k[1] * b[0] + k[2] * c[0],
        k[0] * a[1] + k[1] * b[1] + k[2] * c[1],
        k[0] * a[2] + k[1] * b[2] + k[2] * c[2],
    )


@inlined
def norm(a: Vector) -> float:
    """abs(a), and zero where its square is not finite or so small or large that it is no measurement."""
    n2 = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
    return math.sqrt(n2) if 1e-60 < n2 < 1e60 else 0.0


@inlined
def unit(a: Vector) -> Vector:
    """`a` over its norm; zero where it has none."""
    n = norm(a)
    return scaled(1.0 / n, a) if n > 0.0 else NONE


@inlined
def inverse_root_near_one(e: float, near: bool = False) -> float:
    """1 / sqrt(1 + e), in half the time where 1 + e is the squared norm of what was a unit vector a step ago.

    near : the caller knows that abs(e) <= 1e-3.
    """
    if not near and abs(e) > 1e-3:
        return 1.0 / math.sqrt(1.0 + e)
    # The next term, 231/1024 e^6, is below 3e-19. In this order the longest chain of operations is the shortest.
    e2 = e * e
    low = fused(e2, fused(-0.3125, e, 0.375), fused(-0.5, e, 1.0))
    return fused(e2 * e2, fused(-0.24609375, e, 0.2734375), low)


@inlined
def nearest_rotation(rows: Rows, c: float, near: bool = False) -> Rows:
    """The rotation nearest to rows x, y, x cross y, of unit vectors x and y whose product c is small.

    Seen from halfway between them both give up as much: x + y and x - y are at right angles whatever x and y are.
    near : the caller knows that abs(c) < 1e-8.
    """
    x, y, z = rows
    if abs(c) < 1e-13:
        return rows
    if near or abs(c) < 1e-8:
        return added(x, -0.5 * c, y), added(y, -0.5 * c, x), z
    of_sum, of_difference = 1.0 / math.sqrt(1.0 + c), 1.0 / math.sqrt(1.0 - c)
    a, b, k = 0.5 * (of_difference + of_sum), 0.5 * (of_difference - of_sum), of_sum * of_difference
    return added(scaled(a, x), -b, y), added(scaled(a, y), -b, x), scaled(k, z)


@inlined
def exp_factors(a2: float, near: bool = False) -> tuple[float, float]:
    """sin(a) / a and (1 - cos(a)) / a^2 from a^2, with which Exp(v) = 1 + s [v]x + c [v]x^2 for abs(v) = a.

    near : the caller knows that a^2 is below 0.01.
    """
    if near or a2 < 0.01:
        # The next terms, a^10 / 11! and a^10 / 12!, are below 3e-18.
        s = 1.0 + a2 * (-1.0 / 6.0 + a2 * (1.0 / 120.0 + a2 * (-1.0 / 5040.0 + a2 * (1.0 / 362880.0))))
        c = 0.5 + a2 * (-1.0 / 24.0 + a2 * (1.0 / 720.0 + a2 * (-1.0 / 40320.0 + a2 * (1.0 / 3628800.0))))
        return s, c
    a = math.sqrt(a2)
    # Half-angle form: 1 - cos(a) loses digits where a is small.
    half = math.sin(0.5 * a) / a
    return math.sin(a) / a, 2.0 * half * half


@inlined
def rotated(dtheta: Vector, r: Vector) -> Vector:
    """Exp(dtheta) r"""
    s, c = exp_factors(dot(dtheta, dtheta))
    first = cross(dtheta, r)
    return added(added(r, s, first), c, cross(dtheta, first))


@inlined
def load(a: Array, i: int) -> Vector:
    """The three numbers at place i."""
    return a[i], a[i + 1], a[i + 2]


@inlined
def store(a: Array, i: int, v: Vector) -> None:
    """Put `v` at place i."""
    a[i] = v[0]
    a[i + 1] = v[1]
    a[i + 2] = v[2]
