"""Turns rates and specific forces along a step into the turn, velocity and position it adds.

Attitude, velocity and position together solve one linear equation, X' = X A(t), with

        | C  V  P |             | omega x   f   0 |
    X = | 0  1  t |     A(t) =  |    0      0   1 |
        | 0  0  1 |             |    0      0   0 |

so that one exponential of a Magnus series carries coning, sculling and their counterpart in position to the same
order: the sixth, from values at three Gauss points of the step. Constant omega and f are exact at any step.
Source: Blanes, Casas, Oteo, Ros 2009, Physics Reports 470, the method of order six on Gauss points, transposed.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]

GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
"""The three Gauss points of a step, as shares of it."""

# Below this angle (rad) series replace the closed forms of the coefficients: the first term neglected is 4e-16
# of the leading one there, and the closed forms lose three digits of what enters multiplied by the angle.
SERIES_BELOW = 0.2

# An element of the algebra is a row (phi, nu, rho, s): the matrix [[phi x, nu, rho], [0, 0, s], [0, 0, 0]].
_S = 9


def increments(step: Array, values: Array) -> tuple[Array, Array, Array]:
    """dtheta rad, dv m/s, dp m, each (n, 3), over steps (n,) s from values (n, 3, 6) at their Gauss points.

    values: gyro rad/s and specific force m/s^2. With gravity left out, in the axes at the start of the step:
    dtheta = Log(R0^T R1), dv = R0^T (v1 - v0), dp = R0^T (p1 - p0 - v0 step).
    """
    out = np.empty((len(step), 9))
    _increments(argument(step), argument(values), out)
    return out[:, 0:3], out[:, 3:6], out[:, 6:9]


@kernel
def _increments(step: Array, values: Array, out: Array) -> None:
    a1, a2, a3, c1, c2, c3 = np.zeros((6, 10))
    for k in range(step.shape[0]):
        h = step[k]
        for i in range(6):
            x0, x1, x2 = values[k, 0, i], values[k, 1, i], values[k, 2, i]
            a1[i] = h * x1
            a2[i] = h * np.sqrt(15.0) / 3.0 * (x2 - x0)
            a3[i] = h * 10.0 / 3.0 * (x2 - 2.0 * x1 + x0)
        a1[_S] = h
        _bracket(a1, a2, c1)
        for i in range(10):
            c3[i] = 2.0 * a3[i] + c1[i]
        _bracket(a1, c3, c2)
        for i in range(10):
            c2[i] = a2[i] - c2[i] / 60.0
            c3[i] = -20.0 * a1[i] - a3[i] + c1[i]
        _bracket(c3, c2, c1)
        for i in range(10):
            c1[i] = a1[i] + a3[i] / 12.0 + c1[i] / 240.0
        _exponential(c1, out[k])


@kernel
def _bracket(a: Array, b: Array, out: Array) -> None:
    """B A - A B, as X stands left of A(t)."""
    out[_S] = 0.0
    for i in range(3):
        j, l = (i + 1) % 3, (i + 2) % 3
        out[i] = b[j] * a[l] - b[l] * a[j]
        out[3 + i] = b[j] * a[3 + l] - b[l] * a[3 + j] - a[j] * b[3 + l] + a[l] * b[3 + j]
        out[6 + i] = (
            b[j] * a[6 + l] - b[l] * a[6 + j] - a[j] * b[6 + l] + a[l] * b[6 + j]
            + b[3 + i] * a[_S] - a[3 + i] * b[_S]
        )  # fmt: skip


@kernel
def _exponential(x: Array, out: Array) -> None:
    """phi, V and P of exp(x): V = J1 nu and P = J1 rho + s J2 nu with Jk = sum over n of (phi x)^n / (n + k)!."""
    squared = x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
    b, c, d = _coefficients(squared)
    for i in range(3):
        j, l = (i + 1) % 3, (i + 2) % 3
        out[i] = x[i]
        nu_1 = x[j] * x[3 + l] - x[l] * x[3 + j]
        rho_1 = x[j] * x[6 + l] - x[l] * x[6 + j]
        # phi x (phi x y) = phi (phi . y) - phi^2 y
        nu_2 = x[i] * (x[0] * x[3] + x[1] * x[4] + x[2] * x[5]) - squared * x[3 + i]
        rho_2 = x[i] * (x[0] * x[6] + x[1] * x[7] + x[2] * x[8]) - squared * x[6 + i]
        out[3 + i] = x[3 + i] + b * nu_1 + c * nu_2
        out[6 + i] = x[6 + i] + b * rho_1 + c * rho_2 + x[_S] * (0.5 * x[3 + i] + c * nu_1 + d * nu_2)


@kernel
def _coefficients(squared: float) -> tuple[float, float, float]:
    """(1 - cos a) / a^2, (a - sin a) / a^3 and (a^2 / 2 - 1 + cos a) / a^4 for a^2 = squared."""
    if squared < SERIES_BELOW * SERIES_BELOW:
        return _series(squared, 2.0) / 2.0, _series(squared, 3.0) / 6.0, _series(squared, 4.0) / 24.0
    angle = np.sqrt(squared)
    half = np.sin(0.5 * angle) / angle
    b = 2.0 * half * half
    return b, (angle - np.sin(angle)) / (squared * angle), (0.5 - b) / squared


@kernel
def _series(squared: float, m: float) -> float:
    """m! times the sum over k < 5 of (-squared)^k / (m + 2 k)!, innermost term first."""
    total = 1.0
    for k in range(4, 0, -1):
        total = 1.0 - squared / ((m + 2.0 * k - 1.0) * (m + 2.0 * k)) * total
    return total
