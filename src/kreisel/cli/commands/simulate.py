"""Turns a file of poses, waypoints or segments into what an IMU on that body would have read: `kreisel simulate`."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.cli.courses import add_course_arguments, read_course
from kreisel.cli.inputs import add_input_arguments, rate, world
from kreisel.cli.long_simulation import Sampled, in_blocks, write_long
from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    Simulated,
    Simulation,
    aligned,
    check_imu_names,
    check_outputs,
    describe_notes,
    describe_round_trip,
    simulation_outputs,
    write_outputs,
    written,
)
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, print_json, tell_plan
from kreisel.cli.sensor_options import (
    add_sensor_arguments,
    describe_sensor,
    made,
    sensor_called,
    sensor_recipe,
)
from kreisel.cli.surroundings import (
    add_place_arguments,
    describe_declination,
    describe_field,
    describe_gravity,
    environment_at,
)
from kreisel.cli.values import UsageError, as_typed, one_of, sensor_name, whole
from kreisel.data.checks import choice, file_name
from kreisel.data.environment import Environment
from kreisel.data.frames import WORLDS, to_enu_flu
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.files.doors import format_names

if TYPE_CHECKING:
    from kreisel.simulate.imu import Imu

HELP = "IMU data of a body that moves along the poses, waypoints or segments in a file"

SCHEMA = "kreisel.simulate/1"

_EXAMPLES = """\
examples:
  kreisel simulate poses.csv -o out/
  kreisel simulate poses.tum -o out/ --rate 400 --imu wrist:0.02,0,0.05
  kreisel simulate poses.csv -o out/ --imu bmi088 --seed 7
  kreisel simulate poses.csv -o out/ --imu adis16495 --seed 7 --increments
  kreisel simulate poses.csv -o out/ --imu bmi088 --set gyro_noise_deg_per_s_rthz=0.02 --clock jitter=1e-4,loss=0.01
  kreisel simulate poses.csv -o out/ --imu bmi088 --temperature warm.csv --set gyro_temperature_bias_dps_per_degC=0.01
  kreisel simulate poses.csv -o out/ --imu bmi088 --effect accel:vibration_lines:frequency=35,amplitude=0.5/0.2/1
  kreisel simulate poses.csv -o out/ --sensor bmi088 --imu left:0,0.1,0 --imu right:0,-0.1,0
  kreisel simulate path.csv -o out/ --orientation tangent --imu=-0.075,-0.075,0.025:0,0,90
  kreisel simulate mocap.csv -o out/ --noise 0.1mm,0.01deg --max-gap 0.5
  kreisel simulate flight.csv -o out/ --frame ned-frd
  kreisel simulate flight.bag --topic /odom -o out/ --imu-format mcap
  kreisel simulate poses.csv -o out/ --rate 1000 --check
  kreisel simulate walk.csv -o out/ --place 48.14,11.58,520 --date 2026-05-01 --turning
  kreisel simulate mission.csv --as waypoints -o out/ --rate 200 --max-speed 8 --max-acceleration 4 --banked
  kreisel simulate drive.csv --as profile -o out/ --rate 100
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser)
    add_output_folder(parser, required=True)
    parser.add_argument(
        "--imu",
        action="append",
        metavar="[SENSOR@][NAME:]X,Y,Z[:RX,RY,RZ]",
        help="lever arm from the body's origin in m and turn of the sensor about x, y, z in deg (z-y-x), both in "
        "the body axes of the input's world (--frame): z is down in ned-frd; SENSOR alone sits at the origin; "
        "may be given several times",
    )
    parser.add_argument(
        "--sensor",
        type=sensor_name,
        help="sensor of all IMUs that name none: a preset (see kreisel sensors), a preset file .toml, kalibr's .yaml "
        "or what kreisel calibrate wrote (default: perfect sensors)",
    )
    parser.add_argument(
        "--seed", type=whole(), default=0, help="whole number from which noise is drawn (default 0)"
    )
    add_sensor_arguments(parser)
    add_place_arguments(parser)
    parser.add_argument("--rate", type=rate, metavar="HZ", help="IMU rate (default: the times of the poses)")
    parser.add_argument(
        "--method",
        type=one_of(("auto", "spline", "smooth", "gradient")),
        help="of poses: auto (default), spline, smooth or gradient (MATLAB's scheme)",
    )
    parser.add_argument(
        "--orientation",
        help="tangent or transport, in place of the file's attitude; of waypoints and profiles tangent or level",
    )
    add_course_arguments(parser)
    _add_output_arguments(parser)
    parser.epilog = _EXAMPLES


