"""The default DCM filter: what noise-free, faulty and disturbed recordings must give."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.run import run, run_both
from kreisel.maths.rotations import exp_so3
from tests.estimate.filters.turning import Array, angles_deg, tumbling, turning

FS = 100.0


def times(seconds: float, fs: float = FS) -> Array:
    return np.arange(round(seconds * fs) + 1) / fs


def spun(rest: float, ramp: float, rate_deg: float = 36.0) -> tuple[ImuRecording, Array]:
    """Rest, a ramp of the rate, ten turns in all, the ramp back, and as much rest."""
    turn = 3600.0 / rate_deg
    t = times(2.0 * rest + turn + ramp)
    rate = np.interp(t, [rest, rest + ramp, rest + turn, rest + turn + ramp], [0.0, rate_deg, rate_deg, 0.0])
    gyro = np.zeros((len(t), 3))
    gyro[:, 2] = np.radians(rate)
    # Sampling the ramp's corners is exact to round-off, for they lie on samples; rates then stand for intervals.
    return turning(t, gyro)


def test_ten_turns_come_back() -> None:
    t = times(100.0)
    recording, truth = turning(t, np.tile([0.0, 0.0, np.radians(36.0)], (len(t), 1)))
    history = run(DcmFilter(mode="6"), recording)
    relative = history.R_NS[-1] @ history.R_NS[0].T
    assert angles_deg(relative, truth[-1] @ truth[0].T)[0] < 0.01


@pytest.mark.parametrize("ramp", [0.01, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0])
@pytest.mark.parametrize("rate_deg", [10.0, 36.0, 360.0])
def test_ten_turns_after_rest_come_back(ramp: float, rate_deg: float) -> None:
    # A bias of 2e-4 deg/s, learned from the first moments of the motion, would miss this in 100 s.
    recording, truth = spun(3.0, ramp, rate_deg)
    history = run(DcmFilter(mode="6"), recording)
    assert history.rest is not None and history.rest[290]
    error = angles_deg(history.R_NS @ history.R_NS[0].T, truth @ truth[0].T)[0]
    assert error[: -round(FS * 3.0)].max() < 0.02


@pytest.mark.parametrize("mode", ["9", "6", "gyro"])
def test_truth_stays_truth(mode: Any, rng: np.random.Generator) -> None:
    t = times(120.0)
    recording, truth = turning(t, tumbling(t, rng, rate=3.0), exp_so3(rng.normal(size=3)))
    history = run(DcmFilter(mode=mode), recording, R_NS=truth[0])
    # 12 000 steps of 1e-16 and corrections that average them: 1e-12; the contract leaves room.
    assert np.radians(angles_deg(history.R_NS, truth)[0]).max() < 1e-9


def test_first_samples_are_the_first_attitude(rng: np.random.Generator) -> None:
    recording, truth = turning(times(1.0), np.zeros((101, 3)), exp_so3(rng.normal(size=3)))
    history = run(DcmFilter(), recording)
    assert angles_deg(history.R_NS, truth)[0].max() < 1e-6


def test_a_late_magnetometer_turns_the_heading_at_once(rng: np.random.Generator) -> None:
    recording, truth = turning(times(4.0), np.zeros((401, 3)), exp_so3(rng.normal(size=3)))
    assert recording.mag_uT is not None
    mag = np.array(recording.mag_uT)
    mag[:200] = np.nan
    total, _, inclination = angles_deg(
        run(DcmFilter(), dataclasses.replace(recording, mag_uT=mag)).R_NS, truth
    )
    assert inclination.max() < 1e-6
    assert total[200:].max() < 1e-6


def test_declination_turns_the_answer_to_true_north(rng: np.random.Generator) -> None:
    d = np.radians(11.0)
    east_of_north = np.array([18.0 * np.sin(d), 18.0 * np.cos(d), -44.0])
    t = times(30.0)
    recording, truth = turning(t, tumbling(t, rng), field=east_of_north)
    assert angles_deg(run(DcmFilter(declination=d), recording).R_NS, truth)[0].max() < 1e-6
    # Against magnetic north the same recording heads 11 degrees too far west, from the first sample to the last.
    heading = angles_deg(run(DcmFilter(), recording).R_NS, truth)[1]
    assert heading == pytest.approx(11.0, abs=1e-6)


def test_six_and_nine_dof_come_from_one_pass(rng: np.random.Generator) -> None:
    t = times(60.0)
    recording, truth = turning(t, tumbling(t, rng), exp_so3(np.array([0.0, 0.0, 1.0])))
    nine, six = run_both(DcmFilter(), recording)
    alone = run(DcmFilter(mode="6"), recording)
    assert angles_deg(nine.R_NS, truth)[0].max() < 1e-6
    # Nothing here tells the two apart: no bias to learn, and a heading that starts at zero.
    assert angles_deg(six.R_NS, alone.R_NS)[0].max() < 1e-6


def test_a_given_attitude_of_six_digits_stands_for_the_nearest_rotation(rng: np.random.Generator) -> None:
    recording, truth = turning(times(1.0), np.zeros((101, 3)), exp_so3(rng.normal(size=3)))
    rough = truth[0] + rng.uniform(-3e-7, 3e-7, (3, 3))
    for filter in (DcmFilter(mode="gyro"), DcmFilter.as_published(mode="gyro")):
        R = run(filter, recording, R_NS=rough).R_NS
        assert np.abs(R @ R.swapaxes(1, 2) - np.eye(3)).max() < 1e-12
        assert np.abs(R[0] - rough).max() < 1e-6


def test_the_longest_window_stays_orthonormal() -> None:
    # Always the same turn, so that its roundings add up instead of averaging out.
    t = times(40.0, 1000.0)
    recording = ImuRecording(t, np.tile([1.1, -0.7, 0.3], (len(t), 1)), np.tile([0.0, 0.0, 9.8], (len(t), 1)))
    R = run(DcmFilter(mode="gyro", window=10.0), recording, R_NS=np.eye(3)).R_NS
    assert np.abs(R @ R.swapaxes(1, 2) - np.eye(3)).max() < 1e-12
    with pytest.raises(ValueError, match="window must be at most 10 s"):
        DcmFilter(window=11.0)


def test_stays_orthonormal_for_a_million_steps(rng: np.random.Generator) -> None:
    t = times(1000.0, 1000.0)
    gyro, accel, mag = (rng.normal(size=(len(t), 3)) for _ in range(3))
    for mode in ("9", "gyro"):
        R = run(DcmFilter(mode=mode), ImuRecording(t, 5.0 * gyro, 10.0 * accel, mag_uT=40.0 * mag)).R_NS[-1]
        # Each window makes the rows orthonormal again; between two, 200 steps of 1e-16 add up.
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-12
