"""A car once round the block, told as its driver would: drive, turn, stop at the light, wait, drive on.

Every segment begins and ends straight ahead; turns and accelerations come on within a second, so that what the
IMU behind the windscreen feels has no steps.
"""

import numpy as np

from kreisel import Imu, MotionProfile, Mount, Segment
from kreisel.show import plot_imu, plot_path, save

corner = Segment("turn", angle_deg=-90, radius=10)  # to the right
block = [
    Segment("rest", duration=3),
    Segment("drive", distance=60, speed=10, acceleration=2),
    Segment("drive", duration=4, speed=5),
    corner,
    Segment("drive", distance=60, speed=8, acceleration=1.5),
    Segment("stop", acceleration=2.5),  # at a traffic light
    Segment("rest", duration=6),
    Segment("drive", duration=4, speed=5),
    corner,
    Segment("drive", distance=90),
    corner,
    Segment("drive", distance=73.8, speed=8),
    Segment("drive", duration=2, speed=5),
    corner,
    Segment("stop", duration=3),
]
drive = MotionProfile(block, heading=np.pi / 2, name="car round the block")  # northwards
motion = drive.sample(np.arange(0, drive.span[1], 0.01))
mount = Mount(p_BS=[1.2, 0, 0.9], name="windscreen")  # m, from the middle of the rear axle
recording = Imu(mount).ideal(motion)

for segment, state in zip(block, drive.sample(drive.ends).p_NB, strict=True):
    print(f"{segment.do:6} to ({state[0]:6.1f}, {state[1]:6.1f}) m")
save(plot_path(motion, [mount]), "06_car_round_the_block.png")
save(plot_imu(recording), "06_car_imu.png")
