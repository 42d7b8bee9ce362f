"""Turns two built-in paths into files to look at, from path to IMU data and back to attitude: `kreisel demo`."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    Simulation,
    aligned,
    describe_notes,
    picture,
    simulation_outputs,
    write_outputs,
)

HELP = "the whole loop on built-in paths: IMU data, truth, attitude, pictures"

SENSOR, SEED = "bmi088", 7

# Central Europe: 18.5 uT to the north and 45 uT down, rounded.
_FIELD_N_UT = (0.0, 18.5, -45.0)


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_output_folder(parser, "default: kreisel-demo", default="kreisel-demo")


def run(args: Namespace) -> int:
    """Simulate the loop of figure 1, then fly an eight with a noisy IMU and estimate its attitude."""
    started = time.perf_counter()
    folder: Path = args.output
    print("1. From a path to IMU data")
    print(
        "   A body flies the loop of figure 1 (0.8 x 0.8 x 0.3 m, 1 Hz), its nose along the path. An IMU sits"
    )
    print(
        "   75 mm behind, 75 mm to the right of and 25 mm above its centre of mass: 5 s at 200 Hz. It is a BMI088"
    )
    print(f"   with the errors of its datasheet (kreisel sensors {SENSOR}).")
    print(aligned(_figure_1(folder)))
    print("\n2. From IMU data back to attitude")
    print(
        "   A lying eight in 8 s, for a minute; a noisy gyroscope, accelerometer and magnetometer record it, and"
    )
    print("   the DCM filter is given nothing but that recording.")
    print(aligned(_eight(folder)))
    print(f"\nMade in {time.perf_counter() - started:.1f} s. Next, with files of your own:")
    print("  kreisel info poses.csv                      what is in it")
    print("  kreisel simulate poses.csv -o out/          its IMU data; --imu -0.1,0,0.05 moves the IMU")
    print("  kreisel estimate imu.csv -o attitude.tum    attitude of a recording")
    return 0


def _figure_1(folder: Path) -> list[str]:
    """The document's loop with a real IMU off the centre of mass."""
    from kreisel.data.motion import Mount
    from kreisel.simulate.trajectories.lissajous import lissajous
    from kreisel.study.sensor import record_all, sensor_imu

    motion = lissajous().sample(np.arange(1001) / 200.0)
    mount = Mount(p_BS=np.array([-0.075, -0.075, 0.025]))
    made = Simulation(motion, (mount,), *record_all([sensor_imu(SENSOR, mount)], motion, SEED))
    for line in describe_notes(motion.notes):
        print(line)
    return write_outputs(folder, simulation_outputs([mount.name], erring=[mount.name], animation=True), made)


def _eight(folder: Path) -> list[str]:
    """The loop closed: motion, recording, estimate, errors."""
    from kreisel import show
    from kreisel.data.environment import Environment
    from kreisel.data.motion import Mount
    from kreisel.estimate.filters.dcm import DcmFilter
    from kreisel.estimate.run import run as estimate_attitude
    from kreisel.evaluate.attitude_errors import attitude_errors
    from kreisel.files.doors import write
    from kreisel.simulate.effects.turn_on_bias import TurnOnBias
    from kreisel.simulate.effects.white_noise import WhiteNoise
    from kreisel.simulate.imu import Imu
    from kreisel.simulate.trajectories.lying_eight import figure_eight
    from kreisel.study.account import Account, Answer, Reading

    motion = figure_eight(period=8.0).sample(np.arange(60 * 200 + 1) / 200.0)
    imu = Imu(
        Mount(name="eight"),
        gyro_effects=[TurnOnBias(sigma=np.deg2rad(0.3)), WhiteNoise(np.deg2rad(0.01))],
        accel_effects=[WhiteNoise(150e-6 * 9.80665)],
        mag_effects=[WhiteNoise(0.05)],
        environment=Environment(field_N_uT=np.array(_FIELD_N_UT)),
    )
    recorded = imu.record(motion, 1)
    estimate = estimate_attitude(DcmFilter(), recorded.measured)
    errors = attitude_errors(motion.at(imu.mount), estimate)
    rms_deg = np.rad2deg(np.sqrt(np.mean(errors.total[errors.t > 10.0] ** 2)))
    samples = f"what the IMU recorded, {len(recorded.measured)} samples"
    difference = f"their difference: {rms_deg:.1f} deg RMS after 10 s"
    outputs: list[Output[None]] = [
        Output("eight_imu.csv", samples, lambda _, path: write(path, recorded.measured)),
        Output("eight_attitude.tum", "what the filter makes of it", lambda _, path: write(path, estimate)),
        picture(
            "eight_attitude.png",
            "estimate and truth",
            lambda _: show.plot_attitude(estimate, motion.at(imu.mount)),
        ),
        picture("eight_errors.png", difference, lambda _: show.plot_attitude_errors(errors)),
    ]
    if find_spec("bokeh") is not None:
        account = Account(
            "lying eight",
            (Reading(imu.mount, recorded.measured, recorded.gyro_bias),),
            (Answer(imu.mount.name, "dcm", estimate, errors),),
            motion,
        )
        what = "all of it on one page: open it in a browser"
        outputs.append(Output("eight_report.html", what, lambda _, path: show.write_report(account, path)))
    return write_outputs(folder, outputs, None)
