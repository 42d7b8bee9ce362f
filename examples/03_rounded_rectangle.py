"""A rounded rectangle at constant speed: no acceleration on the sides, v^2 / r = 6.4 m/s^2 in the corners.

The rate of turn steps by v / r = 8 rad/s wherever a side meets a corner. An IMU off the centre of mass feels
an impulse there that no sample can carry; the notes of the motion say when.
"""

import numpy as np

from kreisel import Imu, Mount, rounded_rectangle
from kreisel.show import plot_imu, save

course = rounded_rectangle(length=1.0, width=1.0, radius=0.1, speed=0.8)  # m, m, m, m/s
t = np.arange(0, course.lap, 0.005)  # s, once round
motion = course.sample(t)
recording = Imu(Mount(name="rounded rectangle")).ideal(motion)

speed = np.linalg.norm(motion.v_NB, axis=1)
inwards = recording.accel[:, 1]  # y points left, and the turns are to the left
print(f"speed {speed.min():.3f} to {speed.max():.3f} m/s")
print(f"inward acceleration {inwards.min():.2f} on the sides, {inwards.max():.2f} m/s^2 in the corners")
for note in motion.notes:
    print(f"{note.t:.3f} s: {note.kind}")

save(plot_imu(recording), "03_rounded_rectangle.png")
