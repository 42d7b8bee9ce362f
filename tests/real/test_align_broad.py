"""Real recordings against simulated twins: what cameras saw of a hand-held IMU, and what it read.

The cameras ran at 120 Hz, the poses come interpolated to 286 Hz on straight lines, which they show themselves: every
third is taken. Everything else is as it comes, the same for all three.
"""

import json

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.evaluate.align import align
from kreisel.files.doors import read
from kreisel.simulate.trajectories.sampled import SampledTrajectory


@pytest.fixture(scope="module")
def found(shared_data):
    """Trial and alignment by number."""
    made = {}
    for number in ("07", "11", "16"):
        (path,) = (shared_data / "broad").glob(f"{number}_*.mat")
        trial = read(path)
        trajectory = SampledTrajectory.from_poses(trial.poses.thinned(120.0))
        made[number] = trial, align(trial.recording, trajectory)
    return made


@pytest.mark.parametrize(
    ("number", "gyro", "accel"),
    # Measured 0.074, 0.041, 0.053 rad/s and 0.47, 0.19, 0.28 m/s^2.
    [("07", 0.09, 0.58), ("11", 0.066, 0.28), ("16", 0.062, 0.37)],
)
def test_the_twin_reads_what_the_imu_reads(found, number, gyro, accel):
    trial, alignment = found[number]
    assert alignment.notes == ()
    assert alignment.gyro.samples > 50_000
    assert alignment.gyro.total_rmse < gyro and alignment.accel.total_rmse < accel
    assert (alignment.gyro.correlation > 0.98).all() and (alignment.accel.correlation > 0.97).all()
    # Also while it moves, without the minute of rest that flatters a mean; of the gyro of 16 there are 0.0626.
    moving = trial.reference.counts
    for sensor, limit in (("gyro", 1.02 * gyro), ("accel", accel)):
        difference = getattr(alignment.twin, sensor)[moving] - getattr(trial.recording, sensor)[moving]
        assert np.sqrt(np.nanmean(difference**2)) < limit


def test_one_imu_has_one_place_and_one_clock(found):
    """The same IMU on the same plate in three trials: what is found in each agrees."""
    alignments = [alignment for _, alignment in found.values()]
    clocks = np.array([[a.gyro.clock, a.accel.clock] for a in alignments])
    # Stamps 4.2 ms ahead of the gyro's samples and 2.7 ms of the accelerometer's, within a twentieth of a step.
    np.testing.assert_allclose(clocks, [[4.2e-3, 2.7e-3]] * 3, atol=2e-4)
    places = np.array([a.mount.p_BS for a in alignments])
    assert np.ptp(places, axis=0).max() < 4e-3
    biases = np.array([a.gyro.bias for a in alignments])
    assert np.ptp(biases, axis=0).max() < 2e-3
    for a in alignments:
        # The markers' frame was turned onto the sensor's by the benchmark's authors.
        assert np.trace(a.mount.R_BS) > 1.0 + 2.0 * np.cos(0.01)


def test_the_cameras_rate_is_found(shared_data):
    for path in (shared_data / "broad").glob("*.mat"):
        # Half a minute to a minute of each tells their clock to a thirtieth of a hertz.
        assert read(path).poses.camera_rate() == pytest.approx(120.015, abs=0.03)


def test_poses_that_were_not_interpolated_have_none(shared_data):
    names = ("euroc_V1_02_groundtruth.csv", "tum_freiburg1_xyz_groundtruth.txt")
    assert [read(shared_data / "poses" / name, kind="poses").camera_rate() for name in names] == [None, None]


def test_the_command_needs_no_rate(shared_data, capsys):
    (path,) = (shared_data / "broad").glob("16_*.mat")
    assert main(["compare", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "straight lines from 120 Hz: 16708 of 50124 are taken" in found["notes"][0]
    assert found["gyro"]["rmse_all_axes"] < 0.062 and found["accel"]["rmse_all_axes"] < 0.37
