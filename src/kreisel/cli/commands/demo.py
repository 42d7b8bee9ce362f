"""Turns a built-in path into files to look at: `kreisel demo`."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np

from kreisel.cli.outputs import aligned, describe_notes, write_simulation

HELP = "the main job on a built-in path: the loop of the document's figure 1"
SENSOR, SEED = "bmi088", 7


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "-o", "--output", default="kreisel-demo", metavar="FOLDER", help="default: kreisel-demo"
    )


def run(args: Namespace) -> int:
    """Simulate 5 s of figure 1's loop at 200 Hz with the IMU off the centre of mass, and write it all."""
    from kreisel.data.motion import Mount
    from kreisel.simulate.trajectories.lissajous import lissajous
    from kreisel.study.sensor import record_all, sensor_imu

    started = time.perf_counter()
    motion = lissajous().sample(np.arange(1001) / 200.0)
    mount = Mount(p_BS=np.array([-0.075, -0.075, 0.025]))
    folder = Path(args.output)
    recordings, recorded = record_all([sensor_imu(SENSOR, mount)], motion, SEED)
    lines = write_simulation(folder, motion, [mount], recordings, recorded=recorded, animation=True)
    print("A body flies the loop of figure 1 (0.8 x 0.8 x 0.3 m, 1 Hz), its nose along the path.")
    print(
        "An IMU sits 75 mm behind, 75 mm to the right of and 25 mm above its centre of mass: 5 s at 200 Hz."
    )
    print(
        f"It is a {SENSOR.upper()} with the noise, bias, range and steps of its datasheet (kreisel sensors {SENSOR})."
    )
    for line in describe_notes(motion.notes):
        print(line)
    print(f"\nMade in {time.perf_counter() - started:.1f} s:")
    print(aligned(lines))
    print("\nNext, with a file of your own (time, position and, if you have it, attitude):")
    print("  kreisel info poses.csv")
    print("  kreisel simulate poses.csv -o out/ --imu=-0.075,-0.075,0.025 --sensor bmi088")
    return 0
