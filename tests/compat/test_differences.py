"""What the MATLAB tool's equations do differently from the core, as facts."""

import numpy as np
import pytest

from kreisel import Imu, Motion, Mount
from kreisel.compat import my_ang, my_imu, my_lin, my_rotate, my_tang
from kreisel.maths.kinematics import euler_motion
from tests.truth import GRAVITY, LEVER_ARM, truth

T = np.arange(0, 1001) * 0.005
POSITION = (
    lambda t: 0.8 * np.cos(2 * np.pi * t),
    lambda t: 0.8 * np.sin(2 * np.pi * t),
    lambda t: 0.3 * np.cos(6 * np.pi * t),
)
ANGLES = (
    lambda t: 0.8 * np.cos(2 * np.pi * t),
    lambda t: 0.8 * np.sin(2 * np.pi * t),
    lambda t: 0.3 * np.cos(2 * np.pi * t),
)
UP = np.array([0.0, 0.0, GRAVITY])


def case_b(convention: str, t: np.ndarray = T) -> tuple[np.ndarray, np.ndarray]:
    """Gyro and accelerometer of case B by functions."""
    _, _, a = my_lin(POSITION, "sym", t)
    phi, omega, alpha = my_ang(ANGLES, "sym", t, convention=convention)
    aB = my_rotate(phi, a + UP, t, convention=convention)
    return omega, my_imu(aB, omega, alpha, LEVER_ARM, t)


def core_case_b(t: np.ndarray = T) -> tuple[Motion, np.ndarray, np.ndarray]:
    """The same by the core, its derivatives written by hand."""
    w = 2 * np.pi * np.array([[1.0, 1.0, 3.0], [1.0, 1.0, 1.0]])
    amplitude, lag = np.array([0.8, 0.8, 0.3]), np.array([0.0, np.pi / 2, 0.0])
    path, angles = (
        [amplitude * w[i] ** k * np.cos(w[i] * t[:, None] - lag + k * np.pi / 2) for k in range(3)]
        for i in (0, 1)
    )
    motion = Motion(t, *path, *euler_motion(*angles))
    read = Imu(Mount(p_BS=LEVER_ARM)).ideal(motion)
    return motion, read.gyro, read.accel


def test_physical_chain_with_functions_is_the_core() -> None:
    _, gyro, accel = core_case_b()
    omega, a_imu = case_b("physical")
    # 1e-11 of readings of 100: 500 eps.
    np.testing.assert_allclose(omega, gyro, atol=1e-12)
    np.testing.assert_allclose(a_imu, accel, atol=1e-11)


def test_physical_chain_with_functions_is_the_truth() -> None:
    t = T[::50]
    exact = truth("B", t)
    omega, a_imu = case_b("physical", t)
    np.testing.assert_allclose(omega, exact.gyro, atol=1e-12)
    np.testing.assert_allclose(a_imu, exact.accel, atol=1e-11)


def test_the_documents_rate_is_the_bodys_rate_in_N() -> None:
    motion, gyro, _ = core_case_b()
    omega, _ = case_b("document")
    np.testing.assert_allclose(np.einsum("nji,nj->ni", motion.R_NB, omega), gyro, atol=1e-13)
    # ... and not what a gyro reads, which is 6.4 rad/s at most.
    assert np.abs(omega - gyro).max() == pytest.approx(4.23, abs=0.01)


def test_the_documents_rotation_turns_gravity_the_wrong_way() -> None:
    """Nose up by 30 degrees (phi_y = -30): a resting accelerometer reads +g/2 along x; eq. (3) says -g/2."""
    phi = np.array([[0.0, -np.pi / 6, 0.0]])
    up = my_rotate(phi, UP[None], [0.0], convention="physical")
    np.testing.assert_allclose(up, [[GRAVITY / 2, 0.0, GRAVITY * np.sqrt(0.75)]], atol=1e-14)
    np.testing.assert_allclose(my_rotate(phi, UP[None], [0.0]), up * [-1, 1, 1], atol=1e-14)


def test_the_documents_chain_is_no_accelerometer() -> None:
    """Off by more than the largest reading, 88 m/s^2."""
    _, _, accel = core_case_b()
    _, a_imu = case_b("document")
    assert np.abs(a_imu - accel).max() == pytest.approx(149.9, abs=0.1)


def scheme_error_case_a(v_for_tangent: np.ndarray | None) -> np.ndarray:
    """Accelerometer error (n,) of the numeric scheme on figure 1's loop at 200 Hz, its conventions mended."""
    s = np.column_stack([x(T) for x in POSITION])
    _, v, a = my_lin(s, "num", T)
    phi_tz, phi_ty, phi_tx, _ = my_tang(v if v_for_tangent is None else v_for_tangent, T)
    phi, omega, alpha = my_ang(np.column_stack([phi_tx, phi_ty, phi_tz]), "num", T, convention="physical")
    aB = my_rotate(phi, a + UP, T, convention="physical")
    return np.linalg.norm(my_imu(aB, omega, alpha, LEVER_ARM, T) - truth("A", T).accel, axis=1)


INTERIOR = slice(50, -50)  # 5 % at each end left out


def test_error_of_the_documents_scheme() -> None:
    """Tangents of differenced velocity: at an end, alpha is the third one-sided difference in a row."""
    error = scheme_error_case_a(None)
    assert error[INTERIOR].max() == pytest.approx(1.49, abs=0.01)
    assert error.max() == error[0] == pytest.approx(148.0, abs=1.0)


def test_error_of_the_documents_scheme_with_exact_angles() -> None:
    error = scheme_error_case_a(my_lin(POSITION, "sym", T)[1])
    assert error[INTERIOR].max() == pytest.approx(1.42, abs=0.01)
    assert error.max() == pytest.approx(60.8, abs=0.5)


def test_tangent_angles_jump_where_the_heading_passes_west() -> None:
    """Harmless to rates, which come from R."""
    heading = np.linspace(0.9 * np.pi, 1.1 * np.pi, 41)
    v, t = np.column_stack([np.cos(heading), np.sin(heading), 0 * heading]), np.arange(41) * 0.01
    phi_tz, phi_ty, phi_tx, _ = my_tang(v, t)
    assert np.diff(phi_tz).min() == pytest.approx(0.2 * np.pi / 40 - 2 * np.pi)
    _, omega, _ = my_ang(np.column_stack([phi_tx, phi_ty, phi_tz]), "num", t)
    # sin of the step over the step: the scheme's 1 - x^2/6 at x = 0.0157.
    np.testing.assert_allclose(omega[:, 2], 0.2 * np.pi / 0.4, rtol=5e-5)
