"""The error-state filter: what recordings with and without errors must give, and whether sigma is honest."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters.mekf import MekfFilter
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.run import run, run_both
from kreisel.maths.rotations import exp_so3
from tests.estimate.filters.turning import Array, angles_deg, tumbling, turning

FS = 100.0


def times(seconds: float, fs: float = FS) -> Array:
    return np.arange(round(seconds * fs) + 1) / fs


def worn(seconds: float, rng: np.random.Generator, rest: float = 5.0) -> tuple[ImuRecording, Array]:
    """Rest, then tumbling by hand, with the noise of a phone's sensors."""
    t = times(seconds)
    recording, truth = turning(t, tumbling(t, rng, rate=3.0) * np.clip(t - rest, 0.0, 1.0)[:, None])
    assert recording.mag_uT is not None
    noisy = dataclasses.replace(
        recording,
        gyro=recording.gyro + rng.normal(0.0, np.radians(0.1), truth.shape[:2]),
        accel=recording.accel + rng.normal(0.0, 0.05, truth.shape[:2]),
        mag_uT=recording.mag_uT + rng.normal(0.0, 0.5, truth.shape[:2]),
    )
    return noisy, truth


@pytest.mark.parametrize("mode", ["9", "6", "gyro"])
def test_truth_stays_truth(mode: Any, rng: np.random.Generator) -> None:
    t = times(120.0)
    recording, truth = turning(t, tumbling(t, rng, rate=3.0), exp_so3(rng.normal(size=3)))
    history = run(MekfFilter(mode=mode), recording, R_NS=truth[0])
    # 12 000 steps of 1e-16 and corrections that average them: 1e-12; the contract leaves room.
    assert np.radians(angles_deg(history.R_NS, truth)[0]).max() < 1e-9


def test_a_first_attitude_of_a_few_digits_stands_for_the_nearest_rotation(rng: np.random.Generator) -> None:
    recording, truth = worn(1.0, rng)
    R = run(MekfFilter(), recording, R_NS=np.round(truth[0] @ exp_so3(rng.normal(size=3)), 7)).R_NS
    assert np.abs(R @ R.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12


def test_stays_orthonormal_for_a_million_steps(rng: np.random.Generator) -> None:
    t = times(1000.0, 1000.0)
    gyro, accel, mag = (rng.normal(size=(len(t), 3)) for _ in range(3))
    history = run(MekfFilter(), ImuRecording(t, 5.0 * gyro, 10.0 * accel, mag_uT=40.0 * mag))
    # Each window makes the rows orthonormal again; between two, 100 steps of 1e-16 add up.
    assert np.abs(history.R_NS[-1] @ history.R_NS[-1].T - np.eye(3)).max() < 1e-12
    assert history.sigma is not None and np.isfinite(history.sigma).all()


def test_the_covariance_stays_one(rng: np.random.Generator) -> None:
    filter, (recording, _) = MekfFilter(), worn(200.0, rng)
    assert recording.mag_uT is not None
    state, out = filter.start(), Columns.room_for(filter, (len(recording),))
    inputs = recording.t, recording.gyro, recording.accel, recording.mag_uT
    filter.batch(state, filter.parameters(), *inputs, out)
    P = state[at.COVARIANCE : at.COVARIANCE + at.ERRORS**2].reshape(at.ERRORS, at.ERRORS)
    scale = np.sqrt(np.outer(np.diag(P), np.diag(P))) + 1e-30
    # Round-off of 2000 windows, relative to the variances.
    assert np.abs(P - P.T).max() < 1e-12
    assert np.linalg.eigvalsh(P / scale).min() > -1e-9


def test_bias_is_learned_in_motion(rng: np.random.Generator) -> None:
    bias = np.radians([0.5, -0.4, 0.3])
    recording, truth = worn(180.0, rng, rest=0.0)
    history = run(MekfFilter(), dataclasses.replace(recording, gyro=recording.gyro + bias))
    assert history.gyro_bias is not None
    # A sixth of the bias; bias_drift lets it wander by 0.05 deg/s in 25 s.
    assert np.abs(np.degrees(history.gyro_bias[-1] - bias)).max() < 0.08
    assert angles_deg(history.R_NS, truth)[0][9000:].max() < 1.5


def test_an_accelerometer_that_is_late_is_found_out(rng: np.random.Generator) -> None:
    recording, truth = worn(120.0, rng, rest=0.0)
    late = 2  # samples, 20 ms
    t = recording.t
    # Swung about at the end of an arm: the acceleration turns with the body, and does not average out where it is late.
    push = 8.0 * np.sin(2.0 * np.pi * 1.3 * t)[:, None] * np.array([1.0, 0.5, 0.0])
    accel = recording.accel + push
    shifted = np.concatenate([accel[:late], accel[:-late]])
    errors = [
        angles_deg(
            run(MekfFilter(lag_spread=spread), dataclasses.replace(recording, accel=shifted)).R_NS, truth
        )
        for spread in (1e-6, 0.02)
    ]
    rms = [np.sqrt(np.mean(inclination[6000:] ** 2)) for _, _, inclination in errors]
    assert rms[1] < rms[0]


def test_iron_on_the_body_is_seen_and_hardly_believed(rng: np.random.Generator) -> None:
    recording, truth = worn(120.0, rng)
    assert recording.mag_uT is not None
    near = (recording.t > 60.0) & (recording.t < 90.0)
    iron = np.where(near[:, None], [12.0, -15.0, 8.0], 0.0)
    history = run(MekfFilter(), dataclasses.replace(recording, mag_uT=recording.mag_uT + iron))
    assert history.disturbed is not None
    assert history.disturbed[near][100:].mean() > 0.95
    assert not history.disturbed[(recording.t > 12.0) & ~near & (recording.t < 60.0)].any()
    # 21 uT across a horizontal field of 18 is 50 degrees of heading.
    assert angles_deg(history.R_NS, truth)[1][1200:].max() < 3.0


def test_no_magnetometer_drifts_and_says_so(rng: np.random.Generator) -> None:
    recording, truth = worn(120.0, rng)
    history = run(MekfFilter(mode="6"), recording)
    assert history.sigma is not None
    assert angles_deg(history.R_NS, truth)[2][1000:].max() < 1.0
    assert np.degrees(history.sigma[-1, 2]) > 10.0 > np.degrees(history.sigma[-1, 0])


def test_sigma_is_about_what_the_error_is() -> None:
    """Mean square of error over sigma, over 40 recordings of 30 s: 1 where sigma is honest."""
    ratios = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        recording, truth = worn(30.0, rng)
        assert recording.mag_uT is not None
        # Iron of 0.8 uT, an accelerometer's bias of 0.03 m/s^2, a gyro's of 0.3 deg/s, a scale of 0.4 %.
        imperfect = dataclasses.replace(
            recording,
            gyro=recording.gyro * (1.0 + rng.normal(0.0, 0.004, 3)) + np.radians(rng.normal(0.0, 0.3, 3)),
            accel=recording.accel + rng.normal(0.0, 0.03, 3),
            mag_uT=recording.mag_uT + rng.normal(0.0, 0.8, 3),
        )
        history = run(MekfFilter(), imperfect)
        assert history.sigma is not None
        E = history.R_NS @ truth.transpose(0, 2, 1)
        small = 0.5 * np.stack(
            [E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0], E[:, 1, 0] - E[:, 0, 1]], axis=1
        )
        ratios.append(np.mean((small / history.sigma)[500:] ** 2))
    # Always the same 40. Within a factor of ten: a body that does not travel is better known than sigma, which
    # allows for one that does, and a room that is perfectly even better than one that is not.
    assert 0.1 < np.mean(ratios) < 2.0


