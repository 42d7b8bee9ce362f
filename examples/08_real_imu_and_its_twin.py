"""A real IMU against its simulated twin: where it sat, how it was turned, how late its stamps are.

    python 08_real_imu_and_its_twin.py real.csv poses.csv

Without files a "real" IMU is made up: a BMI088, mounted askew, its stamps 30 ms ahead of the cameras'.
"""

import sys

import numpy as np

from kreisel import Clock, FunctionTrajectory, Imu, Mount, Poses, SampledTrajectory, align, read
from kreisel.maths.rotations import matrix_from_euler
from kreisel.show import plot_twin, save


def made_up():
    """A recording and the poses that cameras saw, with 0.2 mm of noise."""
    path = (lambda t: 0.5 * np.sin(3 * t), lambda t: 0.4 * np.cos(4 * t), lambda t: 0.3 * np.sin(5 * t))
    turns = (lambda t: 0.8 * np.sin(4 * t), lambda t: 0.6 * np.cos(3 * t), lambda t: 0.9 * np.sin(2 * t))
    motion = FunctionTrajectory(path, turns).sample(np.arange(0, 20, 0.005))
    mount = Mount([0.05, -0.03, 0.02], matrix_from_euler(np.deg2rad([10.0, -20.0, 90.0])), "BMI088")
    imu = Imu.from_preset("bmi088", mount=mount, clock=Clock(offset=0.03))
    noise = 2e-4 * np.random.default_rng(8).normal(size=motion.p_NB.shape)
    return imu.record(motion, rng=8).measured, Poses(motion.t, motion.p_NB + noise, motion.R_NB)


if len(sys.argv) > 2:
    recording, poses = read(sys.argv[1], kind="imu"), read(sys.argv[2], kind="poses")
else:
    recording, poses = made_up()

found = align(recording, SampledTrajectory.from_poses(poses))
print(found)
save(plot_twin(recording, found), "08_real_imu_and_its_twin.png")
