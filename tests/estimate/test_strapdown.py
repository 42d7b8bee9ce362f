"""Strapdown integration: what falls, rests, turns and cones comes out where physics has it."""

from dataclasses import replace

import numpy as np
import pytest

from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.estimate.strapdown import integrate
from kreisel.maths.rotations import log_so3, matrix_from_euler
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.coning import coning
from kreisel.simulate.trajectories.lissajous import lissajous
from tests.truth import LEVER_ARM, truth

G = 9.80665
T = np.arange(1001) / 200.0
ORIGIN = (np.zeros(3), np.zeros(3), np.eye(3))


def recording(t, gyro=(0.0, 0.0, 0.0), accel=(0.0, 0.0, 0.0)):
    return ImuRecording(t, np.tile(gyro, (len(t), 1)), np.tile(accel, (len(t), 1)))


def apart(a, b):
    """Largest distance in position and velocity, m and m/s, and largest angle, rad, between two motions."""
    turn = log_so3(a.R_NB @ np.swapaxes(b.R_NB, -1, -2))
    return tuple(np.linalg.norm(x, axis=1).max() for x in (a.p_NB - b.p_NB, a.v_NB - b.v_NB, turn))


@pytest.fixture(scope="module")
def cases():
    """Case A and B at 200 Hz from 50-digit arithmetic: the sensor's motion and its recording."""
    made = {}
    for name in "AB":
        exact = truth(name, T)
        columns = (exact.p_NB, exact.v_NB, exact.a_NB, exact.R_NB, exact.omega_NB_B, exact.alpha_NB_B)
        body = Motion(T, *columns)
        made[name] = body, ImuRecording(T, exact.gyro, exact.accel)
    return made


MOUNT = Mount(LEVER_ARM)


def test_free_fall_is_a_parabola():
    t = np.array([0.0, 0.1, 0.15, 0.4, 1.0])
    fall = integrate(recording(t), (np.array([0.0, 0.0, 100.0]), np.array([3.0, 0.0, 0.0]), np.eye(3)))
    np.testing.assert_allclose(fall.p_NB[:, 0], 3.0 * t, atol=1e-14)
    np.testing.assert_allclose(fall.p_NB[:, 2], 100.0 - 0.5 * G * t * t, rtol=1e-15)
    np.testing.assert_allclose(fall.v_NB[:, 2], -G * t, atol=1e-14)
    np.testing.assert_array_equal(fall.a_NB, np.tile([0.0, 0.0, -G], (5, 1)))


def test_rest_stays_put_for_an_hour():
    R = matrix_from_euler(np.array([0.4, -0.3, 2.0]))
    still = integrate(recording(np.arange(36_000) / 10.0, accel=R.T @ [0.0, 0.0, G]), (*ORIGIN[:2], R))
    # A rounding of 1e-15 m/s^2 in the specific force, one sign all along: 1e-15 t^2 / 2.
    assert np.linalg.norm(still.p_NB, axis=1).max() < 2e-8
    np.testing.assert_allclose(still.R_NB, np.tile(R, (36_000, 1, 1)), atol=1e-14)


def test_a_steady_circle_closes_at_any_rate():
    """Constant rate and constant pull inwards: ten samples a round are as good as a thousand."""
    speed, radius = 2.0, 0.5
    rate = speed / radius
    t = np.arange(101) * (2.0 * np.pi / rate / 10.0)
    start = (np.array([radius, 0.0, 0.0]), np.array([0.0, speed, 0.0]), np.eye(3))
    circle = integrate(recording(t, (0.0, 0.0, rate), (-speed * rate, 0.0, G)), start)
    place = radius * np.stack([np.cos(rate * t), np.sin(rate * t), 0 * t], axis=1)
    # Round-off of 100 steps in a velocity that gravity and the pull against it cross at 10 m/s^2 for 16 s.
    np.testing.assert_allclose(circle.p_NB, place, atol=1e-12)
    np.testing.assert_allclose(circle.a_NB, -(rate**2) * place, atol=1e-12)


