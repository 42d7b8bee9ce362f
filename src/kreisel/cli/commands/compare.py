"""Turns a real recording and poses into what is between it and its simulated twin: `kreisel compare`."""

from __future__ import annotations

import math
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.cli.inputs import CONVERT, add_max_gap, add_trust_units, check_units
from kreisel.cli.notes import complain
from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    describe_notes,
    picture,
    write_json,
    write_outputs,
    written,
)
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import as_typed, number, one_of

if TYPE_CHECKING:
    import numpy as np

    from kreisel.data.motion import Note
    from kreisel.data.recording import ImuRecording
    from kreisel.data.trajectory import Poses
    from kreisel.evaluate.align import Alignment, SensorAlignment
    from kreisel.simulate.trajectories.sampled import SampledTrajectory

HELP = "a real recording against what an IMU on the same path should have read"

SCHEMA = "kreisel.compare/1"

_EXAMPLES = """\
examples:
  kreisel compare real.csv poses.csv -o twin/
  kreisel compare broad/07_undisturbed_fast_rotation_B.mat -o twin/
  kreisel compare real.csv poses.csv --estimate all
  kreisel compare real.csv poses.csv --imu 0.02,0,0.05 --estimate gyro_clock,accel_clock
  kreisel compare real.csv simulated/truth.npz --estimate none --json --max-gyro-rmse 0.1

The poses are smoothed where they are noisy, differentiated and read by a perfect IMU; lever arm, rotation, biases and
clocks of the real one are found on the way. Files in other worlds or with columns of other names: kreisel convert
them first. Exit code 3: a limit (--max-...) was missed.
"""

