"""Turns observed directions into attitude: vertical and north into a matrix, two vectors into another.

The formulas are those of document 002, whose global frame is I north, J west, K up; here N is east, north,
up, so that east = -J, north = I, up = K. Leading axes are free: ``(3,)``, ``(n, 3)`` and ``(runs, n, 3)`` all
work, and inputs broadcast. Where the input has no answer (a vector that is zero, NaN or infinite, two that
are parallel) the row of the answer is NaN.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# Sine of the angle between two unit vectors below which they count as parallel: half of all digits of their
# common normal are round-off there.
PARALLEL = 1e-8

# cos 2.6 deg: where x_S stands nearer to the vertical than that, y_S tells the heading instead.
VERTICAL = 0.999


def unit(v: Array) -> Array:
    """`v` (..., 3) over its length, whatever its unit; NaN where it is zero, NaN or infinite."""
    v = _vectors("v", v)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Divided by the largest component first, so that no square overflows or vanishes.
        scaled = v / np.abs(v).max(axis=-1, keepdims=True)
        return np.asarray(scaled / np.linalg.norm(scaled, axis=-1, keepdims=True))


def perpendicular(b: Array, a: Array) -> Array:
    """Unit vector (..., 3) along b - a (a.b): `b` corrected where `a`, a unit vector, is taken as right.

    Source: document 002, the orthonormalisation that keeps one vector.
    """
    a, b = _vectors("a", a), unit(b)
    rest = b - a * _dot(a, b)
    return unit(np.where(np.linalg.norm(rest, axis=-1, keepdims=True) > PARALLEL, rest, np.nan))


def orthonormal_by_half(I: Array, J: Array) -> tuple[Array, Array, Array]:
    """I, J, K (..., 3 each) from nearly perpendicular unit vectors, each moved by half of the error.

    Err = (I.J) / 2, I' = I - Err J, J' = J - Err I, both normalised, K = I' x J'. One pass leaves
    I'.J' = (I.J)^3 / 4: round-off where I.J is below 1e-5.
    Source: document 002, the orthonormalisation by half.
    """
    I, J = _vectors("I", I), _vectors("J", J)
    half = 0.5 * _dot(I, J)
    I, J = unit(I - half * J), unit(J - half * I)
    return I, J, np.cross(I, J)


def orthonormal_keeping(I: Array, J: Array) -> tuple[Array, Array, Array]:
    """I, J, K (..., 3 each) from unit vectors, I kept as it is and J made perpendicular to it; K = I x J'.

    The one-sided twin of `orthonormal_by_half`, exact after one pass. (J, K) or (K, I) in place of (I, J)
    keeps another axis.
    """
    I = _vectors("I", I)
    J = perpendicular(J, I)
    I = np.broadcast_to(I, J.shape)
    return I, J, np.cross(I, J)


def rate_of_vector(r: Array, v: Array) -> Array:
    """Angular velocity w (..., 3) = r x v / |r|^2 of a rotating vector r with velocity v.

    The part of w along r moves nothing and is not in it. Unit: that of v over that of r; NaN where r is zero.
    Source: document 002, eq. (2.5).
    """
    r, v = _vectors("r", r), _vectors("v", v)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.cross(r, v) / _dot(r, r))


def velocity_of_vector(w: Array, r: Array) -> Array:
    """Velocity v (..., 3) = w x r of a vector r that rotates with w. Source: document 002, eq. (2.6)."""
    return np.asarray(np.cross(_vectors("w", w), _vectors("r", r)))


def matrix_from_columns(x: Array, y: Array, z: Array) -> Array:
    """R_NB (..., 3, 3), the document's DCM_G: the body axes x, y, z (..., 3 each) seen from N, as columns.

    Source: document 002, eq. (1.1).
    """
    axes = np.broadcast_arrays(_vectors("x", x), _vectors("y", y), _vectors("z", z))
    return np.stack(axes, axis=-1)


def matrix_from_rows(x: Array, y: Array, z: Array) -> Array:
    """R_NB (..., 3, 3) from the axes of N (east, north, up; ..., 3 each) seen from the body, as rows.

    Source: document 002, eq. (1.2) and (1.3), whose DCM_B has the body axes as columns: R_NB is its transpose
    where N has the document's axes.
    """
    return np.swapaxes(matrix_from_columns(x, y, z), -1, -2)


def matrix_from_north_west_up(I: Array, J: Array, K: Array) -> Array:
    """R_NB (..., 3, 3) from the document's I_B, J_B, K_B (..., 3 each): north, west, up in body axes."""
    return matrix_from_rows(-_vectors("J", J), I, K)


