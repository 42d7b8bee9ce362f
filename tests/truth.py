"""Turns case A or B and time stamps into what a perfect IMU reads, by 50-digit arithmetic.

Written to share nothing with the package: no equation (9), no Euler rates. The place of the IMU,
p + R r, and the columns of R are truncated power series in time with mpmath coefficients; the accelerometer
is R^T times the second derivative of that place minus gravity, the gyro is read off R^T dR/dt.

Case A: loop of the document's figure 1, f = 1 Hz, body along the path.
Case B: the same positions, phi = (0.8 cos 2 pi t, 0.8 sin 2 pi t, 0.3 cos 2 pi t).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Series = list[Any]  # Taylor coefficients in mpmath numbers, lowest first

LEVER_ARM = (-0.075, -0.075, 0.025)  # m, p_BS of both cases
GRAVITY = 9.80665
ORDER = 3  # Taylor coefficients kept after differentiating once: value to second derivative
DIGITS = 50


class Truth(NamedTuple):
    """Exact values rounded to float64; frames and units as in the package."""

    t: Array  # (n,) s
    gyro: Array  # (n, 3) rad/s
    accel: Array  # (n, 3) m/s^2, specific force at the IMU
    p_NB: Array  # (n, 3) m
    v_NB: Array  # (n, 3) m/s
    a_NB: Array  # (n, 3) m/s^2
    R_NB: Array  # (n, 3, 3)
    omega_NB_B: Array  # (n, 3) rad/s
    alpha_NB_B: Array  # (n, 3) rad/s^2


def truth(case: str, t: Array) -> Truth:
    """Truth of `case` ("A" or "B") at times t (n,); about 2 ms a sample, remembered for the session."""
    rows = [_row(case, float(time)) for time in t]
    columns = [np.array([row[k] for row in rows]) for k in range(len(rows[0]))]
    return Truth(np.asarray(t, dtype=np.float64), *columns)


@lru_cache(maxsize=8192)
def _row(case: str, t: float) -> tuple[Any, ...]:
    with mpmath.workdps(DIGITS):
        position = _position(t)
        velocity = [_derivative(x) for x in position]
        R = _tangent_frame(velocity) if case == "A" else _euler_matrix(_angles(t))
        place = [
            _add(x[:ORDER], *[_scale(R[i][k], mpmath.mpf(LEVER_ARM[k])) for k in range(3)])
            for i, x in enumerate(position)
        ]
        R0, R1, R2 = (
            [[factor * R[i][k][d] for k in range(3)] for i in range(3)]
            for d, factor in ((0, 1), (1, 1), (2, 2))
        )
        omega = _vee(_transposed_times(R0, R1))
        # d/dt (R^T R') = R^T R'' + R'^T R'; the second term is symmetric and leaves the vee alone.
        alpha = _vee(_transposed_times(R0, R2))
        push = [2 * x[2] for x in place]
        push[2] += mpmath.mpf(GRAVITY)
        accel = [sum(R0[i][k] * push[i] for i in range(3)) for k in range(3)]
        vectors = (omega, accel, *([f * x[d] for x in position] for d, f in ((0, 1), (1, 1), (2, 2))))
        floats = [np.array([float(x) for x in vector]) for vector in vectors]
        matrix = np.array([[float(x) for x in row] for row in R0])
        return (*floats, matrix, floats[0], np.array([float(x) for x in alpha]))


def _wave(t: float, amplitude: float, harmonic: int, shift: int) -> Series:
    """Taylor coefficients at t of amplitude cos(2 pi harmonic t - shift pi / 2)."""
    w = 2 * mpmath.pi * harmonic
    return [
        mpmath.mpf(amplitude)
        * w**k
        * mpmath.cos(w * mpmath.mpf(t) + (k - shift) * mpmath.pi / 2)
        / mpmath.factorial(k)
        for k in range(ORDER + 1)
    ]


def _position(t: float) -> list[Series]:
    return [_wave(t, 0.8, 1, 0), _wave(t, 0.8, 1, 1), _wave(t, 0.3, 3, 0)]


def _angles(t: float) -> list[Series]:
    return [_wave(t, 0.8, 1, 0)[:ORDER], _wave(t, 0.8, 1, 1)[:ORDER], _wave(t, 0.3, 1, 0)[:ORDER]]


def _tangent_frame(v: Sequence[Series]) -> list[list[Series]]:
    """Columns x = v / abs(v), y level, z = x cross y, as a matrix of series."""
    level = _reciprocal_root(_add(_multiply(v[0], v[0]), _multiply(v[1], v[1])))
    whole = _reciprocal_root(_add(*[_multiply(c, c) for c in v]))
    x = [_multiply(c, whole) for c in v]
    y = [_scale(_multiply(v[1], level), -1), _multiply(v[0], level), [mpmath.mpf(0)] * ORDER]
    z = [
        _add(_multiply(x[(i + 1) % 3], y[(i + 2) % 3]), _scale(_multiply(x[(i + 2) % 3], y[(i + 1) % 3]), -1))
        for i in range(3)
    ]
    return [[x[i], y[i], z[i]] for i in range(3)]


def _euler_matrix(phi: Sequence[Series]) -> list[list[Series]]:
    """Rz Ry Rx as a product of three matrices of series."""
    one, zero = [mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0)], [mpmath.mpf(0)] * ORDER
    (cx, sx), (cy, sy), (cz, sz) = (_cos_sin(angle) for angle in phi)
    Rx = [[one, zero, zero], [zero, cx, _scale(sx, -1)], [zero, sx, cx]]
    Ry = [[cy, zero, sy], [zero, one, zero], [_scale(sy, -1), zero, cy]]
    Rz = [[cz, _scale(sz, -1), zero], [sz, cz, zero], [zero, zero, one]]
    return _matrix_product(_matrix_product(Rz, Ry), Rx)


def _cos_sin(x: Series) -> tuple[Series, Series]:
    c, s = mpmath.cos(x[0]), mpmath.sin(x[0])
    return [c, -s * x[1], -s * x[2] - c * x[1] ** 2 / 2], [s, c * x[1], c * x[2] - s * x[1] ** 2 / 2]


def _reciprocal_root(x: Series) -> Series:
    """x ** (-1/2), from the binomial series around its first coefficient."""
    lead, p, q = 1 / mpmath.sqrt(x[0]), x[1] / x[0], x[2] / x[0]
    return [lead, -lead * p / 2, lead * (3 * p**2 / 8 - q / 2)]


def _derivative(x: Series) -> Series:
    return [(k + 1) * x[k + 1] for k in range(ORDER)]


def _add(*terms: Series) -> Series:
    return [sum(coefficients) for coefficients in zip(*terms, strict=True)]


def _scale(x: Series, factor: Any) -> Series:
    return [factor * c for c in x]


def _multiply(x: Series, y: Series) -> Series:
    return [sum(x[i] * y[k - i] for i in range(k + 1)) for k in range(ORDER)]


def _matrix_product(A: list[list[Series]], B: list[list[Series]]) -> list[list[Series]]:
    return [[_add(*[_multiply(A[i][k], B[k][j]) for k in range(3)]) for j in range(3)] for i in range(3)]


def _transposed_times(A: list[list[Any]], B: list[list[Any]]) -> list[list[Any]]:
    return [[sum(A[k][i] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def _vee(A: list[list[Any]]) -> list[Any]:
    return [(A[2][1] - A[1][2]) / 2, (A[0][2] - A[2][0]) / 2, (A[1][0] - A[0][1]) / 2]
