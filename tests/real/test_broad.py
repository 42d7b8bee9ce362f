"""The BROAD recordings at hand: in the frames they are said to be in, measured by the benchmark's formula."""

import numpy as np
import pytest

import kreisel
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.trial import Trial
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.maths.directions import attitude_from_accel_mag, to_global
from kreisel.maths.rotations import quat_wxyz_from_matrix


@pytest.fixture(scope="module")
def paths(shared_data):
    found = sorted((shared_data / "broad").glob("*.mat"))
    if not found:
        pytest.skip(f"no BROAD recordings in {shared_data / 'broad'}")
    return found


@pytest.fixture(scope="module")
def trial(paths):
    return kreisel.read(next(path for path in paths if "slow_rotation_B" in path.name))


def test_every_trial_reads_by_its_content(paths):
    for path in paths:
        trial = kreisel.read(path)
        assert isinstance(trial, Trial) and trial.name == path.stem
        assert trial.recording.mag_uT is not None
        assert 0.4 < trial.reference.counts.mean() < 0.9
        assert np.isfinite(trial.reference.R_NS[trial.reference.counts]).all()


def test_reference_and_imu_agree_on_up_and_on_the_rate_of_turn(trial):
    imu, R_NS = trial.recording, trial.reference.R_NS
    up = np.nanmean(to_global(R_NS, imu.accel), axis=0)
    # A sensor that ends where it began has no mean acceleration: gravity, up, to the accelerometer's bias.
    np.testing.assert_allclose(up, [0.0, 0.0, 9.81], atol=0.1)
    turned = np.einsum("nji,njk->nik", R_NS[:-1], R_NS[1:])
    rate = np.stack([turned[:, 2, 1], turned[:, 0, 2], turned[:, 1, 0]], axis=1) / np.diff(imu.t)[:, None]
    seen = np.isfinite(rate).all(axis=1)
    # A milliradian of camera noise over 3.5 ms hides little; a wrong sign or axis would give 0 or -1.
    correlation = [np.corrcoef(rate[seen, k], imu.gyro[:-1][seen, k])[0, 1] for k in range(3)]
    assert min(correlation) > 0.9


def test_north_of_the_reference_is_magnetic(trial):
    field = to_global(trial.reference.R_NS, trial.recording.mag_uT)
    east, north, up = np.nanmean(field, axis=0)
    assert abs(np.degrees(np.arctan2(east, north))) < 3.0
    assert up < 0.0 < north  # northern hemisphere: the field dips


def test_the_metric_is_the_benchmarks(trial):
    """Written once more from the paper, with quaternions and acos, for an estimate that is often wrong."""
    imu, reference = trial.recording, trial.reference
    estimate = AttitudeHistory(imu.t, attitude_from_accel_mag(imu.accel, imu.mag_uT))
    q_imu = quat_wxyz_from_matrix(estimate.R_NS)[reference.counts]
    q_opt = quat_wxyz_from_matrix(reference.R_NS[reference.counts])
    w = np.sum(q_imu * q_opt, axis=1)
    v_imu, v_opt = q_imu[:, 1:], q_opt[:, 1:]
    _, _, z = (q_opt[:, :1] * v_imu - q_imu[:, :1] * v_opt - np.cross(v_imu, v_opt)).T
    total = 2 * np.arccos(np.clip(np.abs(w), 0, 1))
    heading = 2 * np.arctan(np.abs(z / w))
    inclination = 2 * np.arccos(np.clip(np.sqrt(w**2 + z**2), 0, 1))

    s = attitude_errors(reference, estimate).summary()
    assert s.samples == len(w)
    for ours, theirs in (
        (s.total_rmse_deg, total),
        (s.heading_rmse_deg, heading),
        (s.inclination_rmse_deg, inclination),
    ):
        # acos of a number near one is good to 1e-8 rad a sample; the errors here are degrees.
        assert ours == pytest.approx(np.degrees(np.sqrt(np.mean(theirs**2))), rel=1e-9)


def test_a_clock_set_wrong_is_found_against_the_cameras(trial):
    imu = trial.recording
    late = AttitudeHistory(imu.t + 1.25, attitude_from_accel_mag(imu.accel, imu.mag_uT))
    found = attitude_errors(trial.reference, late, clock_offset="estimate").removed.clock
    # Attitude without a gyro is degrees off when the sensor accelerates; two periods of 3.5 ms.
    assert found == pytest.approx(1.25, abs=0.007)