def to_global(R_NB: Array, v_B: Array) -> Array:
    """v_N (..., 3) = R_NB v_B. Source: document 002, eq. (1.4)."""
    return np.asarray(np.einsum("...ij,...j->...i", _matrices(R_NB), _vectors("v_B", v_B)))


def to_body(R_NB: Array, v_N: Array) -> Array:
    """v_B (..., 3) = R_NB^T v_N. Source: document 002, eq. (1.5)."""
    return np.asarray(np.einsum("...ji,...j->...i", _matrices(R_NB), _vectors("v_N", v_N)))


def tilt_from_accel(accel: Array) -> Array:
    """R_NS (..., 3, 3) with zero yaw that explains `accel` as gravity alone.

    accel : (..., 3) specific force in S, any norm but zero.
    The horizontal part of x_S points east. Undefined when x_S is vertical: within 2.6 deg of it y_S, north,
    replaces it as the heading axis.
    Source: Groves 2013, eq. 5.101 (there for a body with z down).
    """
    up = unit(accel)
    upright = np.abs(up[..., :1]) >= VERTICAL
    x_S, y_S = np.eye(3)[:2]
    north = perpendicular(np.where(upright, y_S, np.cross(up, x_S)), up)
    return matrix_from_rows(np.cross(north, up), north, up)


def attitude_from_accel_mag(accel: Array, mag: Array, *, declination: float = 0.0) -> Array:
    """R_NS (..., 3, 3) from specific force and magnetic field alone, without a gyro; the vertical is trusted.

    accel, mag : (..., 3) in S, any unit. declination : rad, of magnetic north east of true north; 0 takes
    magnetic north for north.
    K = accel / |accel|; mag, which dips into the ground, is made perpendicular to K and gives I; J = K x I.
    Source: document 002, with K = +f / |f| for its gravity vector.
    """
    K = unit(accel)
    magnetic = perpendicular(mag, K)
    I = np.cos(declination) * magnetic + np.sin(declination) * np.cross(K, magnetic)
    return matrix_from_north_west_up(I, np.cross(K, I), K)


def triad(trusted_S: Array, other_S: Array, trusted_N: Array, other_N: Array) -> Array:
    """R_NS (..., 3, 3) from two vectors known in S and in N; the first is met exactly, the other nearly.

    All (..., 3), any unit and length. With accelerometer and magnetometer either may be the trusted one:
    ``triad(accel, mag, up, field_N)`` or ``triad(mag, accel, field_N, up)``.
    Source: Black 1964; Shuster and Oh 1981, section on the TRIAD algorithm.
    """
    R_NF, R_SF = _frame(trusted_N, other_N), _frame(trusted_S, other_S)
    return np.asarray(R_NF @ np.swapaxes(R_SF, -1, -2))


def _frame(first: Array, second: Array) -> Array:
    x = unit(first)
    y = perpendicular(second, x)
    return matrix_from_columns(x, y, np.cross(x, y))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1, keepdims=True))


def _vectors(name: str, value: Any) -> Array:
    return _checked(name, np.asarray(value, dtype=np.float64), (3,))


def _matrices(R_NB: Any) -> Array:
    return _checked("R_NB", np.asarray(R_NB, dtype=np.float64), (3, 3))


def _checked(name: str, array: Array, tail: tuple[int, ...]) -> Array:
    if array.shape[-len(tail) :] != tail:
        hint = f" Did you mean {name}.T?" if array.ndim == 2 and array.T.shape[-len(tail) :] == tail else ""
        raise ValueError(f"{name} must be (..., {', '.join(map(str, tail))}); got {array.shape}.{hint}")
    return array
