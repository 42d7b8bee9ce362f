"""Turns samples into attitude as document 002 has it, line by line: I north, J west, K up, all as seen from the device.

Written from the document alone, in plain numbers, to share nothing with the kernels.
"""

import math

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Vector = list[float]
Rows = tuple[Vector, Vector, Vector]


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def plus(a: Vector, b: Vector) -> Vector:
    return [x + y for x, y in zip(a, b, strict=True)]


def times(k: float, a: Vector) -> Vector:
    return [k * x for x in a]


def normalised(a: Vector) -> Vector:
    return times(1.0 / math.sqrt(dot(a, a)), a)


def minus(a: Vector, b: Vector) -> Vector:
    return plus(a, times(-1.0, b))


def published_step(
    DCM_B: Rows, gyro: Vector, accel: Vector, mag: Vector, dt: float, weights: tuple[float, float, float]
) -> Rows:
    """The rows I_B1, J_B1, K_B1 that follow those of DCM_B; a magnetometer without a sample is NaN."""
    s_g, s_a, s_m = weights
    I_B0, J_B0, K_B0 = DCM_B
    w = times(-1.0, gyro)
    dtheta_g = times(dt, w)
    K_B1A = normalised(accel)
    dtheta_a = cross(K_B0, minus(K_B1A, K_B0))
    if math.isnan(mag[0]):
        dtheta_m, s_m = [0.0, 0.0, 0.0], 0.0
    else:
        I_B1M = normalised(minus(mag, times(dot(K_B0, mag), K_B0)))
        dtheta_m = cross(I_B0, minus(I_B1M, I_B0))
    total = plus(plus(times(s_a, dtheta_a), times(s_g, dtheta_g)), times(s_m, dtheta_m))
    dtheta = times(1.0 / (s_a + s_g + s_m), total)
    I_B1 = plus(I_B0, cross(dtheta, I_B0))
    J_B1 = plus(J_B0, cross(dtheta, J_B0))
    Err = dot(I_B1, J_B1) / 2.0
    I_B1, J_B1 = minus(I_B1, times(Err, J_B1)), minus(J_B1, times(Err, I_B1))
    I_B1, J_B1 = normalised(I_B1), normalised(J_B1)
    return I_B1, J_B1, cross(I_B1, J_B1)


def first_attitude(accel: Vector, mag: Vector) -> Rows:
    """The rows I, J, K from gravity and field alone."""
    K = normalised(accel)
    I = normalised(minus(mag, times(dot(K, mag), K)))
    return I, cross(K, I), K


def enu(DCM_B: Rows) -> Array:
    """R_NS, whose rows are east = -J, north = I, up = K."""
    I, J, K = DCM_B
    return np.array([times(-1.0, J), I, K])


def ijk(R_NS: Array) -> Rows:
    """The rows I = north, J = -east, K = up."""
    return R_NS[1].tolist(), (-R_NS[0]).tolist(), R_NS[2].tolist()
