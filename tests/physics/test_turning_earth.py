"""Physics on a turning Earth: what an IMU feels of it, as experiments with stones, ships and pendulums have it."""

from datetime import date

import numpy as np
import pytest

from kreisel.data.environment import Environment
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.estimate.strapdown import integrate
from kreisel.maths.earth import EARTH_RATE
from kreisel.maths.rotations import exp_so3, matrix_from_euler
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.line import line
from kreisel.simulate.trajectories.rest import rest

LATITUDE = np.deg2rad(48.0)
MUNICH = Environment.at(48.0, 11.0, 500.0, date(2026, 5, 1), turning=True)
EAST, NORTH, UP = np.eye(3)
# A turntable in place of the Earth: what would hide behind six zeros shows.
FAST = np.array([0.2, -0.3, 0.5])


def test_off_by_default_and_then_north_and_up():
    still = Environment.at(48.0, 11.0, 500.0, date(2026, 5, 1))
    assert not Environment().omega_IN_N.any() and not still.omega_IN_N.any()
    # g is the plumb line's either way: the centrifugal part was in it before.
    np.testing.assert_array_equal(MUNICH.g_N, still.g_N)
    rate = EARTH_RATE * np.array([0.0, np.cos(LATITUDE), np.sin(LATITUDE)])
    np.testing.assert_allclose(MUNICH.omega_IN_N, rate, rtol=1e-15)


def test_at_rest_an_imu_reads_the_earth_rate_and_g_up():
    R_NS = matrix_from_euler(np.array([0.3, -0.2, 1.0]))
    recording = Imu(environment=MUNICH).ideal(rest(phi=(0.3, -0.2, 1.0)).sample(np.arange(3.0)))
    np.testing.assert_allclose(recording.gyro, np.tile(R_NS.T @ MUNICH.omega_IN_N, (3, 1)), atol=1e-20)
    np.testing.assert_allclose(recording.accel, np.tile(-R_NS.T @ MUNICH.g_N, (3, 1)), atol=1e-14)


def test_a_gyrocompass_finds_north():
    heading = 0.7
    gyro = Imu(environment=MUNICH).ideal(rest(phi=(0.0, 0.0, heading)).sample(np.arange(2.0))).gyro[0]
    # Level: the rate lies in the plane of north and up, heading is counted from east to the left.
    assert np.pi / 2.0 - np.arctan2(gyro[1], gyro[0]) == pytest.approx(heading, abs=1e-12)


def test_who_goes_east_is_lighter_who_goes_west_heavier():
    """Eoetvoes 1919: 2 omega v cos(latitude); and to the right of the way, 2 omega v sin(latitude), Coriolis."""
    speed, t = 30.0, np.array([0.0, 1e-9])
    for sign in (1.0, -1.0):
        accel = Imu(environment=MUNICH).ideal(line((sign * speed, 0.0, 0.0)).sample(t)).accel[0]
        up, left = accel[2] + MUNICH.g_N[2], accel[1]
        assert up == pytest.approx(-sign * 2.0 * EARTH_RATE * speed * np.cos(LATITUDE), abs=1e-14)
        # The road pushes to the left, against the drift to the right.
        assert left == pytest.approx(2.0 * EARTH_RATE * speed * np.sin(LATITUDE), abs=1e-14)


def standing_in_space(t, p_I, v_I, omega):
    """A body on a straight line in inertial axes, which does not turn there, as N has it."""
    R_NI = exp_so3(-t[:, None] * omega)
    q = p_I + t[:, None] * v_I
    p, v = (np.einsum("nij,nj->ni", R_NI, x) for x in (q, np.broadcast_to(v_I, q.shape)))
    v = v - np.cross(omega, p)
    a = -2.0 * np.cross(omega, v) - np.cross(omega, np.cross(omega, p))
    return Motion(t, p, v, a, R_NI, -np.einsum("nij,i->nj", R_NI, omega), np.zeros_like(p))


@pytest.mark.parametrize("omega", [MUNICH.omega_IN_N, FAST], ids=["Earth", "turntable"])
def test_a_body_that_rests_in_inertial_space_feels_nothing_but_what_holds_it_against_gravity(omega):
    """Round and round in N, yet no rate, and no force beyond -g."""
    motion = standing_in_space(np.linspace(0.0, 20.0, 50), np.array([3.0, -2.0, 1.0]), np.zeros(3), omega)
    assert np.linalg.norm(motion.v_NB, axis=1).min() > 0.0
    recording = Imu(environment=Environment(omega_IN_N=omega)).ideal(motion)
    np.testing.assert_allclose(recording.gyro, 0.0, atol=1e-15)
    np.testing.assert_allclose(
        recording.accel, np.einsum("nij,i->nj", motion.R_NB, [0, 0, 9.80665]), atol=1e-14
    )
    weightless = Environment(g_N=[0.0, 0.0, 0.0], omega_IN_N=omega)
    flying = standing_in_space(motion.t, np.array([3.0, -2.0, 1.0]), np.array([1.0, 2.0, -1.0]), omega)
    # Terms up to 2 omega v + omega^2 p = 20 m/s^2 cancel.
    np.testing.assert_allclose(Imu(environment=weightless).ideal(flying).accel, 0.0, atol=1e-13)


