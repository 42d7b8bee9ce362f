"""Rates and accelerations against 50-digit derivatives of the rotation matrix itself."""

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kreisel.maths import kinematics
from kreisel.maths.rotations import matrix_from_euler, matrix_from_quat_wxyz

TIMES = np.array([0.0, 0.11, 0.5, 0.83])


def euler_angles(t):
    return [mpmath.mpf("0.8") * mpmath.cos(5 * t), mpmath.sin(3 * t) / 2, t + mpmath.cos(2 * t)]


def euler_matrix(t):
    x, y, z = euler_angles(t)
    c, s = mpmath.cos, mpmath.sin
    Rx = mpmath.matrix([[1, 0, 0], [0, c(x), -s(x)], [0, s(x), c(x)]])
    Ry = mpmath.matrix([[c(y), 0, s(y)], [0, 1, 0], [-s(y), 0, c(y)]])
    Rz = mpmath.matrix([[c(z), -s(z), 0], [s(z), c(z), 0], [0, 0, 1]])
    return Rz * Ry * Rx


def quaternion(t):
    """Not of unit length on purpose: only its direction is an attitude."""
    return [1 + t / 3, mpmath.sin(2 * t), mpmath.cos(3 * t) / 2, t * t - mpmath.mpf(1) / 4]


def quaternion_matrix(t):
    w, x, y, z = quaternion(t)
    n = w * w + x * x + y * y + z * z
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return mpmath.matrix(rows) / n


def body_rate(matrix, t):
    """vee(R^T dR/dt) at time t, by differentiating each element."""
    dR = mpmath.matrix(3, 3)
    for i in range(3):
        for j in range(3):
            dR[i, j] = mpmath.diff(lambda u, i=i, j=j: matrix(u)[i, j], t)
    W = matrix(t).T * dR
    return [W[2, 1], W[0, 2], W[1, 0]]


def truth(matrix):
    with mpmath.workdps(50):
        omega = [body_rate(matrix, mpmath.mpf(t)) for t in TIMES]
        alpha = [
            [mpmath.diff(lambda u, i=i: body_rate(matrix, u)[i], mpmath.mpf(t)) for i in range(3)]
            for t in TIMES
        ]
    return np.array(omega, dtype=float), np.array(alpha, dtype=float)


def derivatives(function, order):
    with mpmath.workdps(50):
        values = [
            [
                mpmath.diff(lambda u, i=i: function(u)[i], mpmath.mpf(t), order)
                for i in range(len(function(0)))
            ]
            for t in TIMES
        ]
    return np.array(values, dtype=float)


def test_euler_angles_and_their_derivatives_give_body_rates():
    R, omega, alpha = kinematics.euler_motion(*(derivatives(euler_angles, k) for k in range(3)))
    true_omega, true_alpha = truth(euler_matrix)
    # Ten roundings of rates of 5 rad/s and of angular accelerations of 25 rad/s^2.
    np.testing.assert_allclose(omega, true_omega, rtol=0, atol=5e-15)
    np.testing.assert_allclose(alpha, true_alpha, rtol=0, atol=3e-14)
    np.testing.assert_allclose(R, matrix_from_euler(derivatives(euler_angles, 0)), atol=1e-15)


def test_quaternions_of_any_length_give_body_rates():
    q = derivatives(quaternion, 0)
    R, omega, alpha = kinematics.quaternion_motion(q, derivatives(quaternion, 1), derivatives(quaternion, 2))
    true_omega, true_alpha = truth(quaternion_matrix)
    np.testing.assert_allclose(omega, true_omega, rtol=0, atol=5e-15)
    np.testing.assert_allclose(alpha, true_alpha, rtol=0, atol=5e-14)
    unit = q / np.linalg.norm(q, axis=1, keepdims=True)
    np.testing.assert_allclose(R, matrix_from_quat_wxyz(unit), atol=1e-15)


def moved(r, R, omega, alpha, R_BS=None):
    """What a lever arm makes of a body at rest in the origin that turns."""
    still = np.zeros((len(R), 3))
    return kinematics.motion_at(r, np.eye(3) if R_BS is None else R_BS, still, still, still, R, omega, alpha)


def test_the_motion_of_a_sensor_is_that_of_plain_linear_algebra(rng):
    R, R_BS = Rotation.random(7, rng).as_matrix(), Rotation.random(rng=rng).as_matrix()
    r, p, v, a, omega, alpha = (rng.normal(size=(7, 3)) for _ in range(6))
    ours = kinematics.motion_at(r[0], R_BS, p, v, a, R, omega, alpha)
    theirs = (
        p + R @ r[0],
        v + np.einsum("nij,nj->ni", R, np.cross(omega, r[0])),
        a + np.einsum("nij,nj->ni", R, np.cross(omega, np.cross(omega, r[0])) + np.cross(alpha, r[0])),
        R @ R_BS,
        omega @ R_BS,
        alpha @ R_BS,
    )
    for x, y in zip(ours, theirs, strict=True):
        # Sums of a few products of numbers of a few units.
        np.testing.assert_allclose(x, y, atol=2e-14)


def test_lever_arm_at_constant_rate_feels_omega_squared_r():
    R = np.eye(3)[None]
    omega, alpha = np.array([[0.0, 0.0, 3.0]]), np.zeros((1, 3))
    r = np.array([0.5, 0.0, 0.2])
    _, v_N, a_N, *_ = moved(r, R, omega, alpha)
    np.testing.assert_allclose(a_N, [[-4.5, 0.0, 0.0]])
    np.testing.assert_allclose(v_N, [[0.0, 1.5, 0.0]])


def test_lever_arm_under_angular_acceleration_feels_alpha_cross_r():
    R = np.array([[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])  # nose to the north
    alpha = np.array([[0.0, 0.0, 2.0]])
    a_N = moved(np.array([1.0, 0.0, 0.0]), R, np.zeros((1, 3)), alpha)[2]
    # In B it is 2 m/s^2 to the left; left of north is west.
    np.testing.assert_allclose(a_N, [[-2.0, 0.0, 0.0]], atol=1e-15)


@pytest.mark.parametrize("tilt", [0.0, 0.3, np.pi])
def test_a_body_in_free_fall_feels_nothing_and_one_at_rest_feels_g_up(tilt):
    R = matrix_from_euler([[tilt, 0.0, 0.7]])
    g_N = np.array([0.0, 0.0, -9.80665])
    np.testing.assert_array_equal(kinematics.specific_force(g_N[None], R, g_N), [[0.0, 0.0, 0.0]])
    at_rest = kinematics.specific_force(np.zeros((1, 3)), R, g_N)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", R, at_rest), [[0, 0, 9.80665]], atol=1e-14)