def _add_output_arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--increments",
        action="store_true",
        help="what navigation-grade units deliver: turn, velocity and, without errors, position of every interval "
        "between the samples, in place of rates",
    )
    parser.add_argument(
        "--to-frame", default="enu-flu", type=world, help=f"world of the output: {', '.join(WORLDS)}"
    )
    parser.add_argument(
        "--imu-format",
        default="csv",
        metavar="FORMAT",
        type=one_of(lambda: format_names(ImuRecording)),
        help=f"{', '.join(format_names(ImuRecording))} (default: csv); "
        f"with --increments {', '.join(format_names(ImuIncrements))}",
    )
    parser.add_argument("--no-pictures", action="store_true", help="write data only")
    parser.add_argument("--animation", action="store_true", help="also write motion.gif")
    parser.add_argument("--rerun", action="store_true", help="also write motion.rrd for the Rerun viewer")
    add_report_arguments(parser, dry_run=True)
    parser.add_argument(
        "--check",
        action="store_true",
        help="integrate the ideal IMU data, and those of a sensor with errors, back from the first pose and print how "
        "far each ends up from the truth",
    )


def run(args: Namespace) -> int:
    """Read, differentiate, mount, write."""
    from kreisel.study.sensor import errs

    started = time.perf_counter()
    _check_increments(args)
    with as_typed():
        given = [parse_imu(text, k) for k, text in enumerate(args.imu or ["imu:0,0,0"])]
    mounts = [to_enu_flu(mount, args.frame) for mount, _ in given]
    sensors = [named or args.sensor for _, named in given]
    environment = environment_at(args)
    with as_typed():
        recipe = sensor_recipe(args)
    imus = [
        made(replace(recipe, sensor=named), mount, environment)
        for mount, named in zip(mounts, sensors, strict=True)
    ]
    outputs = _outputs(args, imus)
    with Progress(None, "differentiating"):
        course = read_course(args)
        goes_in_blocks = in_blocks(args, course, imus)
        motion = None if goes_in_blocks else course.motion
    if goes_in_blocks:
        outputs = [output for output in outputs if not output.name.endswith(".png")]
    if args.dry_run:
        reads = {args.input: f"{course.told} -> {len(course)} IMU samples"}
        return tell_plan(args, reads, written(args.output, outputs))
    simulation = None if motion is None else _simulated(args, imus, motion)
    if simulation is None:
        sampled = write_long(args, course, imus, [imu for imu in imus if errs(imu)])
        lines = [f"{args.output / output.name}  {output.what}" for output in outputs]
    else:
        sampled = Sampled.of(simulation.motion)
        lines = write_outputs(args.output, outputs, simulation)
    if args.json:
        print_json(_report(args, sampled, mounts, sensors, written(args.output, outputs)))
        return 0
    told = ", ".join(dict.fromkeys(named or sensor_called(recipe) for named in sensors))
    told += f", seed {args.seed}" if any(map(errs, imus)) else ""
    what = f"{sampled.samples - 1} IMU increments" if args.increments else f"{sampled.samples} IMU samples"
    print(f"{args.input}: {course.told} -> {what}, {told}")
    print("".join(f"{line}\n" for line in describe_sensor(recipe)), end="")
    if args.place is not None:
        print(f"  {_described(environment)}")
    print("\n".join(f"  {line}" for line in describe_notes(sampled.notes)))
    print(f"written in {time.perf_counter() - started:.1f} s:")
    print(aligned(lines))
    if args.check and simulation is not None:
        print("integrated back from the first pose, the largest errors are:")
        print(aligned(_round_trips(imus, simulation.motion, simulation)))
    return 0


def _outputs(args: Namespace, imus: Sequence[Imu]) -> list[Output[Simulated]]:
    """The files to write, none of which replaces another."""
    from kreisel.study.sensor import errs

    names = [imu.mount.name for imu in imus]
    with as_typed():
        check_imu_names(names)
    outputs = simulation_outputs(
        names,
        erring=[imu.mount.name for imu in imus if errs(imu)],
        magnetometer=imus[0].environment.field_N_uT is not None,
        increments=args.increments,
        world=args.to_frame,
        imu_format=args.imu_format,
        pictures=not args.no_pictures,
        animation=args.animation,
        rerun=args.rerun,
    )
    with as_typed():
        check_outputs(args.output, outputs)
    return outputs