def test_six_and_nine_dof_come_from_one_pass(rng: np.random.Generator) -> None:
    t = times(60.0)
    recording, truth = turning(t, tumbling(t, rng), exp_so3(np.array([0.0, 0.0, 1.0])))
    nine, six = run_both(MekfFilter(), recording)
    assert angles_deg(nine.R_NS, truth)[0].max() < 1e-6
    assert nine.sigma is not None and np.array_equal(nine.sigma, run(MekfFilter(), recording).sigma)
    # That of the heading without the magnetometer is not in the state.
    assert six.sigma is None
    assert angles_deg(six.R_NS, run(MekfFilter(mode="6"), recording).R_NS)[0].max() < 1e-6


def test_declination_turns_the_answer_to_true_north(rng: np.random.Generator) -> None:
    d = np.radians(11.0)
    t = times(30.0)
    recording, truth = turning(
        t, tumbling(t, rng), field=np.array([18.0 * np.sin(d), 18.0 * np.cos(d), -44.0])
    )
    assert angles_deg(run(MekfFilter(declination=d), recording).R_NS, truth)[0].max() < 1e-6


def test_unknown_modes_and_impossible_tuning_are_refused() -> None:
    with pytest.raises(ValueError, match="mode must be one of"):
        MekfFilter(mode="12")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="span must not be negative"):
        MekfFilter(span=-1.0)
    with pytest.raises(ValueError, match="tail must be finite"):
        MekfFilter(tail=np.inf)


def test_sigma_of_a_vehicle_allows_for_its_accelerations() -> None:
    """Speeding up and braking at 2 m/s^2 for four seconds at a time tips the answer, and sigma says by how much."""
    ratios = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        t = times(90.0)
        turn = 0.2 * np.sin(2.0 * np.pi * rng.uniform(0.02, 0.05) * t)
        recording, truth = turning(t, turn[:, None] * np.array([0.0, 0.0, 1.0]))
        square = np.sign(np.sin(2.0 * np.pi * t / 8.0 + rng.uniform(0.0, 2.0 * np.pi)))
        push = 2.0 * np.where(t > 5.0, square, 0.0)
        accel = recording.accel + push[:, None] * np.array([1.0, 0.0, 0.0])
        noisy = dataclasses.replace(
            recording,
            gyro=recording.gyro + rng.normal(0.0, np.radians(0.1), accel.shape),
            accel=accel + rng.normal(0.0, 0.05, accel.shape),
        )
        history = run(MekfFilter(), noisy)
        assert history.sigma is not None
        E = history.R_NS @ truth.transpose(0, 2, 1)
        tilt = 0.5 * np.stack([E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0]], axis=1)
        ratios.append(np.mean((tilt / history.sigma[:, :2])[3000:] ** 2))
    # Always the same ten; 1 where sigma is honest, of either sign by a factor of five or less.
    assert 0.2 < np.mean(ratios) < 3.0
