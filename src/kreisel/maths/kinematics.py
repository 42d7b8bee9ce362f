"""Turns derivatives of position and attitude into rates, accelerations and specific force.

Equation numbers are those of document 000. Everything rotational is in body axes B, as a gyro measures it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]


class Uncertainty(NamedTuple):
    """Standard errors of what an IMU feels, independent of each other and from axis to axis."""

    theta: Array  # (n, 3) rad, of rotations about the axes of B
    a: Array  # (n, 3) m/s^2, along the axes of N
    omega: Array  # (n, 3) rad/s, in B
    alpha: Array  # (n, 3) rad/s^2, in B


def motion_at(
    p_BS: Array, R_BS: Array, p: Array, v: Array, a: Array, R: Array, omega: Array, alpha: Array
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """The same six of a sensor at p_BS (3,) m whose axes in B are R_BS (3, 3), from those of the body.

    p_NB, v_NB, a_NB (n, 3) in N, R_NB (n, 3, 3), omega_NB_B and alpha_NB_B (n, 3): the lever arm adds
    R_NB (omega x r) to the velocity and R_NB (omega x (omega x r) + alpha x r) to the acceleration; the rates
    come in sensor axes. Source: eq. (9).
    """
    body = (p, v, a, R, omega, alpha)
    p_S, v_S, a_S, R_NS, omega_S, alpha_S = of_sensor = tuple(np.empty(np.shape(x)) for x in body)
    _motion_at(*map(argument, (p_BS, R_BS, *body)), *of_sensor)
    return p_S, v_S, a_S, R_NS, omega_S, alpha_S


@kernel
def _motion_at(
    lever: Array, turn: Array, p: Array, v: Array, a: Array, R: Array, omega: Array, alpha: Array,
    p_S: Array, v_S: Array, a_S: Array, R_NS: Array, omega_S: Array, alpha_S: Array,
) -> None:  # fmt: skip
    r, s, u = lever[0], lever[1], lever[2]
    for k in range(p.shape[0]):
        x, y, z = omega[k, 0], omega[k, 1], omega[k, 2]
        xx, yy, zz = alpha[k, 0], alpha[k, 1], alpha[k, 2]
        vx, vy, vz = y * u - z * s, z * r - x * u, x * s - y * r
        ax = (y * vz - z * vy) + (yy * u - zz * s)
        ay = (z * vx - x * vz) + (zz * r - xx * u)
        az = (x * vy - y * vx) + (xx * s - yy * r)
        for i in range(3):
            b, c, d = R[k, i, 0], R[k, i, 1], R[k, i, 2]
            p_S[k, i] = p[k, i] + (b * r + c * s + d * u)
            v_S[k, i] = v[k, i] + (b * vx + c * vy + d * vz)
            a_S[k, i] = a[k, i] + (b * ax + c * ay + d * az)
            for j in range(3):
                R_NS[k, i, j] = b * turn[0, j] + c * turn[1, j] + d * turn[2, j]
        for j in range(3):
            omega_S[k, j] = x * turn[0, j] + y * turn[1, j] + z * turn[2, j]
            alpha_S[k, j] = xx * turn[0, j] + yy * turn[1, j] + zz * turn[2, j]


def specific_force(a_NB: Array, R_NB: Array, g_N: Array) -> Array:
    """Specific force (n, 3) in B: R_NB^T (a_NB - g_N); +g up at rest. Source: eq. (9), term a_S."""
    f = np.empty((len(a_NB), 3))
    _specific_force(argument(a_NB), argument(R_NB), argument(g_N), f)
    return f


@kernel
def _specific_force(a: Array, R: Array, g_N: Array, f: Array) -> None:
    for k in range(a.shape[0]):
        x, y, z = a[k, 0] - g_N[0], a[k, 1] - g_N[1], a[k, 2] - g_N[2]
        for j in range(3):
            f[k, j] = R[k, 0, j] * x + R[k, 1, j] * y + R[k, 2, j] * z


def linear_acceleration(R_NS: Array, f_S: Array, gravity: float) -> Array:
    """a_NS (n, 3) in N that a sensor with attitude R_NS (n, 3, 3) shows by its specific force (n, 3): R_NS f + g_N.

    g_N = (0, 0, -gravity). One sample gives the bits that it gives among others.
    """
    a_N = np.empty((len(f_S), 3))
    _linear_acceleration(argument(R_NS), argument(f_S), gravity, a_N)
    return a_N


@kernel
def _linear_acceleration(R: Array, f: Array, gravity: float, a: Array) -> None:
    for k in range(R.shape[0]):
        x, y, z = f[k, 0], f[k, 1], f[k, 2]
        a[k, 0] = R[k, 0, 0] * x + R[k, 0, 1] * y + R[k, 0, 2] * z
        a[k, 1] = R[k, 1, 0] * x + R[k, 1, 1] * y + R[k, 1, 2] * z
        a[k, 2] = R[k, 2, 0] * x + R[k, 2, 1] * y + R[k, 2, 2] * z - gravity


def specific_force_sigma(
    force_S: Array, mount: tuple[Array, Array], R_NB: Array, omega_NB_B: Array, known: Uncertainty
) -> Array:
    """Standard error (n, 3), in S, of the specific force `force_S` (n, 3) at a mount (p_BS, R_BS) of a body.

    To first order: of the acceleration, of the tilt under which the force is seen, and of both terms that the
    lever arm adds.
    """
    p_BS, R_BS = mount
    a = np.swapaxes(R_NB, 1, 2) * known.a[:, None, :]
    tilt = _cross_matrix(force_S @ R_BS.T) * known.theta[:, None, :]
    parts = np.concatenate([a, tilt, *_lever_parts(p_BS, omega_NB_B, known)], axis=2)
    return np.asarray(np.linalg.norm(R_BS.T @ parts, axis=2))


def acceleration_sigma_at(p_BS: Array, R_NB: Array, omega_NB_B: Array, known: Uncertainty) -> Array:
    """Standard error (n, 3) along the axes of N of the acceleration at p_BS."""
    lever = np.linalg.norm(R_NB @ np.concatenate(_lever_parts(p_BS, omega_NB_B, known), axis=2), axis=2)
    return np.asarray(np.hypot(known.a, lever))


def _lever_parts(p_BS: Array, omega_NB_B: Array, known: Uncertainty) -> tuple[Array, Array]:
    """Errors (n, 3, 3) of omega x (omega x r) and of alpha x r in B, one column per axis of rate and its derivative."""
    inner = (omega_NB_B @ p_BS)[:, None, None] * np.eye(3)
    outer = omega_NB_B[:, :, None] * p_BS - 2.0 * p_BS[:, None] * omega_NB_B[:, None, :]
    turning = -_cross_matrix(np.broadcast_to(p_BS, known.alpha.shape))
    return (inner + outer) * known.omega[:, None, :], turning * known.alpha[:, None, :]


def _cross_matrix(v: Array) -> Array:
    """(n, 3, 3) matrices of v x."""
    out = np.zeros((len(v), 3, 3))
    out[:, 2, 1], out[:, 0, 2], out[:, 1, 0] = v.T
    return np.asarray(out - np.swapaxes(out, 1, 2))


def euler_motion(phi: Array, dphi: Array, ddphi: Array) -> tuple[Array, Array, Array]:
    """R_NB (n, 3, 3), omega_NB_B (n, 3) and alpha_NB_B (n, 3) from Euler angles and two derivatives.

    phi, dphi, ddphi: (n, 3) rad, rad/s, rad/s^2, order x, y, z. Equals eq. (7) and (8) taken in B axes;
    written out because R^T dR/dt for z-y-x angles has three terms a component.
    """
    return _filled(_euler_motion, phi, dphi, ddphi)


def _filled(fill: Callable[..., None], x: Array, dx: Array, ddx: Array) -> tuple[Array, Array, Array]:
    """What a kernel makes of an attitude and its derivatives: R_NB, omega_NB_B and alpha_NB_B."""
    n = len(x)
    out = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
    fill(argument(x), argument(dx), argument(ddx), *out)
    return out


@kernel
def _euler_motion(phi: Array, dphi: Array, ddphi: Array, R: Array, omega: Array, alpha: Array) -> None:
    for k in range(phi.shape[0]):
        cx, sx = np.cos(phi[k, 0]), np.sin(phi[k, 0])
        cy, sy = np.cos(phi[k, 1]), np.sin(phi[k, 1])
        cz, sz = np.cos(phi[k, 2]), np.sin(phi[k, 2])
        R[k, 0, 0], R[k, 0, 1], R[k, 0, 2] = cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx
        R[k, 1, 0], R[k, 1, 1], R[k, 1, 2] = sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx
        R[k, 2, 0], R[k, 2, 1], R[k, 2, 2] = -sy, cy * sx, cy * cx
        x, y, z = dphi[k, 0], dphi[k, 1], dphi[k, 2]
        omega[k, 0] = x - z * sy
        omega[k, 1] = y * cx + z * cy * sx
        omega[k, 2] = -y * sx + z * cy * cx
        xx, yy, zz = ddphi[k, 0], ddphi[k, 1], ddphi[k, 2]
        alpha[k, 0] = xx - zz * sy - z * y * cy
        alpha[k, 1] = yy * cx + zz * cy * sx - y * x * sx - z * y * sy * sx + z * x * cy * cx
        alpha[k, 2] = -yy * sx + zz * cy * cx - y * x * cx - z * y * sy * cx - z * x * cy * sx


def quaternion_motion(q: Array, dq: Array, ddq: Array) -> tuple[Array, Array, Array]:
    """R_NB (n, 3, 3), omega_NB_B (n, 3) and alpha_NB_B (n, 3) from q_NB_wxyz (n, 4) and two derivatives.

    q need not be of unit length: with u = q^-1 dq = (s, v), omega = 2 v and
    alpha = 2 (vec(q^-1 ddq) - 2 s v) hold for the normalised quaternion whatever the length does, so a
    spline through quaternions serves without being pulled back to the sphere.
    """
    return _filled(_quaternion_motion, q, dq, ddq)


@kernel
def _quaternion_motion(q: Array, dq: Array, ddq: Array, R: Array, omega: Array, alpha: Array) -> None:
    for k in range(q.shape[0]):
        w, x, y, z = q[k, 0], q[k, 1], q[k, 2], q[k, 3]
        scale = 1.0 / (w * w + x * x + y * y + z * z)
        R[k, 0, 0], R[k, 1, 1] = 1.0 - 2.0 * scale * (y * y + z * z), 1.0 - 2.0 * scale * (x * x + z * z)
        R[k, 2, 2] = 1.0 - 2.0 * scale * (x * x + y * y)
        R[k, 0, 1], R[k, 1, 0] = 2.0 * scale * (x * y - w * z), 2.0 * scale * (x * y + w * z)
        R[k, 0, 2], R[k, 2, 0] = 2.0 * scale * (x * z + w * y), 2.0 * scale * (x * z - w * y)
        R[k, 1, 2], R[k, 2, 1] = 2.0 * scale * (y * z - w * x), 2.0 * scale * (y * z + w * x)
        dw, dx, dy, dz = dq[k, 0], dq[k, 1], dq[k, 2], dq[k, 3]
        s = scale * (w * dw + x * dx + y * dy + z * dz)
        vx = scale * (w * dx - x * dw - y * dz + z * dy)
        vy = scale * (w * dy - y * dw - z * dx + x * dz)
        vz = scale * (w * dz - z * dw - x * dy + y * dx)
        omega[k, 0], omega[k, 1], omega[k, 2] = 2.0 * vx, 2.0 * vy, 2.0 * vz
        dw, dx, dy, dz = ddq[k, 0], ddq[k, 1], ddq[k, 2], ddq[k, 3]
        alpha[k, 0] = 2.0 * (scale * (w * dx - x * dw - y * dz + z * dy) - 2.0 * s * vx)
        alpha[k, 1] = 2.0 * (scale * (w * dy - y * dw - z * dx + x * dz) - 2.0 * s * vy)
        alpha[k, 2] = 2.0 * (scale * (w * dz - z * dw - x * dy + y * dx) - 2.0 * s * vz)
