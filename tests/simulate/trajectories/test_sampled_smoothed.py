"""Noisy poses give readings that know how good they are, and say what was wrong with the samples."""

import re
from pathlib import Path

import numpy as np
import pytest

from kreisel.data.frames import from_enu_flu, to_enu_flu
from kreisel.data.motion import Motion, Mount
from kreisel.files.doors import read, write
from kreisel.maths.rotations import exp_so3, quat_wxyz_from_matrix
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.sampled import SampledTrajectory

T = np.arange(1001) / 200.0
IMU = Imu(Mount(p_BS=np.array([-0.075, -0.075, 0.025])))
POSITION, ATTITUDE = 1e-4, np.deg2rad(0.01)
W = 2.0 * np.pi


@pytest.fixture(scope="module")
def sway() -> Motion:
    """Case B."""
    place = (lambda t: 0.8 * np.cos(W * t), lambda t: 0.8 * np.sin(W * t), lambda t: 0.3 * np.cos(3 * W * t))
    turn = (lambda t: 0.8 * np.cos(W * t), lambda t: 0.8 * np.sin(W * t), lambda t: 0.3 * np.cos(W * t))
    return FunctionTrajectory(place, turn).sample(T)


def noisy(
    truth: Motion, rng: np.random.Generator, position: object = POSITION, attitude: object = ATTITUDE
) -> tuple[np.ndarray, np.ndarray]:
    p = truth.p_NB + position * rng.normal(size=(len(truth), 3))
    return p, truth.R_NB @ exp_so3(attitude * rng.normal(size=(len(truth), 3)))


def covered(trajectory: SampledTrajectory, truth: Motion, imu: Imu = IMU) -> tuple[float, float]:
    """Share of accelerometer and gyro inside their 95 % intervals."""
    exact, found = imu.ideal(truth), imu.ideal(trajectory.sample(truth.t))
    return tuple(
        float(np.nanmean(np.abs(getattr(found, s) - getattr(exact, s)) < 1.96 * getattr(found, f"{s}_sigma")))
        for s in ("accel", "gyro")
    )


def test_standard_errors_of_the_readings_are_honest(sway, rng):
    """The whole, with 200 draws, is in benchmarks/bench_smooth.py: 0.972 and 0.955 for A, 0.976 and 0.962 for B."""
    loop = lissajous().sample(T)
    for truth in (sway, loop):
        shares = np.mean([covered(SampledTrajectory(T, *noisy(truth, rng)), truth) for _ in range(4)], axis=0)
        # Some forty independent places per axis of 5 s: four draws know a share of 0.95 to 0.01.
        assert (shares > 0.90).all() and (shares < 0.995).all()


def test_a_turned_sensor_and_a_body_along_its_path_have_them_too(sway, rng):
    turned = Imu(Mount([0.3, -0.2, 0.1], exp_so3(np.array([[0.4, -0.8, 1.2]]))[0]))
    assert min(covered(SampledTrajectory(T, *noisy(sway, rng)), sway, turned)) > 0.88
    loop = lissajous().sample(T)
    p, _ = noisy(loop, rng)
    assert min(covered(SampledTrajectory(T, p, "tangent"), loop)) > 0.88


def test_a_body_carried_along_its_path_has_them(rng):
    place = (lambda t: np.cos(t), lambda t: np.sin(2 * t), lambda t: 0.3 * np.cos(t))
    truth = FunctionTrajectory(place, "transport").sample(T)
    shares = []
    for _ in range(4):
        p, _ = noisy(truth, rng)
        motion = SampledTrajectory(T, p, "transport").sample()
        error, known = motion.omega_NB_B - truth.omega_NB_B, motion.omega_sigma
        assert known[:, 0].max() < 1e-12  # the rate about the nose is nil by construction
        shares.append(np.mean(np.abs(error[:, 1:]) < 1.96 * known[:, 1:]))
    # A handful of independent places in each: of 48 draws the shares are 0.958 and scatter by 0.035, the mean of four
    # by half of it.
    assert np.mean(shares) > 0.87


def test_the_sensor_at_the_mount_and_the_motion_at_the_mount_agree(sway, rng):
    mount = Mount([0.3, -0.2, 0.1], exp_so3(np.array([[0.4, -0.8, 1.2]]))[0])
    motion = SampledTrajectory(T, *noisy(sway, rng)).sample()
    direct, moved = Imu(mount).ideal(motion), Imu().ideal(motion.at(mount))
    np.testing.assert_allclose(moved.accel, direct.accel, atol=1e-10)
    np.testing.assert_allclose(moved.gyro_sigma, direct.gyro_sigma, rtol=1e-9)
    # The sum over the axes is the same; which axis has which part of the lever arm's is forgotten.
    totals = [np.linalg.norm(r.accel_sigma, axis=1) for r in (moved, direct)]
    np.testing.assert_allclose(*totals, rtol=0.02)