def test_coning_does_not_drift():
    """Rates taken as constant between samples drift as theory has it; ours comes back to the cone."""
    half_angle, rate, t = 0.05, 20.0, np.arange(2001) / 200.0
    motion = coning(half_angle, rate).sample(t)
    _, _, turn = apart(integrate(Imu().ideal(motion), motion), motion)
    # Savage, Strapdown Analytics: half the area swept by the rate vector in every step.
    step = rate / 200.0
    drift = 0.5 * np.sin(half_angle) ** 2 * (step - np.sin(step)) * 2000
    assert drift > 4e-4
    # Sixth order: (0.1 rad)^4 of what second order leaves, and less.
    assert turn < 1e-6 * drift


@pytest.mark.parametrize(
    ("case", "position", "velocity", "attitude"), [("A", 1e-4, 2e-5, 2e-7), ("B", 2e-10, 1e-10, 1e-11)]
)
def test_rates_at_200_hz_return_the_trajectory(cases, case, position, velocity, attitude):
    """Three times what was measured. Case A bends within 40 ms, which 200 Hz can hardly show; case B is smooth."""
    body, rates = cases[case]
    p, v, turn = apart(integrate(rates, body.at(MOUNT)), body.at(MOUNT))
    assert p < position
    assert v < velocity
    assert turn < attitude


def test_rates_of_case_a_at_1000_hz_return_the_trajectory():
    body = lissajous().sample(np.arange(5001) / 1000.0)
    p, _, turn = apart(integrate(Imu(MOUNT).ideal(body), body.at(MOUNT)), body.at(MOUNT))
    # Measured 3e-12 m and 2e-13 rad; the goal was 1e-7 m.
    assert p < 1e-11
    assert turn < 1e-12


@pytest.mark.parametrize("case", ["A", "B"])
def test_increments_return_the_trajectory_to_round_off(cases, case):
    body, _ = cases[case]
    p, v, turn = apart(integrate(Imu(MOUNT).increments(body), body.at(MOUNT)), body.at(MOUNT))
    # A thousand sums of terms of order one.
    assert p < 2e-12
    assert v < 1e-12
    assert turn < 1e-13


@pytest.mark.parametrize(("case", "position"), [("A", 2e-7), ("B", 2e-12)])
def test_position_from_increments_without_dp_is_as_good_as_velocity_interpolates(cases, case, position):
    body, _ = cases[case]
    increments = replace(Imu(MOUNT).increments(body), dp=None)
    p, _, _ = apart(integrate(increments, body.at(MOUNT)), body.at(MOUNT))
    assert p < position


# The Earth at 48 deg north, and a turntable that turns 8000 times as fast.
TURNING = {"Earth": (0.0, 4.88e-5, 5.42e-5), "turntable": (0.2, -0.3, 0.5)}


@pytest.fixture(params=TURNING)
def turning(request):
    """An IMU off the centre of a body in a frame that turns."""
    return Imu(MOUNT, environment=Environment(omega_IN_N=TURNING[request.param]))


@pytest.mark.parametrize(
    ("case", "position", "velocity", "attitude"), [("A", 1e-4, 2e-5, 2e-7), ("B", 2e-10, 1e-10, 1e-11)]
)
def test_where_n_turns_rates_are_as_good_as_where_it_rests(
    cases, turning, case, position, velocity, attitude
):
    body, _ = cases[case]
    p, v, turn = apart(integrate(turning.ideal(body), body.at(MOUNT), turning.environment), body.at(MOUNT))
    assert p < position
    assert v < velocity
    assert turn < attitude


