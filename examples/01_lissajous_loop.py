"""The loop of the document's figure 1: a body along its path, and the IMU it carries off its centre of mass.

MATLAB's @(t) becomes lambda t:, and cos and sin come from NumPy. Everything is differentiated exactly.
"""

import numpy as np

from kreisel import FunctionTrajectory, Imu, Mount
from kreisel.show import plot_path, save

f = 1.0  # Hz
s = (
    lambda t: 0.8 * np.cos(2 * np.pi * f * t),  # m, east
    lambda t: 0.8 * np.sin(2 * np.pi * f * t),  # m, north
    lambda t: 0.3 * np.cos(2 * np.pi * 3 * f * t),  # m, up
)
r = [-75e-3, -75e-3, 25e-3]  # m, from the centre of mass to the IMU: behind, right, above

t = np.arange(0, 5, 0.005)  # s, 200 Hz
motion = FunctionTrajectory(s, orientation="tangent", name="loop of figure 1").sample(t)
mount = Mount(p_BS=r, name="imu")
recording = Imu(mount).ideal(motion)

print("t [s]   gyro [rad/s]              accel [m/s^2], +g up at rest")
for k in range(0, 200, 40):
    print(f"{t[k]:.3f}  {recording.gyro[k].round(3)}  {recording.accel[k].round(2)}")

save(plot_path(motion, [mount]), "01_lissajous_loop.png")
