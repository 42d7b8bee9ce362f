"""The default DCM filter on the BROAD recordings at hand, beside vqf on the same ones."""

import numpy as np
import pytest

import kreisel
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.trial import Trial
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.run import run
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.maths.rotations import matrix_from_quat_wxyz


@pytest.fixture(scope="module")
def trials(shared_data):
    found = [kreisel.read(path) for path in sorted((shared_data / "broad").glob("*.mat"))]
    if not found:
        pytest.skip(f"no BROAD recordings in {shared_data / 'broad'}")
    return found


def rmse_deg(trial: Trial, estimate: AttitudeHistory) -> tuple[float, float]:
    """Total and inclination, as the benchmark has them: nothing aligned."""
    errors = attitude_errors(trial.reference, estimate)
    counts = errors.counts
    return tuple(
        float(np.degrees(np.sqrt(np.mean(x[counts] ** 2)))) for x in (errors.total, errors.inclination)
    )


def vqf_history(trial: Trial) -> AttitudeHistory:
    vqf = pytest.importorskip("vqf", reason="vqf comes with the extra [oracle]")
    imu = trial.recording
    filter = vqf.VQF(float(np.diff(imu.t).mean()))
    answer = filter.updateBatch(*(np.array(x) for x in (imu.gyro, imu.accel, imu.mag_uT)))
    return AttitudeHistory(imu.t, matrix_from_quat_wxyz(answer["quat9D"]))


def test_one_setting_serves_all_trials(trials):
    total = np.array([rmse_deg(trial, run(DcmFilter(), trial.recording))[0] for trial in trials])
    # 1.66 measured on ten trials, which no change of a parameter by a factor of two (1.4 for accel_time) lifts
    # above 1.9.
    assert total.mean() < 1.9


def test_better_than_vqf_and_never_much_worse(trials):
    ours = np.array([rmse_deg(trial, run(DcmFilter(), trial.recording)) for trial in trials])
    theirs = np.array([rmse_deg(trial, vqf_history(trial)) for trial in trials])
    # Measured 0.77 and 0.90; the worst trial is 0.7 deg behind.
    assert ours[:, 0].mean() < 0.98 * theirs[:, 0].mean()
    assert ours[:, 1].mean() < 1.05 * theirs[:, 1].mean()
    assert (ours[:, 0] - theirs[:, 0]).max() < 1.0