@pytest.mark.parametrize(("case", "without_dp"), [("A", 2e-7), ("B", 2e-12)])
def test_where_n_turns_increments_return_the_trajectory_to_round_off(cases, turning, case, without_dp):
    body, _ = cases[case]
    increments = turning.increments(body)
    p, v, turn = apart(integrate(increments, body.at(MOUNT), turning.environment), body.at(MOUNT))
    # As in a frame that rests.
    assert p < 2e-12
    assert v < 1e-12
    assert turn < 1e-13
    bare = integrate(replace(increments, dp=None), body.at(MOUNT), turning.environment)
    assert apart(bare, body.at(MOUNT))[0] < without_dp


def test_where_n_turns_rates_and_accelerations_are_those_in_n(cases, turning):
    body, _ = cases["B"]
    sensor, inside = body.at(MOUNT), slice(10, -10)
    for kind in ("ideal", "increments"):
        back = integrate(getattr(turning, kind)(body), sensor, turning.environment)
        # Slopes over 5 ms, as in a frame that rests.
        np.testing.assert_allclose(back.a_NB[inside], sensor.a_NB[inside], atol=1e-9)
        np.testing.assert_allclose(back.omega_NB_B[inside], sensor.omega_NB_B[inside], atol=1e-11)
        np.testing.assert_allclose(back.alpha_NB_B[inside], sensor.alpha_NB_B[inside], atol=1e-9)


def test_accelerations_and_rates_of_the_result_are_those_of_the_motion(cases):
    body, rates = cases["B"]
    sensor, inside = body.at(MOUNT), slice(10, -10)
    from_rates = integrate(rates, sensor)
    from_increments = integrate(Imu(MOUNT).increments(body), sensor)
    np.testing.assert_array_equal(from_rates.omega_NB_B, rates.gyro)
    # Specific force up to 130 m/s^2, turned by an attitude good to 4e-12.
    np.testing.assert_allclose(from_rates.a_NB, sensor.a_NB, atol=2e-9)
    # Slopes over 5 ms: 10th order leaves 1e-10 inside, a hundred times that at the ends.
    np.testing.assert_allclose(from_rates.alpha_NB_B[inside], sensor.alpha_NB_B[inside], atol=1e-9)
    np.testing.assert_allclose(from_increments.a_NB[inside], sensor.a_NB[inside], atol=1e-9)
    np.testing.assert_allclose(from_increments.omega_NB_B, sensor.omega_NB_B, atol=1e-9)
    np.testing.assert_allclose(from_increments.alpha_NB_B, sensor.alpha_NB_B, atol=1e-6)


def test_two_sensors_on_one_body_stay_a_lever_arm_apart(cases):
    body, rates = cases["B"]
    arm = integrate(rates, body.at(MOUNT))
    centre = integrate(Imu().ideal(body), body)
    np.testing.assert_allclose(arm.p_NB, centre.p_NB + centre.R_NB @ MOUNT.p_BS, atol=1e-9)


def test_uneven_steps_are_taken_as_they_are(rng):
    t = (np.arange(1001) + rng.uniform(-0.3, 0.3, 1001)) / 1000.0
    body = lissajous().sample(t)
    p, _, turn = apart(integrate(Imu(MOUNT).ideal(body), body.at(MOUNT)), body.at(MOUNT))
    # As even steps of 1.6 ms at worst; taking them as even would cost 0.3 ms times 5 m/s.
    assert p < 1e-8
    assert turn < 1e-9


def test_a_gap_is_bridged_and_noted(cases):
    body, rates = cases["B"]
    kept = np.delete(np.arange(1001), np.arange(400, 410))
    holed = ImuRecording(T[kept], rates.gyro[kept], rates.accel[kept])
    bridged = integrate(holed, body.at(MOUNT))
    turn = log_so3(bridged.R_NB[-1] @ body.R_NB[-1].T)
    # A chord across these 55 ms misses 3e-3 rad (trapezoid); ten samples around them miss 8e-7.
    assert np.linalg.norm(turn) < 1e-5
    assert [(note.kind, note.t) for note in bridged.notes] == [("gap", T[399])]
    assert integrate(rates, body.at(MOUNT)).notes == ()


