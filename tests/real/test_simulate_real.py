"""Real poses through the command line: the motion is theirs, and the noise is not."""

import numpy as np
import pytest
from scipy.signal import butter, filtfilt

from kreisel.cli.main import main
from kreisel.files.doors import read


def rms(x):
    return float(np.sqrt(np.mean(np.sum(np.square(x), axis=1))))


def low_passed_acceleration(poses, cutoff=8.0):
    """The differentiated path through a zero-phase low-pass: what is left when noise is cut off bluntly."""
    rate = 1.0 / np.median(np.diff(poses.t))
    a = np.gradient(np.gradient(poses.p_NB, poses.t, axis=0), poses.t, axis=0)
    return filtfilt(*butter(4, cutoff / (rate / 2.0)), a, axis=0)


@pytest.mark.parametrize(
    ("name", "note", "closeness"),
    [
        # EuRoC's own estimate moves by hundredths of a millimetre from row to row, and corrects itself by two tenths
        # now and then, which are told and taken off: 0.33 mm.
        ("euroc_V1_02_groundtruth.csv", "smoothed with the velocities", 3e-4),
        # Motion capture of a hand-held camera, with outliers of some millimetres.
        ("tum_freiburg1_xyz_groundtruth.txt", "smoothed", 1e-3),
    ],
)
def test_real_poses_give_believable_accelerations(shared_data, tmp_path, capsys, name, note, closeness):
    source = shared_data / "poses" / name
    assert main(["simulate", str(source), "-o", str(tmp_path), "--no-pictures"]) == 0
    assert note in capsys.readouterr().out
    poses, motion = read(source, kind="poses"), read(tmp_path / "truth.npz", kind="motion")
    recording = read(tmp_path / "imu.csv", kind="imu")
    np.testing.assert_array_equal(motion.t, poses.t)
    assert motion.t0_ns == poses.t0_ns == recording.t0_ns
    # Vibration above 8 Hz may add to the low-passed path; noise would add ten times as much.
    assert rms(motion.a_NB) < 1.5 * rms(low_passed_acceleration(poses))
    assert rms(motion.p_NB - poses.p_NB) < closeness
    # Averaged over half a minute or more a body that stays near its place feels gravity alone.
    f_N = np.einsum("nij,nj->ni", motion.R_NB, recording.accel)
    np.testing.assert_allclose(f_N.mean(axis=0), [0.0, 0.0, 9.80665], atol=0.1)


def test_euroc_flight_agrees_with_its_own_imu(shared_data, tmp_path):
    """Ground truth of the flight, differentiated, is what its IMU measured: the body frame is the IMU's."""
    folder = shared_data / "poses"
    assert (
        main(["simulate", str(folder / "euroc_V1_02_groundtruth.csv"), "-o", str(tmp_path), "--no-pictures"])
        == 0
    )
    ours, real = read(tmp_path / "imu.csv", kind="imu"), read(folder / "euroc_V1_02_imu.txt", kind="imu")
    offset = (ours.t0_ns - real.t0_ns) * 1e-9
    for mine, theirs, floor in [(ours.gyro, real.gyro, 0.05), (ours.accel, real.accel, 0.3)]:
        at = np.stack([np.interp(ours.t + offset, real.t, column) for column in theirs.T], axis=1)
        # Rotors shake the IMU well above the motions of the flight.
        difference = filtfilt(*butter(4, 5.0 / 100.0), at - mine, axis=0)
        # What is left are biases that wander; a wrong sign or frame leaves ten times as much.
        assert rms(difference - difference.mean(axis=0)) < floor
