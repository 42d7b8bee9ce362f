"""Motion capture to virtual IMU: noisy poses of cameras, and what a BMI088 on the wrist would have read.

The poses are made here, of a waving arm, so that the answer is known; a file of your own takes their place.
"""

import numpy as np

from kreisel import FunctionTrajectory, Imu, Mount, Poses, SampledTrajectory, read, write
from kreisel.maths.rotations import exp_so3
from kreisel.show import plot_imu, save

rng = np.random.default_rng(7)
wave = FunctionTrajectory(
    (
        lambda t: 0.30 * np.sin(4.0 * t),  # m, east
        lambda t: 0.15 * np.sin(8.0 * t),  # m, north
        lambda t: 1.2 + 0.1 * np.cos(8.0 * t),  # m, up
    ),
    (
        lambda t: 0.9 * np.sin(4.0 * t),
        lambda t: 0.5 * np.cos(3.0 * t),
        lambda t: 0.7 * np.sin(5.0 * t),
    ),  # rad
)
seen = wave.sample(np.arange(0, 10, 1 / 120))  # cameras at 120 Hz
p = seen.p_NB + 2e-4 * rng.normal(size=seen.p_NB.shape)  # 0.2 mm of noise
R = seen.R_NB @ exp_so3(2e-3 * rng.normal(size=seen.p_NB.shape))  # 0.1 deg
write("07_mocap.csv", Poses(seen.t, p, R))

trajectory = SampledTrajectory.from_poses(read("07_mocap.csv", kind="poses"))
motion = trajectory.sample(np.arange(0.5, 9.5, 0.005))  # IMU at 200 Hz
wrist = Mount(p_BS=[0.02, 0.0, 0.05], name="wrist")  # m, from the markers to the IMU
recorded = Imu.from_preset("bmi088", mount=wrist).record(motion, rng=1)

for note in motion.notes:
    print(note.text)
exact = Imu(wrist).ideal(wave.sample(motion.t))
for sensor, unit in (("gyro", "rad/s"), ("accel", "m/s^2")):
    off = getattr(recorded.ideal, sensor) - getattr(exact, sensor)
    print(f"{sensor}: {np.sqrt(np.mean(off**2)):.3f} {unit} RMS from what the exact motion gives")

save(plot_imu(recorded.measured, recorded.ideal), "07_virtual_imu_from_mocap.png")