def test_the_same_motion_reads_the_same_seen_from_axes_that_turn():
    """Nothing but the derivatives of two sets of functions: no Coriolis term is written here."""
    w = 0.4

    def place(turn):
        def at(t, shift):
            east, north = 3.0 * np.cos(1.3 * t), 2.0 * np.sin(0.9 * t)
            return east * np.cos(turn * t - shift) + north * np.sin(turn * t - shift)

        return (lambda t: at(t, 0.0), lambda t: at(t, -np.pi / 2.0), lambda t: np.sin(0.7 * t))

    def body(turn):
        phi = (lambda t: 0.5 * np.sin(t), lambda t: 0.4 * np.cos(1.1 * t), lambda t: 0.8 * t - turn * t)
        return FunctionTrajectory(place(turn), phi).sample(np.linspace(0.0, 10.0, 200))

    mount = Mount([0.1, -0.2, 0.3], matrix_from_euler(np.array([0.1, 0.2, 0.3])))
    still = Imu(mount).ideal(body(0.0))
    turning = Imu(mount, environment=Environment(omega_IN_N=w * UP)).ideal(body(w))
    # A dozen roundings of 20 m/s^2.
    np.testing.assert_allclose(turning.accel, still.accel, atol=1e-13)
    np.testing.assert_allclose(turning.gyro, still.gyro, atol=1e-14)


def test_the_plane_of_foucaults_pendulum_turns_and_nothing_pushes_it_sideways():
    """At the pole the bob swings in one plane in space: clockwise seen from above, once in a sidereal day."""
    pole, w0 = Environment.at(90.0, 0.0, 0.0, date(2026, 5, 1), turning=True), 0.38
    turn = float(pole.omega_IN_N[2])
    bob = FunctionTrajectory(
        (
            lambda t: 3.0 * np.cos(w0 * t) * np.cos(turn * t),
            lambda t: -3.0 * np.cos(w0 * t) * np.sin(turn * t),
            lambda t: 0.0 * t,
        ),
        (0.0, 0.0, 0.0),
    ).sample(np.linspace(0.0, 6.0 * 3600.0, 500))
    level = Imu(environment=pole).ideal(bob).accel[:, :2]
    np.testing.assert_allclose(level, -(w0**2) * bob.p_NB[:, :2], atol=1e-14)
    # Where N stood still, the same swing would need a sideways force.
    assert np.abs(Imu().ideal(bob).accel[:, :2] + w0**2 * bob.p_NB[:, :2]).max() > 1e-4


def test_a_falling_stone_lands_east_of_the_plumb_line():
    """Reich 1831 in a mine shaft at Freiberg: omega g t^3 cos(latitude) / 3."""
    t, g = np.linspace(0.0, 5.0, 51), -MUNICH.g_N[2]
    # A stone turns with the Earth until it is let go, and feels nothing from then on.
    stone = ImuRecording(t, np.zeros((51, 3)) + MUNICH.omega_IN_N, np.zeros((51, 3)))
    fall = integrate(stone, (np.zeros(3), np.zeros(3), np.eye(3)), MUNICH)
    east = EARTH_RATE * g * t**3 * np.cos(LATITUDE) / 3.0
    # And a little south: Coriolis on the eastward way, less what the centrifugal term loses with depth.
    north = -(EARTH_RATE**2) * g * t**4 * np.sin(LATITUDE) * np.cos(LATITUDE) * (1.0 / 6.0 - 1.0 / 24.0)
    assert 2e-6 < -north[-1] < 3e-6
    # The next terms are smaller by omega t = 4e-4 each.
    np.testing.assert_allclose(fall.p_NB[:, 0], east, atol=4e-4 * east[-1])
    np.testing.assert_allclose(fall.p_NB[:, 1], north, atol=4e-4 * -north[-1])
    np.testing.assert_allclose(fall.p_NB[:, 2], -0.5 * g * t**2, atol=4e-4 * east[-1])


@pytest.mark.parametrize("kind", ["ideal", "increments"])
def test_rest_stays_rest_for_an_hour(kind):
    """The Earth turns by 15 deg; a recording that did not know would lie on its side and fall."""
    t = np.arange(0.0, 3600.0, 0.5)
    motion = rest((0.0, 0.0, 0.0), (0.4, -0.3, 2.0)).sample(t)
    recording = getattr(Imu(environment=MUNICH), kind)(motion)
    back = integrate(recording, motion, MUNICH)
    # 7200 products of rotations, 1e-17 each in one direction, lean g: 1e-13 g t^2 / 2.
    np.testing.assert_allclose(back.R_NB, motion.R_NB, atol=1e-13)
    assert np.linalg.norm(back.p_NB, axis=1).max() < 6e-6
    unaware = integrate(recording, motion)
    assert np.linalg.norm(unaware.p_NB[-1]) > 1e6


def test_places_far_from_the_origin_are_refused_where_it_turns():
    utm = rest((691_000.0, 5_334_000.0, 500.0)).sample(np.arange(3.0))
    Imu().ideal(utm)
    for made in (Imu(environment=MUNICH).ideal, Imu(environment=MUNICH).increments):
        with pytest.raises(ValueError, match=r"p_NB lies up to 5\.33e\+06 m .* Subtract the place"):
            made(utm)
