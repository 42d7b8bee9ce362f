"""Turns one description of attitude into another: matrix, quaternion, Euler angles, rotation vector.

All matrices are R_NB: they map components in B to components in N. Leading axes are free, so that
``(3,)``, ``(n, 3)`` and ``(runs, n, 3)`` all work.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]

# Below this angle (rad) the series of exp_so3 and log_so3 are exact to the last bit: the first
# neglected term is angle^6 / 5040 = 4e-17 of the leading one at 5e-3.
SERIES_BELOW = 5e-3


def matrix_from_euler(phi: Array) -> Array:
    """R_NB (..., 3, 3) from phi (..., 3) = (phi_x, phi_y, phi_z) rad, intrinsic z-y-x.

    Source: document 000, eq. (2).
    """
    phi = np.asarray(phi, dtype=np.float64)
    (cx, cy, cz), (sx, sy, sz) = np.moveaxis(np.cos(phi), -1, 0), np.moveaxis(np.sin(phi), -1, 0)
    return _matrix(
        (cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx),
        (sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx),
        (-sy, cy * sx, cy * cx),
    )


def euler_from_matrix(R: Array) -> Array:
    """phi (..., 3) rad from R_NB (..., 3, 3); phi_y in [-pi/2, pi/2].

    At phi_y = +-pi/2 only the difference of the other two is defined: phi_x is 0 there.
    """
    R = np.asarray(R, dtype=np.float64)
    cos_y = np.hypot(R[..., 0, 0], R[..., 1, 0])
    # At 1e-8 the elements that carry phi_x and phi_z are down to half their digits.
    locked = cos_y < 1e-8
    phi_x = np.where(locked, 0.0, np.arctan2(R[..., 2, 1], R[..., 2, 2]))
    phi_y = np.arctan2(-R[..., 2, 0], cos_y)
    phi_z = np.where(locked, np.arctan2(-R[..., 0, 1], R[..., 1, 1]), np.arctan2(R[..., 1, 0], R[..., 0, 0]))
    return np.stack([phi_x, phi_y, phi_z], axis=-1)


def matrix_from_quat_wxyz(q: Array) -> Array:
    """R_NB (..., 3, 3) from unit quaternions q_NB (..., 4), w first; either sign gives the same matrix."""
    w, x, y, z = np.moveaxis(np.asarray(q, dtype=np.float64), -1, 0)
    return _matrix(
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


def quat_wxyz_from_matrix(R: Array) -> Array:
    """Unit quaternions (..., 4), w first, from R_NB (..., 3, 3).

    A sequence (n, 3, 3) comes back sign-continuous along n, its first with w >= 0.
    The largest of the four components is found first, so that none is divided by a small number
    (Shepperd 1978).
    """
    R = np.asarray(R, dtype=np.float64)
    flat = argument(R.reshape(-1, 3, 3))
    quat = np.empty((len(flat), 4))
    _quat_wxyz_from_matrix(flat, quat)
    quat = quat.reshape((*R.shape[:-2], 4))
    return continuous_signs(quat) if quat.ndim > 1 else quat


@kernel
def _quat_wxyz_from_matrix(R: Array, quat: Array) -> None:
    for k in range(R.shape[0]):
        a, b, c = R[k, 0, 0], R[k, 1, 1], R[k, 2, 2]
        p, q, r = R[k, 2, 1] - R[k, 1, 2], R[k, 0, 2] - R[k, 2, 0], R[k, 1, 0] - R[k, 0, 1]
        u, v, n = R[k, 0, 1] + R[k, 1, 0], R[k, 0, 2] + R[k, 2, 0], R[k, 1, 2] + R[k, 2, 1]
        # One row of 4 q q^T, chosen by its diagonal.
        if a + b + c >= max(a, b, c):
            w, x, y, z = 1.0 + a + b + c, p, q, r
        elif a >= b and a >= c:
            w, x, y, z = p, 1.0 + a - b - c, u, v
        elif b >= c:
            w, x, y, z = q, u, 1.0 - a + b - c, n
        else:
            w, x, y, z = r, v, n, 1.0 - a - b + c
        scale = 1.0 / np.sqrt(w * w + x * x + y * y + z * z)
        if w < 0.0:
            scale = -scale
        quat[k, 0], quat[k, 1], quat[k, 2], quat[k, 3] = scale * w, scale * x, scale * y, scale * z


def continuous_signs(q: Array) -> Array:
    """Quaternions (..., n, 4) with signs flipped so that neighbours along n lie in one hemisphere."""
    turns = np.einsum("...i,...i->...", q[..., 1:, :], q[..., :-1, :]) < 0.0
    # An odd number of turns so far means that this row has to be flipped.
    flipped = np.logical_xor.accumulate(turns, axis=-1)
    signed = np.array(q, dtype=np.float64)
    np.negative(signed[..., 1:, :], out=signed[..., 1:, :], where=flipped[..., None])
    return signed


def exp_so3(rotvec: Array) -> Array:
    """R (..., 3, 3) = Exp(rotvec) for rotation vectors (..., 3) rad (Rodrigues' formula)."""
    rotvec = np.asarray(rotvec, dtype=np.float64)
    squared = np.sum(rotvec * rotvec, axis=-1)
    angle = np.sqrt(squared)
    small = angle < SERIES_BELOW
    safe = np.where(small, 1.0, angle)
    # Half-angle form: 1 - cos(a) loses every digit below 1e-8 rad.
    half = np.sin(0.5 * safe) / safe
    first = np.where(small, 1.0 - squared / 6.0 * (1.0 - squared / 20.0), np.sin(safe) / safe)
    second = np.where(small, 0.5 - squared / 24.0 * (1.0 - squared / 30.0), 2.0 * half * half)
    K = skew(rotvec)
    return np.asarray(np.eye(3) + first[..., None, None] * K + second[..., None, None] * (K @ K))


def log_so3(R: Array) -> Array:
    """Rotation vectors (..., 3) rad of R (..., 3, 3), angle in [0, pi].

    Goes through the quaternion, which keeps full accuracy at pi where R - R^T vanishes.
    """
    q = quat_wxyz_from_matrix(np.asarray(R, dtype=np.float64)[..., None, :, :])[..., 0, :]
    vector = q[..., 1:]
    sine = np.linalg.norm(vector, axis=-1, keepdims=True)
    small = sine < SERIES_BELOW
    safe = np.where(small, 1.0, sine)
    # asin(s) / s = 1 + s^2/6 + 3 s^4/40 + ...: for w near 1 it avoids 0/0.
    ratio = np.where(
        small, 1.0 + sine**2 * (1.0 / 6.0 + sine**2 * (3.0 / 40.0)), np.arctan2(safe, q[..., :1]) / safe
    )
    return np.asarray(2.0 * ratio * vector)


def geodesic(R0: Array, R1: Array, share: Array) -> Array:
    """R (..., 3, 3) on the way from R0 at share 0 to R1 at share 1 (...), turning at a constant rate."""
    step = np.asarray(share)[..., None] * log_so3(np.swapaxes(R0, -1, -2) @ R1)
    return np.asarray(R0 @ exp_so3(step))


def nearest_rotation(M: Array) -> Array:
    """The rotation R (3, 3) with the largest trace of R^T M, for M (3, 3): Wahba's problem (Markley 1988)."""
    U, _, Vt = np.linalg.svd(M)
    U[:, 2] *= np.linalg.det(U) * np.linalg.det(Vt)
    return np.asarray(U @ Vt)


def skew(v: Array) -> Array:
    """Matrices [v]x (..., 3, 3) with [v]x u = v x u, for v (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(v, dtype=np.float64), -1, 0)
    zero = np.zeros_like(x)
    return _matrix((zero, -z, y), (z, zero, -x), (-y, x, zero))


def _matrix(*rows: tuple[Array, ...]) -> Array:
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotation_defect(R: Array) -> Array:
    """Largest element (n,) of |R^T R - 1| for finite R (n, 3, 3); 2 where R mirrors."""
    defect = np.empty(len(R))
    _rotation_defect(argument(R), defect)
    return defect


@kernel
def _rotation_defect(R: Array, defect: Array) -> None:
    for k in range(R.shape[0]):
        worst = 0.0
        for i in range(3):
            for j in range(i, 3):
                dot = R[k, 0, i] * R[k, 0, j] + R[k, 1, i] * R[k, 1, j] + R[k, 2, i] * R[k, 2, j]
                off = abs(dot - 1.0) if i == j else abs(dot)
                worst = max(worst, off)
        x = R[k, 1, 0] * R[k, 2, 1] - R[k, 2, 0] * R[k, 1, 1]
        y = R[k, 2, 0] * R[k, 0, 1] - R[k, 0, 0] * R[k, 2, 1]
        z = R[k, 0, 0] * R[k, 1, 1] - R[k, 1, 0] * R[k, 0, 1]
        mirrored = x * R[k, 0, 2] + y * R[k, 1, 2] + z * R[k, 2, 2] < 0.0
        defect[k] = 2.0 if mirrored else worst
