"""The equations of document 000 written down once more, sample by sample with plain Python numbers.

Shares nothing with the package: R is a product of the three matrices of eq. (2), its inverse is found by
elimination, gradients are lists.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, atan2, cos, sin, sqrt

import numpy as np

Vector = Sequence[float]
Matrix = list[list[float]]


def gradient(x: Vector, t: Vector) -> list[float]:
    """MATLAB's gradient(x, t)."""
    inside = [(x[k + 1] - x[k - 1]) / (t[k + 1] - t[k - 1]) for k in range(1, len(x) - 1)]
    return [(x[1] - x[0]) / (t[1] - t[0]), *inside, (x[-1] - x[-2]) / (t[-1] - t[-2])]


def gradients(rows: Sequence[Vector], t: Vector) -> list[list[float]]:
    columns = [gradient([row[i] for row in rows], t) for i in range(len(rows[0]))]
    return [list(row) for row in zip(*columns, strict=True)]


def product(A: Matrix, B: Matrix) -> Matrix:
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def inverse(A: Matrix) -> Matrix:
    """Gauss-Jordan with the largest pivot."""
    rows = [[*A[i], *[float(i == j) for j in range(3)]] for i in range(3)]
    for c in range(3):
        best = max(range(c, 3), key=lambda r: abs(rows[r][c]))
        rows[c], rows[best] = rows[best], rows[c]
        rows[c] = [x / rows[c][c] for x in rows[c]]
        for r in range(3):
            if r != c:
                rows[r] = [x - rows[r][c] * y for x, y in zip(rows[r], rows[c], strict=True)]
    return [row[3:] for row in rows]


def rotation(phi: Vector) -> Matrix:
    """Eq. (2)."""
    (x, y, z) = phi
    Rz = [[cos(z), -sin(z), 0.0], [sin(z), cos(z), 0.0], [0.0, 0.0, 1.0]]
    Ry = [[cos(y), 0.0, sin(y)], [0.0, 1.0, 0.0], [-sin(y), 0.0, cos(y)]]
    Rx = [[1.0, 0.0, 0.0], [0.0, cos(x), -sin(x)], [0.0, sin(x), cos(x)]]
    return product(product(Rz, Ry), Rx)


def my_lin(s: Sequence[Vector], t: Vector) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Eq. (5), (6)."""
    v = gradients(s, t)
    return np.array(s), np.array(v), np.array(gradients(v, t))


def my_tang(v: Sequence[Vector]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Eq. (10) to (13)."""
    ta = [[c / sqrt(sum(x * x for x in row)) for c in row] for row in v]
    phi_z = [atan2(row[1], row[0]) for row in ta]
    phi_y = [-asin(row[2] / sqrt(sum(x * x for x in row))) for row in ta]
    return np.array(phi_z), np.array(phi_y), np.zeros(len(v)), np.array(ta)


def my_ang(phi: Sequence[Vector], t: Vector, body: bool = False) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Eq. (7), (8); with `body` the factors of (7) change places."""
    R = [rotation(row) for row in phi]
    flat = [[x for row in matrix for x in row] for matrix in R]
    dR = [[row[0:3], row[3:6], row[6:9]] for row in gradients(flat, t)]
    omega = []
    for matrix, change in zip(R, dR, strict=True):
        Omega = product(inverse(matrix), change) if body else product(change, inverse(matrix))
        omega.append([Omega[2][1], Omega[0][2], Omega[1][0]])
    return np.array(phi), np.array(omega), np.array(gradients(omega, t))


def my_rotate(phi: Sequence[Vector], aN: Sequence[Vector], back: bool = False) -> np.ndarray:
    """Eq. (3), or with `back` eq. (4)."""
    turned = []
    for angles, vector in zip(phi, aN, strict=True):
        R = inverse(rotation(angles)) if back else rotation(angles)
        turned.append([sum(R[i][k] * vector[k] for k in range(3)) for i in range(3)])
    return np.array(turned)


def my_imu(aB: Sequence[Vector], omega: Sequence[Vector], alpha: Sequence[Vector], r: Vector) -> np.ndarray:
    """Eq. (9)."""
    rows = []
    for a, w, dw in zip(aB, omega, alpha, strict=True):
        centripetal, euler = cross(w, cross(w, r)), cross(dw, r)
        rows.append([a[i] + centripetal[i] + euler[i] for i in range(3)])
    return np.array(rows)


def cross(a: Vector, b: Vector) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
