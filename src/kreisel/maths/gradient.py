"""Turns samples of position and attitude into rates and accelerations by MATLAB's ``gradient(x, t)``.

The numeric scheme of document 000: central differences over the span of the two neighbours inside, one-sided
at the two ends, on uneven steps too. Crude (its error falls with the square of the step inside and only with
the step at the ends), and kept because the document defines it; splines are in `derivatives`.

    Omega = dR/dt R^T    axes "N": eq. (7); its omega has components in N
    Omega = R^T dR/dt    axes "B": what a gyro on the body measures

Differences of R make Omega not quite skew, so that the elements read from it matter:
omega = (Omega[2, 1], Omega[0, 2], Omega[1, 0]).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import kernel
from kreisel.maths.sincos import sincos

Array = npt.NDArray[np.float64]
Axes = Literal["B", "N"]

# Samples per block of the fused kernel: its scratch (60 kB) stays in the L2 cache.
BLOCK = 256
# Row length of the scratch, in which every component is a row of its own: only then do the loops become SIMD.
ROW = BLOCK + 8
# One allocation this far apart for all outputs: 64-byte lines are not shared between them.
LINE = 8


def gradient(x: Array, t: Array) -> Array:
    """dx/dt (n, ...) of samples `x` (n, ...) at times `t` (n,), n >= 2; unit of x per unit of t.

    Differs from numpy.gradient where steps are uneven: that weighs the two neighbours for second order.
    """
    x = np.asarray(x, dtype=np.float64)
    slope = np.empty(x.shape)
    _slopes(_flat(x), _flat(t), slope.reshape(-1), x.size // len(x))
    return slope


def gradient_rotation(t: Array, R_NB: Array, axes: Axes = "B") -> tuple[Array, Array]:
    """omega (n, 3) rad/s and alpha (n, 3) rad/s^2 from matrices R_NB (n, 3, 3) at times `t` (n,), n >= 2.

    axes "B": omega_NB_B, R^T dR/dt, and its derivative; axes "N": eq. (7) and (8) as they stand.
    """
    omega = np.empty((len(t), 3))
    _rates(_flat(R_NB), _flat(t), omega.reshape(-1), axes == "B")
    return omega, gradient(omega, t)


def gradient_motion(
    t: Array, s: Array, phi: Array, g_N: Array, axes: Axes = "B"
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """v, a, R_NB, omega, alpha and specific force f from positions and Euler angles, in one pass.

    t (n,) s, n >= 2; s (n, 3) m in N; phi (n, 3) rad; g_N (3,) m/s^2. Returns v, a (n, 3) in N,
    R_NB (n, 3, 3), omega and alpha (n, 3) in `axes`, f = R_NB^T (a - g_N) (n, 3) in B.
    """
    v, a, omega, alpha, f, R = _allocate(len(t))
    _motion(_flat(t), _flat(s), _flat(phi), _flat(g_N), axes == "B", v, a, R, omega, alpha, f)
    omega, alpha, f = omega.reshape(-1, 3), alpha.reshape(-1, 3), f.reshape(-1, 3)
    return v.reshape(-1, 3), a.reshape(-1, 3), R.reshape(-1, 3, 3), omega, alpha, f


def _flat(x: Array) -> Array:
    """`x` in one dimension, read-only whoever made it: one signature, and so one compilation."""
    flat = np.ascontiguousarray(x, dtype=np.float64).reshape(-1).view()
    flat.flags.writeable = False
    return flat


def _allocate(n: int) -> list[Array]:
    """Five columns of 3 n and one of 9 n numbers in one piece of memory.

    Six pieces of some megabytes each go back to the system and are faulted in anew at every call, which
    costs more than the arithmetic.
    """
    column = -(-3 * n // LINE) * LINE
    memory = np.empty(5 * column + 9 * n)
    return [memory[k * column : k * column + 3 * n] for k in range(5)] + [memory[5 * column :]]


@kernel
def _slopes(x: Array, t: Array, slope: Array, width: int) -> None:
    n = t.shape[0]
    _end_slope(x, t, slope, width, 0, 1, 0)
    for k in range(1, n - 1):
        span = t[k + 1] - t[k - 1]
        for i in range(width):
            slope[k * width + i] = (x[(k + 1) * width + i] - x[(k - 1) * width + i]) / span
    _end_slope(x, t, slope, width, n - 2, n - 1, n - 1)


@kernel
def _end_slope(x: Array, t: Array, slope: Array, width: int, low: int, high: int, k: int) -> None:
    for i in range(width):
        slope[k * width + i] = (x[high * width + i] - x[low * width + i]) / (t[high] - t[low])


@kernel
def _rates(R: Array, t: Array, omega: Array, body: bool) -> None:
    n = t.shape[0]
    for k in range(n):
        low, high = max(k - 1, 0), min(k + 1, n - 1)
        x, y, z = _turn(R, 1, 9 * low, 9 * k, 9 * high, body)
        span = t[high] - t[low]
        omega[3 * k], omega[3 * k + 1], omega[3 * k + 2] = x / span, y / span, z / span


@kernel
def _turn(R: Array, e: int, low: int, k: int, high: int, body: bool) -> tuple[float, float, float]:
    """Three elements of R_k^T (R_high - R_low), or of (R_high - R_low) R_k^T.

    Element (i, j) of a matrix lies e (3 i + j) after the offset that stands for its sample.
    """
    if body:
        return (
            _dot(R, 2 * e, 1 * e, 3 * e, low, k, high),
            _dot(R, 0 * e, 2 * e, 3 * e, low, k, high),
            _dot(R, 1 * e, 0 * e, 3 * e, low, k, high),
        )
    return (
        _dot(R, 3 * e, 6 * e, e, low, k, high),
        _dot(R, 6 * e, 0 * e, e, low, k, high),
        _dot(R, 0 * e, 3 * e, e, low, k, high),
    )


@kernel
def _dot(R: Array, still: int, moving: int, step: int, low: int, k: int, high: int) -> float:
    dot: float = R[still + k] * (R[moving + high] - R[moving + low])
    dot += R[still + step + k] * (R[moving + step + high] - R[moving + step + low])
    dot += R[still + 2 * step + k] * (R[moving + 2 * step + high] - R[moving + 2 * step + low])
    return dot


@kernel
def _motion(
    t: Array, s: Array, phi: Array, g: Array, body: bool,
    v: Array, a: Array, R: Array, omega: Array, alpha: Array, f: Array,
) -> None:  # fmt: skip
    n = t.shape[0]
    inverse, inverse3, x, y = np.empty(ROW), np.empty(3 * ROW), np.empty(3 * ROW), np.empty(3 * ROW)
    # Sines are taken of whole rows, so that what lies behind the last sample must be numbers.
    angle, sine, cosine, matrix = np.zeros(3 * ROW), np.empty(3 * ROW), np.empty(3 * ROW), np.empty(9 * ROW)
    for b in range(0, n, BLOCK):
        m = min(BLOCK, n - b)
        # First derivatives run one sample ahead of the block, their arguments two: the second ones need them.
        w = min(m + 2, n - b)
        _inverse_spans(t[b:], inverse, inverse3, w - 2)
        _scale_differences(s[3 * b :], inverse3, v[3 * b + 3 :], 3 * (w - 2))
        _end_slopes(s, t, v, b, b + w)
        _split(phi[3 * b :], angle, w)
        sincos(angle, sine, cosine)
        _matrices(sine, cosine, matrix, w)
        _join_matrices(matrix, R[9 * b :], m)
        _block_rates(matrix, inverse, y, w - 2, body)
        _join(y, omega[3 * b + 3 :], w - 2)
        _end_rates(matrix, t, omega, b, w, body)
        low, high = max(b, 1), min(b + m, n - 1)
        _inverse_spans(t[low - 1 :], inverse, inverse3, high - low)
        _scale_differences(v[3 * low - 3 :], inverse3, a[3 * low :], 3 * (high - low))
        _scale_differences(omega[3 * low - 3 :], inverse3, alpha[3 * low :], 3 * (high - low))
        _end_slopes(v, t, a, b, b + m)
        _end_slopes(omega, t, alpha, b, b + m)
        _split(a[3 * b :], x, m)
        _block_forces(matrix, x, g[0], g[1], g[2], y, m)
        _join(y, f[3 * b :], m)


@kernel
def _inverse_spans(t: Array, inverse: Array, inverse3: Array, m: int) -> None:
    """1 / (t[k + 2] - t[k]), once for the rows of the scratch and thrice for triples."""
    for k in range(m):
        inverse[k] = 1.0 / (t[k + 2] - t[k])
    for k in range(m):
        inverse3[3 * k] = inverse3[3 * k + 1] = inverse3[3 * k + 2] = inverse[k]


@kernel
def _scale_differences(x: Array, inverse3: Array, slope: Array, m: int) -> None:
    for k in range(m):
        slope[k] = (x[k + 6] - x[k]) * inverse3[k]


@kernel
def _end_slopes(x: Array, t: Array, slope: Array, first: int, stop: int) -> None:
    """The one-sided slopes of triples, where samples first .. stop hold an end."""
    n = t.shape[0]
    if first == 0:
        _end_slope(x, t, slope, 3, 0, 1, 0)
    if stop == n:
        _end_slope(x, t, slope, 3, n - 2, n - 1, n - 1)


@kernel
def _end_rates(matrix: Array, t: Array, omega: Array, b: int, w: int, body: bool) -> None:
    n = t.shape[0]
    if b == 0:
        x, y, z = _turn(matrix, ROW, 0, 0, 1, body)
        span = t[1] - t[0]
        omega[0], omega[1], omega[2] = x / span, y / span, z / span
    # A last block of one sample has no neighbour in its scratch; the block before has been there.
    if b + w == n and w > 1:
        x, y, z = _turn(matrix, ROW, w - 2, w - 1, w - 1, body)
        span = t[n - 1] - t[n - 2]
        omega[3 * n - 3], omega[3 * n - 2], omega[3 * n - 1] = x / span, y / span, z / span


@kernel
def _matrices(sine: Array, cosine: Array, matrix: Array, m: int) -> None:
    """R = Rz Ry Rx, eq. (2), of m samples; every element is a row."""
    for k in range(m):
        sx, sy, sz = sine[k], sine[ROW + k], sine[2 * ROW + k]
        cx, cy, cz = cosine[k], cosine[ROW + k], cosine[2 * ROW + k]
        matrix[k], matrix[ROW + k], matrix[2 * ROW + k] = (
            cz * cy,
            cz * sy * sx - sz * cx,
            cz * sy * cx + sz * sx,
        )
        matrix[3 * ROW + k], matrix[4 * ROW + k] = sz * cy, sz * sy * sx + cz * cx
        matrix[5 * ROW + k] = sz * sy * cx - cz * sx
        matrix[6 * ROW + k], matrix[7 * ROW + k], matrix[8 * ROW + k] = -sy, cy * sx, cy * cx


@kernel
def _block_rates(matrix: Array, inverse: Array, omega: Array, m: int, body: bool) -> None:
    # Spelled out with constant offsets, the choice outside: through `_turn` the loops are not SIMD.
    if body:
        for k in range(m):
            omega[k] = inverse[k] * _dot(matrix, 2 * ROW, ROW, 3 * ROW, k, k + 1, k + 2)
            omega[ROW + k] = inverse[k] * _dot(matrix, 0, 2 * ROW, 3 * ROW, k, k + 1, k + 2)
            omega[2 * ROW + k] = inverse[k] * _dot(matrix, ROW, 0, 3 * ROW, k, k + 1, k + 2)
    else:
        for k in range(m):
            omega[k] = inverse[k] * _dot(matrix, 3 * ROW, 6 * ROW, ROW, k, k + 1, k + 2)
            omega[ROW + k] = inverse[k] * _dot(matrix, 6 * ROW, 0, ROW, k, k + 1, k + 2)
            omega[2 * ROW + k] = inverse[k] * _dot(matrix, 0, 3 * ROW, ROW, k, k + 1, k + 2)


@kernel
def _block_forces(matrix: Array, a: Array, gx: float, gy: float, gz: float, f: Array, m: int) -> None:
    """R^T (a - g), row by row."""
    for k in range(m):
        x, y, z = a[k] - gx, a[ROW + k] - gy, a[2 * ROW + k] - gz
        f[k] = matrix[k] * x + matrix[3 * ROW + k] * y + matrix[6 * ROW + k] * z
        f[ROW + k] = matrix[ROW + k] * x + matrix[4 * ROW + k] * y + matrix[7 * ROW + k] * z
        f[2 * ROW + k] = matrix[2 * ROW + k] * x + matrix[5 * ROW + k] * y + matrix[8 * ROW + k] * z


@kernel
def _split(triples: Array, rows: Array, m: int) -> None:
    for k in range(m):
        rows[k], rows[ROW + k], rows[2 * ROW + k] = triples[3 * k], triples[3 * k + 1], triples[3 * k + 2]


@kernel
def _join(rows: Array, triples: Array, m: int) -> None:
    for k in range(m):
        triples[3 * k], triples[3 * k + 1], triples[3 * k + 2] = rows[k], rows[ROW + k], rows[2 * ROW + k]


@kernel
def _join_matrices(rows: Array, matrices: Array, m: int) -> None:
    for k in range(m):
        for i in range(9):
            matrices[9 * k + i] = rows[i * ROW + k]
