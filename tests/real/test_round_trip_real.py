"""Real flights there and back: what the smoothed path gives an IMU integrates to the same path."""

import numpy as np

from kreisel.data.motion import Motion, Mount
from kreisel.files.doors import read
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.sampled import SampledTrajectory
from kreisel.study.round_trip import round_trip

MOUNT = Mount([0.1, 0.05, -0.02])


def first_half_minute(poses) -> Motion:
    """The smoothed motion at the source's own stamps, which jitter."""
    t = poses.t[poses.t < poses.t[0] + 30.0]
    return SampledTrajectory.from_poses(poses).sample(t)


def test_euroc_comes_back_within_a_millimetre(shared_data):
    motion = first_half_minute(read(shared_data / "poses" / "euroc_V1_02_groundtruth.csv", kind="poses"))
    imu = Imu(MOUNT)
    errors = round_trip(imu.ideal(motion), motion.at(MOUNT))
    # Measured 0.2 mm: rotors shake the path up to where 200 Hz still sees it, between samples it is guessed.
    assert errors.position.max() < 1e-3
    assert errors.attitude.max() < 1e-6
    exact = round_trip(imu.increments(motion), motion.at(MOUNT))
    # Six thousand sums of round-off, integrated twice.
    assert exact.position.max() < 1e-10
    assert np.all(exact.attitude < 1e-12)
