"""What a physicist would say about the readings of an ideal IMU on exactly known motions."""

import numpy as np
import numpy.typing as npt
import pytest

from kreisel import (
    FunctionTrajectory,
    Imu,
    ImuRecording,
    Mount,
    Trajectory,
    circle,
    coning,
    helix,
    line,
    lissajous,
    rest,
    rounded_rectangle,
)
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.maths.rotations import matrix_from_euler
from tests.truth import LEVER_ARM, truth

Array = npt.NDArray[np.float64]
UP = np.array([0.0, 0.0, STANDARD_GRAVITY])


def reading(
    trajectory: Trajectory, t: Array, p_BS: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> ImuRecording:
    return Imu(Mount(np.array(p_BS))).ideal(trajectory.sample(t))


def test_a_resting_imu_reads_gravity_upwards() -> None:
    still = reading(rest(), np.arange(3.0), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(still.accel, np.tile(UP, (3, 1)), atol=1e-15)
    np.testing.assert_array_equal(still.gyro, 0.0)


def test_a_tilted_resting_imu_reads_gravity_in_its_own_axes() -> None:
    phi = np.array([0.3, -0.5, 1.0])
    still = reading(rest(phi=phi), np.arange(3.0))
    np.testing.assert_allclose(still.accel[0], matrix_from_euler(phi).T @ UP, atol=1e-14)


def test_a_straight_line_at_constant_speed_is_rest() -> None:
    moving = reading(line((3.0, 4.0, 0.0)), np.arange(5.0), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(moving.accel, np.tile(UP, (5, 1)), atol=1e-14)
    np.testing.assert_array_equal(moving.gyro, 0.0)


def test_a_circle_pulls_inwards_with_v_squared_over_r() -> None:
    radius, period = 2.0, 3.0
    speed = 2.0 * np.pi * radius / period
    turning = reading(circle(radius, period), np.linspace(0.0, 9.0, 50))
    # Counter-clockwise: the centre is on the left, along y_B.
    np.testing.assert_allclose(turning.accel, np.tile([0.0, speed**2 / radius, UP[2]], (50, 1)), atol=1e-12)
    np.testing.assert_allclose(turning.gyro, np.tile([0.0, 0.0, 2.0 * np.pi / period], (50, 1)), atol=1e-12)


def test_a_lever_arm_at_constant_rate_adds_omega_squared_r() -> None:
    rate, arm = 3.0, 0.4
    spinning = FunctionTrajectory((0, 0, 0), (0, 0, lambda t: rate * t))
    out = reading(spinning, np.linspace(0.0, 5.0, 20), (arm, 0.0, 0.0))
    np.testing.assert_allclose(out.accel, np.tile([-(rate**2) * arm, 0.0, UP[2]], (20, 1)), atol=1e-12)


def test_a_helix_keeps_its_pitch_and_its_rate_about_the_vertical() -> None:
    motion = helix(radius=1.0, pitch=2.0 * np.pi, period=4.0).sample(np.linspace(0.0, 8.0, 30))
    # Rises as fast as it goes round: 45 degrees nose up.
    np.testing.assert_allclose(motion.euler[:, :2], np.tile([0.0, -0.25 * np.pi], (30, 1)), atol=1e-14)
    rate_N = np.einsum("nij,nj->ni", motion.R_NB, motion.omega_NB_B)
    np.testing.assert_allclose(rate_N, np.tile([0.0, 0.0, 0.5 * np.pi], (30, 1)), atol=1e-14)


@pytest.mark.parametrize("lap", [0, 1, 10_000])
def test_a_rounded_rectangle_pulls_inwards_in_the_corners_alone(lap: int) -> None:
    shape = rounded_rectangle()
    t = lap * shape.lap + np.linspace(0.0, shape.lap, 997)
    motion = shape.sample(t)
    inwards = np.einsum("ni,ni->n", motion.a_NB, motion.R_NB[:, :, 1])
    corner = motion.omega_NB_B[:, 2] != 0.0
    np.testing.assert_allclose(inwards[corner], 6.4, rtol=1e-12)
    np.testing.assert_array_equal(motion.a_NB[~corner], 0.0)
    # The share of the path that is corners: 0.2 pi of 3.2 + 0.2 pi metres; one row in 997 either way a joint.
    assert np.mean(corner) == pytest.approx(0.2 * np.pi / (3.2 + 0.2 * np.pi), abs=8 / 997)
    speed = np.linalg.norm(motion.v_NB, axis=1)
    np.testing.assert_allclose(speed, 0.8, rtol=1e-14)


def test_coning_reads_a_constant_rate_about_an_axis_it_never_turns_about() -> None:
    half_angle, rate = 0.2, 7.0
    t = np.linspace(0.0, 2.0 * np.pi / rate, 40)
    motion = coning(half_angle, rate).sample(t)
    np.testing.assert_allclose(
        motion.omega_NB_B[:, 2], -2.0 * rate * np.sin(0.5 * half_angle) ** 2, rtol=1e-12
    )
    # Back where it began after one round, though the integral of the rate about z is not zero.
    np.testing.assert_allclose(motion.R_NB[-1], motion.R_NB[0], atol=1e-14)
    # z_B stays on its cone.
    np.testing.assert_allclose(motion.R_NB[:, 2, 2], np.cos(half_angle), rtol=1e-14)


@pytest.mark.parametrize("case", ["A", "B"])
def test_exact_mode_equals_fifty_digits(case: str) -> None:
    def angle(t: Array) -> tuple[Array, Array, Array]:
        return 0.8 * np.cos(2 * np.pi * t), 0.8 * np.sin(2 * np.pi * t), 0.3 * np.cos(2 * np.pi * t)

    position = (
        lambda t: 0.8 * np.cos(2 * np.pi * t),
        lambda t: 0.8 * np.sin(2 * np.pi * t),
        lambda t: 0.3 * np.cos(6 * np.pi * t),
    )
    t = np.arange(1001) / 200.0
    exact = truth(case, t)
    ours = reading(FunctionTrajectory(position, "tangent" if case == "A" else angle), t, LEVER_ARM)
    # Round-off of the argument 30 pi alone moves time by 1e-15 s, and the accelerometer by 2e-12 m/s^2.
    assert np.abs(ours.accel - exact.accel).max() < 1e-11
    assert np.abs(ours.gyro - exact.gyro).max() < 1e-12


def test_the_lissajous_shape_is_figure_one() -> None:
    t = np.arange(0.0, 5.0, 0.05)
    exact = truth("A", t)
    ours = reading(lissajous(), t, LEVER_ARM)
    assert np.abs(ours.accel - exact.accel).max() < 1e-11
    assert np.abs(ours.gyro - exact.gyro).max() < 1e-12