_UNITS = {"gyro": "rad/s", "accel": "m/s^2"}


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "real", metavar="REAL", help="an IMU recording, or a BROAD trial, which has poses too"
    )
    parser.add_argument("poses", metavar="POSES", nargs="?", help="poses with attitude of the body it was on")
    parser.add_argument(
        "--estimate",
        metavar="WHAT",
        help="what may be found, with commas between: rotation, lever_arm, gyro_bias, accel_bias, gyro_scale, "
        "accel_scale, gyro_clock, accel_clock, drift, tilt; all, or none (default: all but scale, drift and tilt)",
    )
    parser.add_argument(
        "--imu",
        metavar="X,Y,Z[:RX,RY,RZ]",
        help="lever arm in m and turn in deg as far as known, as kreisel simulate takes it",
    )
    parser.add_argument(
        "--pose-rate",
        type=number("hertz", above=0.0),
        metavar="HZ",
        help="rate of the cameras, where the file has more poses than they saw: in-between ones are left out "
        "(default: found from the poses where they lie on straight lines between; that of the file takes all)",
    )
    parser.add_argument(
        "--method",
        default="auto",
        type=one_of(("auto", "spline", "smooth")),
        help="auto (default), spline or smooth",
    )
    add_max_gap(parser)
    parser.add_argument(
        "--search",
        type=number("seconds", lowest=0.0),
        default=0.5,
        metavar="S",
        help="how far the clocks may be apart (0.5 s)",
    )
    add_output_folder(parser, "folder for picture, twin and summary.json")
    add_report_arguments(parser, dry_run=True)
    add_trust_units(parser)
    for sensor, unit in _UNITS.items():
        parser.add_argument(
            f"--max-{sensor}-rmse",
            dest=sensor,
            type=number(_UNITS[sensor], lowest=0.0),
            metavar="RMSE",
            help=f"largest RMSE of the {sensor} allowed over its axes, {unit}",
        )
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read both, align, report; 3 where a limit was missed."""
    from kreisel.evaluate.align import align

    recording, poses, named = _inputs(args)
    trajectory, thinned = _trajectory(args, poses)
    mount = None
    if args.imu is not None:
        from kreisel.cli.commands.simulate import parse_mount

        with as_typed():
            mount = parse_mount(args.imu)
    asked, outputs = _estimate(args.estimate), _outputs(recording)
    if args.dry_run:
        reads = {args.real: described(recording), named: described(poses)}
        return tell_plan(args, reads, written(args.output, outputs))
    with Progress(None, "aligning"):
        found = align(recording, trajectory, **asked, mount=mount, search=args.search)
    notes = [*thinned, *trajectory.sample(trajectory.t[:1]).notes, *found.notes]
    limits = _limits(args, found)
    report = _report(args, recording, named, found, limits) | {"notes": [note.text for note in notes]}
    files = []
    if args.output is not None:
        files = write_outputs(args.output, outputs, (report, found))
    if args.json:
        print_json(report)
    else:
        print(f"{args.real} against {named}")
        _print(found, describe_notes(notes), files)
    return _complain_of(limits)


def _inputs(args: Namespace) -> tuple[ImuRecording, Poses, str]:
    """The recording, the poses, and what to call these."""
    from kreisel.data.recording import ImuRecording
    from kreisel.data.trajectory import Poses
    from kreisel.data.trial import Trial
    from kreisel.files.doors import read

    data = read(args.real)
    recording = data.recording if isinstance(data, Trial) else data
    if not isinstance(recording, ImuRecording):
        raise ValueError(f"{args.real} is no IMU recording. The recording comes first, the poses second.")
    check_units(recording, args.real, args.trust_units, by=CONVERT)
    poses: Any = data.poses if isinstance(data, Trial) else None
    if args.poses is not None:
        poses = read(args.poses, kind="poses")
    if not isinstance(poses, Poses):
        raise ValueError(
            f"{args.real} has no poses of its own. Name the file that has: kreisel compare REAL POSES."
        )
    named = args.poses or "its own poses"
    if poses.R_NB is None:
        raise ValueError(
            f"{named}: positions only; what an IMU reads depends on attitude too (q_w ... or phi_x ...)."
        )
    return recording, poses, named


def _trajectory(args: Namespace, poses: Poses) -> tuple[SampledTrajectory, list[Note]]:
    """What moves as the poses that were seen, and a note where the poses alone say which these are."""
    from kreisel.data.motion import Note
    from kreisel.simulate.trajectories.sampled import SampledTrajectory

    rate = args.pose_rate or poses.camera_rate()
    # A hair more, for a rate that is a whole fraction of the file's and is found to some digits.
    seen = poses if rate is None else poses.thinned(args.pose_rate or 1.001 * rate)
    notes = []
    if args.pose_rate is None and rate is not None:
        text = (
            f"the poses were interpolated on straight lines from {rate:.4g} Hz: {len(seen)} of {len(poses)} are taken"
            " (--pose-rate takes others)"
        )
        notes.append(Note("method", text))
    gap = {} if args.max_gap is None else {"max_gap": args.max_gap}
    return SampledTrajectory.from_poses(seen, method=args.method, **gap), notes


def _estimate(text: str | None) -> dict[str, Any]:
    from kreisel.data.checks import choice
    from kreisel.evaluate.align.parameters import SIZES

    if text is None:
        return {}
    names = {"all": list(SIZES), "none": []}.get(text.strip())
    if names is None:
        with as_typed():
            names = [choice("--estimate", part.strip(), tuple(SIZES)) for part in text.split(",")]
    return {"estimate": names}


def _limits(args: Namespace, found: Alignment) -> list[dict[str, Any]]:
    asked = {sensor: getattr(args, sensor) for sensor in _UNITS if getattr(args, sensor) is not None}
    values = {sensor: getattr(found, sensor).total_rmse for sensor in asked}
    return [
        {"name": f"{s}_rmse", "unit": _UNITS[s], "limit": asked[s], "value": v, "held": v <= asked[s]}
        for s, v in values.items()
    ]


def _complain_of(limits: list[dict[str, Any]]) -> int:
    missed = [limit for limit in limits if not limit["held"]]
    for limit in missed:
        name = limit["name"].replace("_rmse", " RMSE")
        complain(f"{name}: {limit['value']:.4g} {limit['unit']}, allowed {limit['limit']:g}")
    return 3 if missed else 0


def _report(
    args: Namespace, recording: ImuRecording, named: str, found: Alignment, limits: list[dict[str, Any]]
) -> dict[str, Any]:
    """All numbers in SI units; null where there is none."""
    return {
        "schema": SCHEMA,
        "real": args.real,
        "poses": named,
        "span_s": float(recording.t[-1] - recording.t[0]),
        "p_BS_m": found.mount.p_BS.tolist(),
        "R_BS": found.mount.R_BS.tolist(),
        "gyro": _sensor_report(found.gyro),
        "accel": _sensor_report(found.accel),
        "drift": found.drift,
        "tilt_rad": found.tilt.tolist(),
        "standard_errors": {name: _numbers(errors) for name, errors in found.errors.items()},
        "limits": limits,
    }


def _sensor_report(sensor: SensorAlignment) -> dict[str, Any]:
    return {
        "rmse": _numbers(sensor.rmse),
        "rmse_all_axes": sensor.total_rmse,
        "correlation": _numbers(sensor.correlation),
        "bias": _numbers(sensor.bias),
        "scale": _numbers(sensor.scale),
        "clock_s": sensor.clock,
        "samples": sensor.samples,
        "effective_samples": sensor.effective_samples,
    }


def _numbers(values: np.ndarray) -> list[float | None]:
    return [float(x) if math.isfinite(x) else None for x in values]


def _print(found: Alignment, notes: list[str], files: list[str]) -> None:
    from kreisel.cli.outputs import aligned
    from kreisel.cli.tables import print_table

    print("\n".join(f"  {note}" for note in notes) + "\n")
    rows = []
    for name, unit in _UNITS.items():
        sensor = getattr(found, name)
        rmse = [*sensor.rmse, sensor.total_rmse]
        rows.append([f"{name} RMSE, {unit}", *(f"{x:.3g}" for x in rmse)])
        rows.append([f"{name} correlation", *(f"{x:.4f}" for x in sensor.correlation), ""])
    print_table(["real against twin", "x", "y", "z", "all axes"], rows)
    lines = found.lines()
    if lines:
        print()
        print_table(["found, ± standard error", "x", "y", "z", "unit"], [_row(*line) for line in lines])
    told = [f"{s} {getattr(found, s).samples} ({getattr(found, s).effective_samples:.0f})" for s in _UNITS]
    print(f"\nsamples compared, and how many independent ones they are worth: {', '.join(told)}")
    if {"gyro_clock", "accel_clock"} & set(found.errors):
        print(
            "a clock offset is by how much stamps are ahead: a sample shows what was so long before its stamp"
        )
    if files:
        print("\n" + aligned(files))


def _row(name: str, *rest: str) -> list[str]:
    *values, unit = rest
    told = "rotation, phi" if name == "rotation" else name.replace("_", " ")
    return [told, *values, *[""] * (3 - len(values)), unit]


def _outputs(recording: ImuRecording) -> list[Output[tuple[dict[str, Any], Alignment]]]:
    from kreisel import show
    from kreisel.files.doors import write

    def twin(made: tuple[dict[str, Any], Alignment], path: Path) -> None:
        write(path, made[1].twin)

    return [
        Output("summary.json", "all numbers, for programs", lambda made, path: write_json(made[0], path)),
        Output("twin.csv", "what a faultless IMU in its place would have read", twin),
        picture("twin.png", "both, axis by axis", lambda made: show.plot_twin(recording, made[1])),
    ]
