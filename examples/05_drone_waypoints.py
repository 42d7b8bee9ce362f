"""A drone through waypoints, as fast as its limits let it: banked in the turns, with a stop to look around.

The path passes through every point; the limits hold everywhere on it; and what the autopilot's IMU feels has no
sideways part, because every turn is banked just right.
"""

import matplotlib.pyplot as plt
import numpy as np

from kreisel import Imu, Mount, WaypointTrajectory
from kreisel.show import plot_path, save

east, north, up = (
    [0, 15, 25, 15, 0, -12, -12, -4],
    [0, 5, 20, 35, 38, 25, 10, 2],
    [2, 6, 8, 8, 6, 5, 3, 2],
)  # m
points = np.column_stack([east, north, up])
flight = WaypointTrajectory(
    None,  # no times: the limits say how fast
    points,
    orientation="level",
    banked=True,
    stop=[2, 0, 0, 2, 0, 0, 0, 2],  # s
    max_speed=8,  # m/s
    max_acceleration=4,  # m/s^2
    max_jerk=10,  # m/s^3
    minimum="snap",
    name="drone through waypoints",
)
motion = flight.sample(np.arange(0, flight.span[1], 0.005))
mount = Mount(p_BS=[0.02, 0, 0.03], name="autopilot")
recording = Imu(mount).ideal(motion)
miss = np.linalg.norm(flight.sample(flight.arrivals).p_NB - points, axis=1).max()
print(motion.notes[0].text)
print(f"farthest from a waypoint: {miss:.1g} m")
save(plot_path(motion, [mount]), "05_drone_waypoints.png")

figure, panels = plt.subplots(3, 1, figsize=(9, 7), sharex=True, layout="constrained")
panels[0].plot(motion.t, np.linalg.norm(motion.v_NB, axis=1))
panels[1].plot(motion.t, np.linalg.norm(motion.a_NB, axis=1))
panels[2].plot(motion.t, np.rad2deg(motion.euler[:, 0]))
for panel, what in zip(panels, ("speed [m/s]", "acceleration [m/s²]", "bank [deg]"), strict=True):
    panel.set_ylabel(what)
    panel.vlines(flight.arrivals, *panel.get_ylim(), color="0.8", zorder=0)
panels[2].set_xlabel("time [s]; grey: at the waypoints")
figure.savefig("05_drone_limits.png", dpi=144)