def test_noise_is_found_per_axis(sway, rng):
    p, R = noisy(sway, rng, np.array([1e-4, 3e-4, 1e-4]), ATTITUDE * np.array([1.0, 1.0, 4.0]))
    trajectory = SampledTrajectory(T, p, R)
    # A thousand samples: 2.2 %; axes of the body turn against each other while one smoothness serves all.
    np.testing.assert_allclose(trajectory.position_smoothing.sigma, [1e-4, 3e-4, 1e-4], rtol=0.15)
    np.testing.assert_allclose(trajectory.attitude_smoothing.sigma, ATTITUDE * np.array([1, 1, 4]), rtol=0.3)
    position, attitude = trajectory.sample().notes
    assert re.search(r"noise of 0\.\d+ / 0\.\d+ / 0\.\d+ mm found", position.text)
    assert re.search(r"noise of 0\.\d+ / 0\.\d+ / 0\.\d+ deg found", attitude.text)
    shares = covered(trajectory, sway)
    assert min(shares) > 0.85


def test_noise_that_is_given_is_taken_and_compared(sway, rng):
    p, R = noisy(sway, rng)
    trajectory = SampledTrajectory(T, p, R, position_noise=[1e-4, 1e-4, 1e-4], attitude_noise=2 * ATTITUDE)
    np.testing.assert_array_equal(trajectory.attitude_smoothing.sigma, 2 * ATTITUDE)
    np.testing.assert_allclose(trajectory.attitude_smoothing.found, ATTITUDE, rtol=0.2)
    text = trajectory.sample().notes[1].text
    assert re.fullmatch(r"attitudes smoothed for noise of 0.02 deg; they show 0\.0\d+ deg", text)


def test_missing_rows_and_stamps_are_bridged_and_flagged(sway, rng):
    p, R = noisy(sway, rng)
    q = quat_wxyz_from_matrix(R)
    p[300:340] = np.nan
    q[600:620, 2] = np.nan
    trajectory = SampledTrajectory(T, p, q, order="wxyz")
    motion = trajectory.sample()
    assert len(motion) == len(T)
    found = {(n.kind, round(n.t, 3)) for n in motion.notes if n.t is not None}
    assert found == {("gap", 1.495), ("gap", 2.995)}
    assert motion.a_sigma[320].max() > 3.0 * motion.a_sigma[200].max()
    assert (np.abs(motion.a_NB - sway.a_NB)[300:340] < 5.0 * motion.a_sigma[300:340]).all()
    cut = np.r_[0:300, 340:1001]
    same = SampledTrajectory(T[cut], p[cut], q[cut], order="wxyz").sample(T)
    np.testing.assert_array_equal(same.a_NB, motion.a_NB)


def test_clean_samples_are_interpolated_over_a_gap(sway):
    p = sway.p_NB.copy()
    p[300:304] = np.nan
    motion = SampledTrajectory(T, p, sway.R_NB).sample()
    assert [n.kind for n in motion.notes] == ["method", "gap", "method"]
    assert motion.a_sigma is None
    # Degree nine over five steps at sixty samples a period: (0.1)^8 of 100 m/s^2, times a hundred at a gap.
    assert np.abs(motion.a_NB - sway.a_NB)[290:314].max() < 1e-3


def test_a_long_gap_is_refused_with_its_place_and_the_option(sway):
    p = sway.p_NB.copy()
    p[300:360] = np.nan
    with pytest.raises(ValueError, match=r"no positions from t = 1.495 to 1.8 s.*max_gap=0.31 \(--max-gap\)"):
        SampledTrajectory(T, p, sway.R_NB)
    motion = SampledTrajectory(T, p, sway.R_NB, max_gap=0.31).sample()
    assert ("gap", 1.495) in {(n.kind, n.t) for n in motion.notes}
    with pytest.raises(ValueError, match="bridges no gaps: positions must be finite; row 300"):
        SampledTrajectory(T, p, sway.R_NB, "gradient")


def test_slow_samples_have_no_gaps():
    t = np.arange(30.0)
    motion = SampledTrajectory(t, np.stack([np.sin(0.1 * t), 0 * t, 0 * t], axis=1)).sample()
    assert not [n for n in motion.notes if n.kind == "gap"]


def test_missing_ends_shorten_the_span(sway):
    p = sway.p_NB.copy()
    p[:10] = np.nan
    q = quat_wxyz_from_matrix(sway.R_NB)
    q[-5:] = np.nan
    trajectory = SampledTrajectory(T, p, q, order="wxyz")
    assert trajectory.span == (T[10], T[-6])
    assert len(trajectory.sample()) == len(T) - 15


