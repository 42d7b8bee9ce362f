"""Sampled poses become a motion: as exact as the samples allow, whatever form their attitude comes in."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kreisel.data.motion import Mount
from kreisel.maths.rotations import exp_so3, quat_wxyz_from_matrix
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.sampled import SampledTrajectory
from tests.truth import LEVER_ARM, Truth, truth

RATE = 200.0
T = np.arange(1001) / RATE
IMU = Imu(Mount(p_BS=np.array(LEVER_ARM)))


@pytest.fixture(scope="module")
def case() -> dict[str, Truth]:
    return {name: truth(name, T) for name in "AB"}


def errors(trajectory: SampledTrajectory, exact: Truth) -> dict[str, float]:
    """Largest errors of accelerometer and gyro, inside (5 % dropped at each end) and over all."""
    reading = IMU.ideal(trajectory.sample(exact.t))
    accel = np.abs(reading.accel - exact.accel).max(axis=1)
    gyro = np.abs(reading.gyro - exact.gyro).max(axis=1)
    cut = len(exact.t) // 20
    return {
        "accel": accel[cut:-cut].max(),
        "gyro": gyro[cut:-cut].max(),
        "accel ends": accel.max(),
        "gyro ends": gyro.max(),
    }


# What degree nine leaves of these motions at 200 Hz, with a margin of three to ten: mostly truncation at the
# ends, where a spline knows its neighbours on one side only.
@pytest.mark.parametrize(
    ("name", "source", "limits"),
    [
        ("A", "tangent", {"accel": 1e-8, "accel ends": 1e-5, "gyro": 1e-9, "gyro ends": 1e-6}),
        ("A", "poses", {"accel": 1e-5, "accel ends": 0.1, "gyro": 1e-6, "gyro ends": 2e-3}),
        ("B", "poses", {"accel": 1e-9, "accel ends": 1e-6, "gyro": 1e-11, "gyro ends": 1e-10}),
    ],
)
@pytest.mark.parametrize("method", ["spline", "auto"])
def test_clean_samples_give_the_exact_readings(case, name, source, limits, method):
    exact = case[name]
    orientation = "tangent" if source == "tangent" else exact.R_NB
    found = errors(SampledTrajectory(T, exact.p_NB, orientation, method), exact)
    assert {k: v for k, v in found.items() if v > limits[k]} == {}


def test_every_form_of_attitude_gives_the_same_motion(case, rng):
    exact = case["B"]
    rotation = Rotation.from_matrix(exact.R_NB)
    wxyz = rotation.as_quat(scalar_first=True)
    flipped = wxyz * rng.choice([-1.0, 1.0], (len(T), 1))
    # Roll and heading by any number of turns; pitch beyond one would be taken for degrees.
    turns = rng.integers(-2, 3, (len(T), 3)) * [1, 0, 1]
    wrapped = rotation.as_euler("ZYX")[:, ::-1] + 2.0 * np.pi * turns
    reference = SampledTrajectory(T, exact.p_NB, exact.R_NB).sample(T)
    for orientation, order in [
        (rotation, None),
        (wxyz, "wxyz"),
        (flipped, "wxyz"),
        (rotation.as_quat(), "xyzw"),
        (wrapped, None),
    ]:
        motion = SampledTrajectory(T, exact.p_NB, orientation, order=order).sample(T)
        np.testing.assert_allclose(motion.R_NB, reference.R_NB, rtol=0, atol=1e-14)
        # Round-off of 1e-15 in a quaternion, twice differentiated at the ends of a spline of degree nine.
        np.testing.assert_allclose(motion.omega_NB_B, reference.omega_NB_B, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("phi", "what"), [((0.0, 45.0, 0.0), "phi_y reaches 45"), ((0.0, 0.0, 500.0), "an angle steps by 350")]
)
def test_angles_that_look_like_degrees_draw_a_warning(phi, what):
    t = np.arange(50) / 10.0
    angles = np.outer(np.ones(50), phi) if phi[1] else (np.outer(t, phi) * 0.2) % 360.0
    with pytest.warns(UserWarning, match=rf"{what}: are these degrees\? Then give np\.deg2rad"):
        SampledTrajectory(t, np.zeros((50, 3)), angles)


def test_an_order_that_is_none_is_refused_whatever_the_orientation():
    with pytest.raises(ValueError, match="order must be one of 'wxyz', 'xyzw'; got 'foo'"):
        SampledTrajectory(T, np.zeros((len(T), 3)), "tangent", order="foo")


def test_slow_poses_give_a_fast_imu():
    """20 Hz poses, 400 Hz IMU: six samples a turn of the fastest part are few, a slow path is no problem."""

    def path(t):
        return np.stack([2.0 * np.cos(t), 2.0 * np.sin(t), 0.1 * np.sin(2.0 * t)], axis=1)

    slow, fast = np.arange(0.0, 10.01, 0.05), np.arange(0.0, 10.0, 0.0025)
    motion = SampledTrajectory(slow, path(slow), "tangent").sample(fast)
    np.testing.assert_allclose(motion.p_NB, path(fast), rtol=0, atol=1e-9)
    exact_a = np.stack([-2 * np.cos(fast), -2 * np.sin(fast), -0.4 * np.sin(2 * fast)], axis=1)
    # Truncation at the ends; (0.05 s x 2 rad/s)^8 of 0.4 m/s^2.
    np.testing.assert_allclose(motion.a_NB, exact_a, rtol=0, atol=1e-6)


def test_uneven_steps_do_no_harm(case, rng):
    t = T + np.concatenate([[0.0], rng.uniform(-0.4, 0.4, len(T) - 2) / RATE, [0.0]])
    exact = truth("B", t)
    found = errors(SampledTrajectory(t, exact.p_NB, exact.R_NB), exact)
    # Steps of up to 1.8 times the even one: up to 1.8^8 of the truncation, on 1e-9 at the most.
    assert found["accel"] < 1e-6
    assert found["gyro"] < 1e-9


def test_noise_is_smoothed_and_named(case, rng):
    exact = case["B"]
    noisy_R = exact.R_NB @ exp_so3(np.deg2rad(0.01) * rng.normal(size=(len(T), 3)))
    trajectory = SampledTrajectory(T, exact.p_NB + 1e-4 * rng.normal(size=(len(T), 3)), noisy_R)
    motion = trajectory.sample()
    position_note, attitude_note = motion.notes
    assert re.search(r"smoothed: noise of 0\.(09\d*|1|10|11) mm", position_note.text)
    assert "smoothed" in attitude_note.text
    reading = IMU.ideal(motion)
    rms = np.sqrt(np.mean((reading.accel - exact.accel) ** 2))
    # Interpolating these samples leaves 42 m/s^2, central differences 4.3; ten times less is asked for.
    assert rms < 0.45


def test_velocities_of_the_source_are_used_where_positions_are_noisy(case, rng):
    exact = case["B"]
    noisy = exact.p_NB + 1e-3 * rng.normal(size=(len(T), 3))
    velocity = exact.v_NB + 1e-3 * rng.normal(size=(len(T), 3))
    helped = SampledTrajectory(T, noisy, exact.R_NB, velocity=velocity).sample()
    alone = SampledTrajectory(T, noisy, exact.R_NB).sample()
    assert "velocities" in helped.notes[0].text
    error = [np.sqrt(np.mean((m.a_NB - exact.a_NB) ** 2)) for m in (helped, alone)]
    assert error[0] < 0.5 * error[1]


def test_sampling_in_parts_gives_the_same_motion(case):
    exact = case["A"]
    trajectory = SampledTrajectory(T, exact.p_NB, exact.R_NB)
    whole, part = trajectory.sample(T), trajectory.sample(T[300:310])
    for field in ("p_NB", "v_NB", "a_NB", "R_NB", "omega_NB_B", "alpha_NB_B"):
        np.testing.assert_array_equal(getattr(whole, field)[300:310], getattr(part, field))


def test_gradient_is_the_documents_scheme_at_the_samples(case):
    exact = case["B"]
    trajectory = SampledTrajectory(T, exact.p_NB, exact.R_NB, "gradient")
    motion = trajectory.sample()
    dt = 1.0 / RATE
    inner = (exact.p_NB[2:] - exact.p_NB[:-2]) / (2.0 * dt)
    np.testing.assert_allclose(motion.v_NB[1:-1], inner, rtol=1e-9)
    np.testing.assert_allclose(motion.v_NB[0], (exact.p_NB[1] - exact.p_NB[0]) / dt, rtol=1e-9)
    with pytest.raises(ValueError, match="sample times only"):
        trajectory.sample(T[:-1] + 0.001)


def test_inputs_stay_as_they_were(case):
    p, q = case["B"].p_NB.copy(), quat_wxyz_from_matrix(case["B"].R_NB)
    before = p.copy(), q.copy()
    SampledTrajectory(T, p, q, order="wxyz").sample()
    np.testing.assert_array_equal(p, before[0])
    np.testing.assert_array_equal(q, before[1])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"position": np.zeros((3, 1001))},
            r"position must be \(n, 3\); got \(3, 1001\). Did you mean position.T",
        ),
        ({"position": np.full((1001, 3), np.inf)}, "position must be finite; row 0"),
        ({"position": np.full((1001, 3), np.nan)}, "at least 6 samples of positions; got 0"),
        ({"t": T[::-1]}, "runs back"),
        ({"t": np.zeros(1001)}, "stands still"),
        ({"t": T[:5], "position": np.zeros((5, 3))}, "at least 6 samples of positions; got 5"),
        ({"orientation": np.ones((1001, 4))}, "need order="),
        ({"orientation": np.ones((1001, 4)), "order": "wxyz"}, "row 0 has length 2"),
        ({"orientation": np.ones((1001, 3, 3))}, "rotation matrices at row 0"),
        ({"orientation": np.diag([1.0, 1.0, -1.0]) * np.ones((1001, 1, 1))}, "mirrors"),
        ({"orientation": "tangetn"}, "Did you mean 'tangent'"),
        ({"orientation": np.ones((1001, 5))}, r"got shape \(1001, 5\)"),
        ({"method": "splin"}, "Did you mean 'spline'"),
        ({"velocity": np.ones((1000, 3))}, "1000 rows for 1001 stamps"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(change, message):
    arguments = {"t": T, "position": np.ones((1001, 3)), "orientation": "tangent"} | change
    with pytest.raises(ValueError, match=message):
        SampledTrajectory(**arguments)


def test_times_outside_the_samples_are_refused(case):
    trajectory = SampledTrajectory(T, case["B"].p_NB)
    with pytest.raises(ValueError, match=r"0 to 5 s; row 0 is -0.1"):
        trajectory.sample([-0.1, 0.0])
