"""The lying eight: 0.8 cos, 0.8 sin cos, 0.3 cos 3, with the nose along the path and two IMUs on the body."""

import numpy as np

from kreisel import Imu, Mount, lying_eight
from kreisel.show import plot_path, save

t = np.arange(0, 2, 0.005)  # s, once round
motion = lying_eight(period=2.0).sample(t)

mounts = [Mount(p_BS=[-75e-3, -75e-3, 25e-3], name="tail"), Mount(p_BS=[150e-3, 0, 0], name="nose")]  # m
for mount in mounts:
    recording = Imu(mount).ideal(motion)
    print(
        f"IMU at the {mount.name}: up to {np.linalg.norm(recording.gyro, axis=1).max():.1f} rad/s "
        f"and {np.linalg.norm(recording.accel, axis=1).max() / 9.80665:.1f} g"
    )

save(plot_path(motion, mounts), "04_lying_eight.png")