def test_mistakes_of_motion_capture_are_told(sway, rng):
    p, R = noisy(sway, rng)
    p[[200, 500]] += 0.02
    p[700:] += [0.03, 0.0, 0.0]
    R[400] = R[400] @ exp_so3(np.array([[0.3, 0.0, 2.0]]))[0]
    trajectory = SampledTrajectory(T, p, R)
    motion = trajectory.sample()
    told = {(n.kind, round(n.t, 4)): n.text for n in motion.notes if n.t is not None}
    assert set(told) == {("outlier", 1.0), ("jump", 3.4975), ("outlier", 2.0)}
    assert told["outlier", 1.0].startswith(
        "2 of 1001 positions do not fit and were set aside, at t = 1, 2.5 s"
    )
    assert told["jump", 3.4975].startswith("positions jump by 30 mm")
    np.testing.assert_array_equal(trajectory.position_smoothing.outliers, [1.0, 2.5])
    reading, exact = IMU.ideal(motion), IMU.ideal(sway)
    # 0.13 for clean samples; each interruption costs a little.
    assert np.sqrt(np.mean(np.square(reading.accel - exact.accel))) < 0.3


def test_a_turned_sign_is_no_outlier_even_after_one(sway, rng):
    p, R = noisy(sway, rng)
    q = quat_wxyz_from_matrix(R)
    q[400] = rng.normal(size=4)
    q[400] -= q[399] * (q[399] @ q[400]) - 0.02 * q[399]
    q[400] /= np.linalg.norm(q[400])
    q *= rng.choice([-1.0, 1.0], (len(T), 1))
    trajectory = SampledTrajectory(T, p, q, order="wxyz")
    np.testing.assert_array_equal(trajectory.attitude_smoothing.outliers, [2.0])
    assert not trajectory.attitude_smoothing.jumps.size
    np.testing.assert_allclose(trajectory.sample().omega_NB_B, sway.omega_NB_B, atol=0.2)


def test_slow_poses_give_a_fast_imu(sway, rng):
    """20 Hz behind noise: case B's three hertz are seven samples a period, and come through."""
    slow = slice(None, None, 10)
    p, R = noisy(sway, rng)
    motion = SampledTrajectory(T[slow], p[slow], R[slow]).sample(T[50:-50])
    reading, exact = IMU.ideal(motion), IMU.ideal(sway.rows(slice(50, -50)))
    # 0.09 measured, as at 200 Hz: fewer samples, but motion and noise are alike from a lower frequency on.
    assert np.sqrt(np.mean(np.square(reading.accel - exact.accel))) < 0.3


def test_an_attitude_that_turns_faster_than_it_is_sampled_is_told(rng):
    """Case A bends within 40 ms: at 20 Hz that cannot be told from noise of degrees."""
    loop = lissajous().sample(np.arange(200) / 20.0)
    notes = SampledTrajectory(loop.t, *noisy(loop, rng), "smooth").sample().notes
    assert "the samples are too far apart to show it" in notes[1].text


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"position_noise": 0.0}, r"position_noise must be above 0, in m; got 0.0. Leave it out"),
        ({"position_noise": [1e-3, -1e-3, 1e-3]}, "position_noise must be above 0"),
        ({"attitude_noise": np.nan}, "attitude_noise must be"),
        ({"attitude_noise": [1.0, 2.0]}, "one number or three"),
        ({"attitude_noise": 1e-3, "orientation": "tangent"}, "no attitude is measured"),
        ({"position_noise": 1e-3, "method": "spline"}, "position_noise is for smoothing; method 'spline'"),
        ({"max_gap": -1.0}, "max_gap must be one number, 0 or more, in s"),
    ],
)
def test_options_that_cannot_be_are_refused(sway, options, message):
    arguments = {"t": T, "position": sway.p_NB, "orientation": sway.R_NB} | options
    with pytest.raises(ValueError, match=message):
        SampledTrajectory(**arguments)


@pytest.mark.parametrize("name", ["csv", "npz", "mat"])
def test_standard_errors_survive_files_and_other_worlds(sway, rng, tmp_path: Path, name):
    motion = SampledTrajectory(T, *noisy(sway, rng)).sample(T[::50])
    for data in (motion, IMU.ideal(motion)):
        there = from_enu_flu(data, "ned-frd")
        write(tmp_path / f"held.{name}", there)
        back = to_enu_flu(read(tmp_path / f"held.{name}"), "ned-frd")
        for field in ("theta_sigma", "a_sigma", "omega_sigma", "alpha_sigma", "gyro_sigma", "accel_sigma"):
            if hasattr(data, field):
                np.testing.assert_array_equal(getattr(back, field), getattr(data, field))