def test_attitude_stays_a_rotation_over_many_steps():
    t = np.arange(200_000) / 1000.0
    R = integrate(recording(t, (3.0, -2.0, 1.0)), ORIGIN).R_NB
    assert np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max() < 1e-14


def test_gravity_is_the_environments():
    moon = Environment(g_N=np.array([0.0, 0.0, -1.62]))
    fall = integrate(recording(np.array([0.0, 1.0])), ORIGIN, moon)
    np.testing.assert_allclose(fall.v_NB[-1], [0.0, 0.0, -1.62])


def test_one_sample_is_where_it_began():
    alone = integrate(recording(np.array([2.0]), (1.0, 0.0, 0.0), (0.0, 0.0, G)), ORIGIN)
    np.testing.assert_array_equal(alone.p_NB, [[0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(alone.alpha_NB_B, [[0.0, 0.0, 0.0]])
    none = integrate(ImuIncrements([2.0], np.empty((0, 3)), np.empty((0, 3))), ORIGIN)
    assert len(none) == 1


def test_the_start_is_looked_up_by_absolute_time(cases):
    body, rates = cases["B"]
    epoch = 1_700_000_000_000_000_000
    later = ImuRecording(T[400:] - 2.0, rates.gyro[400:], rates.accel[400:], t0_ns=epoch + 2_000_000_000)
    sensor = replace(body.at(MOUNT), t0_ns=epoch)
    found = integrate(later, sensor)
    np.testing.assert_array_equal(found.p_NB[0], sensor.p_NB[400])
    told = integrate(later, (sensor.p_NB[400], sensor.v_NB[400], sensor.R_NB[400]))
    np.testing.assert_array_equal(found.p_NB, told.p_NB)
    assert found.t0_ns == later.t0_ns


def test_a_motion_that_does_not_reach_the_start_is_refused(cases):
    body, _ = cases["B"]
    with pytest.raises(ValueError, match=r"initial must have a row at the recording's first stamp, 7 s"):
        integrate(recording(np.array([7.0, 8.0])), body)


def holed(column):
    columns = {"gyro": np.zeros((4, 3)), "accel": np.zeros((4, 3))}
    columns[column] = np.where(np.arange(4)[:, None] == 2, np.nan, columns[column])
    return ImuRecording(np.arange(4.0), **columns)


@pytest.mark.parametrize("column", ["gyro", "accel"])
def test_missing_samples_are_named_with_the_cure(column):
    with pytest.raises(
        ValueError, match=f"{column} must be finite to be integrated; row 2 .* Leave such rows out"
    ):
        integrate(holed(column), ORIGIN)


def test_missing_increments_are_named_and_cannot_be_left_out():
    increments = ImuIncrements(np.arange(3.0), [[0, 0, 0], [np.nan] * 3], np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"dtheta must be finite .* row 1 .* lost"):
        integrate(increments, ORIGIN)


@pytest.mark.parametrize(
    ("what", "initial", "error", "message"),
    [
        (recording(np.empty(0)), ORIGIN, ValueError, "no samples"),
        ("imu.csv", ORIGIN, TypeError, "ImuRecording or ImuIncrements; got str"),
        (
            recording(np.arange(2.0)),
            np.eye(2),
            TypeError,
            r"initial must be a Motion or \(p_NS, v_NS, R_NS\)",
        ),
        (recording(np.arange(2.0)), (np.zeros(2), *ORIGIN[1:]), ValueError, r"p_NS must be \(3,\)"),
        (
            recording(np.arange(2.0)),
            (*ORIGIN[:2], 2 * np.eye(3)),
            ValueError,
            "R_NS must hold rotation matrices",
        ),
    ],
)
def test_what_cannot_be_integrated_is_refused(what, initial, error, message):
    with pytest.raises(error, match=message):
        integrate(what, initial)