def _simulated(args: Namespace, imus: Sequence[Imu], motion: Motion) -> Simulation:
    """What every IMU reads, or adds up."""
    from kreisel.study.sensor import add_up_all, record_all

    read = add_up_all if args.increments else record_all
    with Progress(len(imus), "IMUs") as progress:
        made = read(imus, motion, args.seed, progress.advance)
    return Simulation(motion, [imu.mount for imu in imus], *made)


def _report(
    args: Namespace,
    sampled: Sampled,
    mounts: Sequence[Mount],
    sensors: Sequence[str | None],
    files: Sequence[Path],
) -> dict[str, Any]:
    """What was made, in SI units and the axes of ENU/FLU."""
    return {
        "schema": SCHEMA,
        "file": args.input,
        "samples": sampled.samples,
        "start_s": sampled.start,
        "end_s": sampled.end,
        "t0_ns": sampled.t0_ns,
        "seed": args.seed,
        "imus": [
            {"name": mount.name, "sensor": sensor, "p_BS_m": mount.p_BS.tolist(), "R_BS": mount.R_BS.tolist()}
            for mount, sensor in zip(mounts, sensors, strict=True)
        ],
        "notes": [note.text for note in sampled.notes],
        "files": [str(path) for path in files],
    }


def _check_increments(args: Namespace) -> None:
    """Refuse what units that add up cannot have."""
    if not args.increments:
        return
    if args.date is not None:
        raise UsageError(
            "--date gives the IMUs magnetometers, which have no increments. Leave one of them out."
        )
    with as_typed():
        choice("--imu-format", args.imu_format, format_names(ImuIncrements))


def _round_trips(imus: Sequence[Imu], motion: Motion, made: Simulation) -> list[str]:
    from kreisel.study.sensor import errs

    lines: list[str] = []
    for imu, measured in zip(imus, made.recordings, strict=True):
        shown = errs(imu) or isinstance(measured, ImuIncrements)
        lines += describe_round_trip(imu, motion, measured if shown else None)
    return lines


def _described(environment: Environment) -> str:
    parts = [describe_gravity(environment)]
    if environment.field_N_uT is not None:
        parts += [describe_field(environment.field_N_uT), describe_declination(environment)]
    return "\n  ".join(parts)


def parse_imu(text: str, number: int = 0) -> tuple[Mount, str | None]:
    """Mount and sensor that "[SENSOR@][NAME:]X,Y,Z[:RX,RY,RZ]" (m, deg) or "SENSOR" describes.

    An IMU with a sensor and no name is called as the sensor is.
    """
    if "@" in text:
        named, place = text.split("@", 1)
        return parse_mount(place, number, Path(named).stem), sensor_name(named)
    if text and "," not in text and ":" not in text:
        return Mount(name=file_name("the NAME of --imu", Path(text).stem)), sensor_name(text)
    return parse_mount(text, number), None


def parse_mount(text: str, number: int = 0, name: str = "") -> Mount:
    """The mount that "[NAME:]X,Y,Z[:RX,RY,RZ]" (m, deg) describes; without a NAME it gets `name`."""
    from kreisel.maths.rotations import matrix_from_euler

    parts = text.split(":")
    named = not _is_vector(parts[0])
    name = parts.pop(0) if named else name or ("imu" if number == 0 else f"imu{number + 1}")
    if not 1 <= len(parts) <= 2 or not all(map(_is_vector, parts)):
        raise ValueError(
            "--imu takes [SENSOR@][NAME:]X,Y,Z[:RX,RY,RZ], such as wrist:0.02,0,0.05 or bmi088@0.1,0,0; "
            f"got {text!r}."
        )
    p_BS, *turn = (np.array([float(x) for x in part.split(",")]) for part in parts)
    if not np.isfinite([p_BS, *turn]).all():
        raise ValueError(f"--imu takes finite numbers; got {text!r}.")
    R_BS = matrix_from_euler(np.deg2rad(turn[0])) if turn else np.eye(3)
    return Mount(p_BS, R_BS, file_name("the NAME of --imu", name))


def _is_vector(text: str) -> bool:
    try:
        return len([float(x) for x in text.split(",")]) == 3
    except ValueError:
        return False
