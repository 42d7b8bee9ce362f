"""Other worlds, checked by what a physicist sees happen rather than by matrices."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.environment import STANDARD_GRAVITY as G
from kreisel.data.frames import WORLDS, from_enu_flu, to_enu_flu
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.maths.rotations import euler_from_matrix, exp_so3, matrix_from_euler
from kreisel.simulate.imu import Imu

T = np.arange(4) * 0.5
ZERO = np.zeros((4, 3))
EAST, NORTH, UP = np.eye(3)


def resting(heading: np.ndarray = EAST) -> Motion:
    """A level body at rest, its nose along `heading` (horizontal, ENU)."""
    left = np.cross(UP, heading)
    R_NB = np.tile(np.column_stack([heading, left, UP]), (4, 1, 1))
    return Motion(T, ZERO, ZERO, ZERO, R_NB, ZERO, ZERO)


def random_motion(rng: np.random.Generator) -> Motion:
    p, v, a, omega, alpha = rng.normal(size=(5, 4, 3))
    return Motion(T, p, v, a, exp_so3(rng.normal(size=(4, 3))), omega, alpha, t0_ns=7, name="m")


@pytest.mark.parametrize(
    ("world", "reading"),
    [
        ("enu-flu", (0, 0, G)),
        ("ros", (0, 0, G)),
        ("nwu", (0, 0, G)),
        ("ned-frd", (0, 0, -G)),
        ("matlab", (0, 0, G)),
    ],
)
def test_what_an_imu_at_rest_reads(world: str, reading: tuple[float, float, float]) -> None:
    recording = from_enu_flu(Imu().ideal(resting()), world)
    np.testing.assert_array_equal(recording.accel, np.tile(reading, (4, 1)))


def test_an_imu_file_from_ned_enters_with_gravity_up() -> None:
    ned = ImuRecording(T, ZERO, np.tile([0.0, 0.0, -G], (4, 1)))
    np.testing.assert_array_equal(to_enu_flu(ned, "ned-frd").accel, np.tile([0.0, 0.0, G], (4, 1)))


def test_matlab_reads_minus_one_when_pushed_forward_by_one() -> None:
    # MathWorks' own example: accelerating north at 1 m/s^2, imuSensor reads (-1, 0, 9.81).
    pushed = Motion(T, ZERO, ZERO, np.tile(NORTH, (4, 1)), resting(NORTH).R_NB, ZERO, ZERO)
    np.testing.assert_allclose(
        from_enu_flu(Imu().ideal(pushed), "matlab").accel[0], [-1.0, 0.0, G], atol=1e-15
    )


def test_a_right_turn_is_positive_about_down_and_negative_about_up() -> None:
    right_turn = np.tile([0.0, 0.0, -0.3], (4, 1))
    ours = ImuRecording(T, right_turn, ZERO)
    np.testing.assert_array_equal(from_enu_flu(ours, "ned-frd").gyro[:, 2], 0.3)
    np.testing.assert_array_equal(from_enu_flu(ours, "nwu").gyro[:, 2], -0.3)


@pytest.mark.parametrize(("world", "nose_north_yaw"), [("ned-frd", 0.0), ("matlab", 0.0), ("nwu", 0.0)])
def test_heading_north_is_zero_yaw_where_north_is_x(world: str, nose_north_yaw: float) -> None:
    theirs = from_enu_flu(resting(NORTH), world)
    np.testing.assert_allclose(theirs.euler[0], [0.0, 0.0, nose_north_yaw], atol=1e-15)


def test_heading_east_is_a_quarter_turn_right_in_ned_and_left_of_nothing_in_ours() -> None:
    np.testing.assert_allclose(from_enu_flu(resting(EAST), "ned-frd").euler[0, 2], np.pi / 2, atol=1e-15)
    np.testing.assert_allclose(from_enu_flu(resting(EAST), "nwu").euler[0, 2], -np.pi / 2, atol=1e-15)
    np.testing.assert_allclose(from_enu_flu(resting(EAST), "ros").euler[0, 2], 0.0, atol=1e-15)


def test_climbing_and_banking_as_pilots_have_them() -> None:
    """Nose up is positive pitch, right wing down positive roll in NED; our pitch has the other sign."""
    roll, pitch, yaw = 0.2, 0.1, 0.7
    ned = Poses(T, ZERO, np.tile(matrix_from_euler(np.array([roll, pitch, yaw])), (4, 1, 1)))
    R_NB = to_enu_flu(ned, "ned-frd").R_NB
    assert R_NB is not None
    nose, left = R_NB[0, :, 0], R_NB[0, :, 1]
    assert nose @ UP > 0.0
    assert left @ UP > 0.0
    np.testing.assert_allclose(np.arctan2(nose @ EAST, nose @ NORTH), yaw, rtol=1e-14)
    # Same angles but for the sign of pitch and a heading counted from east to the left.
    np.testing.assert_allclose(euler_from_matrix(R_NB[0]), [roll, -pitch, np.pi / 2 - yaw], rtol=1e-14)


@pytest.mark.parametrize(
    ("world", "p"), [("ned-frd", (2, 1, -3)), ("matlab", (2, 1, -3)), ("nwu", (2, -1, 3)), ("ros", (1, 2, 3))]
)
def test_one_east_two_north_three_up(world: str, p: tuple[float, ...]) -> None:
    here = Poses(T[:1], np.array([[1.0, 2.0, 3.0]]))
    np.testing.assert_array_equal(from_enu_flu(here, world).p_NB[0], p)


@pytest.mark.parametrize("world", WORLDS)
def test_there_and_back_is_the_same_to_the_bit(world: str, rng: np.random.Generator) -> None:
    motion = random_motion(rng)
    gyro, accel, mag = rng.normal(size=(3, 4, 3))
    accel[1] = np.nan
    recording = ImuRecording(T, gyro, accel, mag, t0_ns=7, name="r")
    poses = Poses(T, motion.p_NB, motion.R_NB, motion.v_NB)
    sigma = np.abs(motion.p_NB)
    attitude = AttitudeHistory(T, motion.R_NB, gyro, motion.a_NB, sigma, held=[0, 1, 0, 0])
    reference = Reference(T, motion.R_NB, [1, 0, 1, 1])
    bare = (Poses(T, motion.p_NB), AttitudeHistory(T, motion.R_NB))
    for data in (motion, recording, poses, attitude, reference, *bare):
        for there, back in ((from_enu_flu, to_enu_flu), (to_enu_flu, from_enu_flu)):
            again = back(there(data, world), world)
            for name in type(data).__slots__:
                np.testing.assert_array_equal(getattr(again, name), getattr(data, name), err_msg=name)


@pytest.mark.parametrize("world", ["ned-frd", "nwu", "ros"])
def test_the_physics_is_the_same_seen_from_any_world(world: str, rng: np.random.Generator) -> None:
    """Specific force from their motion and their gravity is their reading: R^T (a - g), to round-off."""
    motion = random_motion(rng)
    theirs = from_enu_flu(motion, world)
    gravity = from_enu_flu(Poses(T[:1], np.array([[0.0, 0.0, -G]])), world).p_NB[0]
    reading = np.einsum("nji,nj->ni", theirs.R_NB, theirs.a_NB - gravity)
    np.testing.assert_allclose(from_enu_flu(Imu().ideal(motion), world).accel, reading, atol=1e-14)
    # The rate of a rotation is the same whoever looks: dR = R [omega] dt keeps its form.
    step = 1e-6 * motion.omega_NB_B[0]
    later = Poses(T[:1], ZERO[:1], (motion.R_NB[0] @ exp_so3(step))[None])
    R_later = from_enu_flu(later, world).R_NB
    assert R_later is not None
    np.testing.assert_allclose(R_later[0], theirs.R_NB[0] @ exp_so3(1e-6 * theirs.omega_NB_B[0]), atol=1e-15)


@pytest.mark.parametrize("world", WORLDS)
def test_attitude_turns_as_the_motion_it_belongs_to(world: str, rng: np.random.Generator) -> None:
    motion = random_motion(rng)
    attitude = AttitudeHistory(T, motion.R_NB, gyro_bias=motion.omega_NB_B, a_N=motion.a_NB)
    ours, theirs = from_enu_flu(attitude, world), from_enu_flu(motion, world)
    np.testing.assert_array_equal(ours.R_NS, theirs.R_NB)
    np.testing.assert_array_equal(ours.gyro_bias, theirs.omega_NB_B)
    np.testing.assert_array_equal(ours.a_N, theirs.a_NB)


def test_a_deviation_north_is_one_north_in_any_world() -> None:
    known = AttitudeHistory(T, resting().R_NB, sigma=np.tile([1.0, 2.0, 3.0], (4, 1)))
    np.testing.assert_array_equal(from_enu_flu(known, "ned-frd").sigma[0], [2.0, 1.0, 3.0])
    np.testing.assert_array_equal(from_enu_flu(known, "nwu").sigma[0], [2.0, 1.0, 3.0])


def test_an_unknown_world_suggests_a_known_one() -> None:
    with pytest.raises(ValueError, match="Did you mean 'ned-frd'"):
        to_enu_flu(resting(), "ned_frd")


def test_the_deviation_of_noise_follows_its_axis_and_has_no_sign() -> None:
    ours = ImuRecording(T, ZERO, ZERO, gyro_noise=[1.0, 2.0, 3.0], accel_noise=0.5)
    for world in WORLDS:
        theirs = from_enu_flu(ours, world)
        np.testing.assert_array_equal(theirs.gyro_noise, [1.0, 2.0, 3.0])
        np.testing.assert_array_equal(theirs.accel_noise, [0.5, 0.5, 0.5])
