"""Rotations against SciPy's, at the places where formulas break."""

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kreisel.maths import rotations

# Ten roundings of numbers of order one.
ROUND_OFF = 3e-15


def random_rotations(rng: np.random.Generator, n: int = 500) -> Rotation:
    return Rotation.from_quat(rng.normal(size=(n, 4)))


def test_euler_matrix_is_the_product_of_document_equation_2(rng):
    x, y, z = rng.uniform(-3, 3, 3)
    Rx = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    Ry = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    Rz = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    np.testing.assert_allclose(rotations.matrix_from_euler([x, y, z]), Rz @ Ry @ Rx, atol=ROUND_OFF)


def test_euler_angles_come_back_and_agree_with_scipy(rng):
    R = random_rotations(rng)
    phi = rotations.euler_from_matrix(R.as_matrix())
    np.testing.assert_allclose(rotations.matrix_from_euler(phi), R.as_matrix(), atol=ROUND_OFF)
    # Angles lose digits with 1 / cos(phi_y), at most 1e6 in this many draws.
    np.testing.assert_allclose(phi[:, ::-1], R.as_euler("ZYX"), atol=1e-9)


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
def test_vertical_nose_keeps_the_matrix_and_sets_roll_to_zero(pitch):
    R = rotations.matrix_from_euler([0.4, pitch, -0.9])
    phi = rotations.euler_from_matrix(R)
    assert phi[0] == 0.0
    np.testing.assert_allclose(rotations.matrix_from_euler(phi), R, atol=ROUND_OFF)


def test_quaternions_agree_with_scipy_whichever_component_is_largest(rng):
    for axis in np.eye(4):
        q = axis + 0.1 * rng.normal(size=4)
        R = Rotation.from_quat(q, scalar_first=True)
        ours = rotations.quat_wxyz_from_matrix(R.as_matrix())
        theirs = R.as_quat(scalar_first=True)
        np.testing.assert_allclose(ours * np.sign(ours @ theirs), theirs, atol=ROUND_OFF)
        np.testing.assert_allclose(rotations.matrix_from_quat_wxyz(ours), R.as_matrix(), atol=ROUND_OFF)


def test_a_tumbling_body_has_no_jumps_in_its_quaternion():
    angle = np.linspace(0.0, 6.0 * np.pi, 500)
    q = rotations.quat_wxyz_from_matrix(rotations.exp_so3(angle[:, None] * np.array([0.6, 0.0, 0.8])))
    # Half the angle between neighbours: 0.019 rad; a flip of sign would be 2.
    assert np.linalg.norm(np.diff(q, axis=0), axis=1).max() < 0.02
    assert q[0, 0] >= 0.0


def test_leading_axes_are_free(rng):
    phi = rng.uniform(-1, 1, (2, 5, 3))
    R = rotations.matrix_from_euler(phi)
    assert R.shape == (2, 5, 3, 3)
    np.testing.assert_array_equal(R[1, 3], rotations.matrix_from_euler(phi[1, 3]))
    np.testing.assert_array_equal(
        rotations.quat_wxyz_from_matrix(R)[1], rotations.quat_wxyz_from_matrix(R[1])
    )


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-9, 4.999e-3, 5e-3, 5.001e-3, 0.1, 3.0, np.pi])
def test_exp_at_below_and_above_the_switch_of_its_series(angle):
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    with mpmath.workdps(50):
        a = mpmath.mpf(angle)
        K = mpmath.matrix(rotations.skew(axis).tolist())
        exact = mpmath.eye(3) + mpmath.sin(a) * K + (1 - mpmath.cos(a)) * K * K
        truth = np.array(exact.tolist(), dtype=float)
    R = rotations.exp_so3(angle * axis)
    np.testing.assert_allclose(R, truth, rtol=0, atol=ROUND_OFF)
    # The small off-diagonal part keeps its own digits: that is what the series is for.
    np.testing.assert_allclose(
        (R - R.T) / max(angle, 1e-300), (truth - truth.T) / max(angle, 1e-300), atol=1e-6
    )
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=ROUND_OFF)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-5, 9.999e-3, 1.0001e-2, 0.5, 2.0, 3.1, np.pi - 1e-9])
def test_log_undoes_exp_to_full_accuracy(angle):
    rotvec = angle * np.array([2.0, -3.0, 6.0]) / 7.0
    back = rotations.log_so3(rotations.exp_so3(rotvec))
    # Elements of R carry 1e-16, whatever the angle.
    np.testing.assert_allclose(back, rotvec, rtol=0, atol=ROUND_OFF)


def test_skew_is_the_cross_product(rng):
    a, b = rng.normal(size=(2, 7, 3))
    np.testing.assert_allclose(
        np.einsum("nij,nj->ni", rotations.skew(a), b), np.cross(a, b), atol=ROUND_OFF * 10
    )
