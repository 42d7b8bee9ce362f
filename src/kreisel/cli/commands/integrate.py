"""Turns IMU data, rates or increments, and where they began into the sensor's motion: `kreisel integrate`."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.cli.inputs import add_input_arguments, add_trust_units, check_units, read_input, world
from kreisel.cli.output_options import add_output_file
from kreisel.cli.outputs import check_format, describe_notes, summary_stream, two_digits
from kreisel.cli.surroundings import add_place_arguments, environment_at
from kreisel.cli.values import UsageError, as_typed
from kreisel.data.checks import SAME_INSTANT, Array
from kreisel.data.frames import from_enu_flu, to_enu_flu
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.doors import read, write

if TYPE_CHECKING:
    from kreisel.estimate.strapdown import Initial
    from kreisel.evaluate.motion_errors import MotionErrors

HELP = "position, velocity and attitude from IMU data by integration alone, and how far they drift"

SCHEMA = "kreisel.integrate/1"

_EXAMPLES = """\
examples:
  kreisel integrate imu.csv --initial truth.npz -o motion.csv
  kreisel integrate imu.csv --initial 0,0,0 -o motion.npz
  kreisel integrate imu.csv --initial 0,0,1.5:0,0,90:2,0,0 -o motion.tum
  kreisel integrate out/wrist.csv --truth out/truth.npz --imu 0.02,0,0.05
  kreisel integrate imu.npz --truth truth.npz --place 48.14,11.58,520 --turning --json

No filter holds the errors: a bias of the gyroscope grows into the position with the third power of time, one of the
accelerometer with the second. Attitude that does not drift away: kreisel estimate. The motion is that of the sensor, in
its axes; --initial and --truth are in the world of the input (--frame).
"""

# s; of these spans the table has the ones that are over.
_AFTER = (1.0, 10.0, 60.0, 600.0, 3600.0)


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser)
    parser.add_argument(
        "--initial",
        metavar="WHERE",
        help="where the sensor is at the first stamp: a file with the body's motion (truth.npz of kreisel simulate), "
        "or X,Y,Z[:RX,RY,RZ[:VX,VY,VZ]], its position in m, attitude in deg (z-y-x) and velocity in m/s "
        "(default: the truth's)",
    )
    parser.add_argument(
        "--truth", metavar="FILE", help="true motion of the body: print how far the result drifts from it"
    )
    parser.add_argument(
        "--imu",
        metavar="X,Y,Z[:RX,RY,RZ]",
        help="lever arm in m and turn in deg of the sensor on the body whose motion the files have, as kreisel "
        "simulate takes it (default: at its origin)",
    )
    add_place_arguments(parser, dated=False)
    add_output_file(parser, Motion, "file to write; its suffix tells the format")
    parser.add_argument(
        "--to-frame", metavar="WORLD", type=world, help="world of the output (default: that of the input)"
    )
    add_trust_units(parser)
    parser.add_argument("--json", action="store_true", help="machine-readable output, with a schema version")
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, integrate, write, compare."""
    from kreisel.estimate.strapdown import integrate

    _check_options(args)
    environment, mount = environment_at(args), _mount(args)
    recording = _recording(args)
    truth = None if args.truth is None else _motion(args.truth, args.frame, mount)
    motion = integrate(recording, _initial(args, truth, mount), environment)
    drift = None if truth is None else _drift(args, truth, motion)
    if args.output is not None:
        write(args.output, from_enu_flu(motion, args.to_frame or args.frame), args.to)
    if args.json:
        print(json.dumps(_report(args, recording, motion, drift), indent=2))
    else:
        print("\n".join(_told(args, recording, motion, drift)), file=summary_stream(args.output or ""))
    return 0


def _check_options(args: Namespace) -> None:
    """Refuse what cannot be, whatever the files hold."""
    if args.initial is None and args.truth is None:
        raise UsageError(
            "integration has to begin somewhere: give --initial truth.npz, or a position, attitude and velocity as in "
            "--initial 0,0,0:0,0,90:2,0,0, or a --truth to begin from."
        )
    named = args.initial is not None and ("," not in args.initial or Path(args.initial).exists())
    if args.initial is not None and not named and _numbers(args.initial) is None:
        raise UsageError(
            "--initial takes a file or X,Y,Z[:RX,RY,RZ[:VX,VY,VZ]], such as 0,0,1.5:0,0,90:2,0,0; "
            f"got {args.initial!r}."
        )
    if args.output is not None:
        check_format(args.output, args.to)
        _refuse_input(args)


def _recording(args: Namespace) -> ImuRecording | ImuIncrements:
    data = read_input(args)
    if not isinstance(data, ImuRecording | ImuIncrements):
        raise ValueError(
            f"{args.input} holds {type(data).__name__}, not an IMU's rates or increments. "
            "Say --kind imu or --kind increments if it has both."
        )
    if isinstance(data, ImuRecording):
        check_units(data, args.input, args.trust_units)
    elif len(data):
        check_units(data.mean_rates(), args.input, args.trust_units, unit="dv_x='dv_x [g*s]'")
    return data


def _mount(args: Namespace) -> Mount:
    from kreisel.cli.commands.simulate import parse_mount

    with as_typed():
        return Mount() if args.imu is None else to_enu_flu(parse_mount(args.imu), args.frame)


def _motion(path: str, frame: str, mount: Mount) -> Motion:
    """The sensor's motion, from a file with the body's."""
    data = read(path)
    if not isinstance(data, Motion):
        raise ValueError(
            f"{path} holds {type(data).__name__}, where a whole motion is needed, with velocities and rates. "
            f"kreisel simulate makes one of poses: truth.npz in its folder."
        )
    return to_enu_flu(data, frame).at(mount)


def _initial(args: Namespace, truth: Motion | None, mount: Mount) -> Initial:
    if args.initial is None:
        assert truth is not None  # one of them was asked for
        return truth
    numbers = _numbers(args.initial)
    return _motion(args.initial, args.frame, mount) if numbers is None else _state(numbers, args.frame)


def _numbers(text: str) -> list[Array] | None:
    """Position m, angles deg and velocity m/s; None where the text is not of that kind."""
    try:
        given = [np.array([float(x) for x in part.split(",")]) for part in text.split(":")]
    except ValueError:
        return None
    whole = 1 <= len(given) <= 3 and all(len(x) == 3 and np.isfinite(x).all() for x in given)
    return [*given, *([np.zeros(3)] * (3 - len(given)))] if whole else None


def _state(numbers: list[Array], world: str) -> tuple[Array, Array, Array]:
    """p_NS, v_NS and R_NS in our axes."""
    from kreisel.maths.rotations import matrix_from_euler

    position, angles_deg, velocity = numbers
    R = matrix_from_euler(np.deg2rad(angles_deg))
    ours = to_enu_flu(Poses(np.zeros(1), position[None], R[None], velocity[None]), world)
    assert ours.R_NB is not None and ours.v_NB is not None  # they went in
    return ours.p_NB[0], ours.v_NB[0], ours.R_NB[0]


def _drift(args: Namespace, truth: Motion, motion: Motion) -> MotionErrors:
    """Errors at the stamps that both have."""
    from kreisel.evaluate.motion_errors import motion_errors

    # Epochs are subtracted as integers: as floats they would be rounded to 128 ns.
    times = motion.t + (motion.t0_ns - truth.t0_ns) / 1e9
    near = np.minimum(np.searchsorted(truth.t, times - SAME_INSTANT), len(truth) - 1)
    both = np.flatnonzero(np.abs(truth.t[near] - times) <= SAME_INSTANT)
    if not len(both):
        raise ValueError(
            f"{args.truth} has no row at any stamp of {args.input}, which spans {times[0]:.9g} to {times[-1]:.9g} s "
            f"on its clock; its own span is {truth.t[0]:.9g} to {truth.t[-1]:.9g} s. "
            "Sample the truth at the recording's stamps."
        )
    return motion_errors(truth.rows(near[both]), motion.rows(both))


def _refuse_input(args: Namespace) -> None:
    output = Path(args.output)
    for given in (args.input, args.truth, args.initial):
        if given is not None and output.is_file() and Path(given).exists() and output.samefile(given):
            raise UsageError(f"-o {output} is one of the inputs. Choose another name.")


def _moments(drift: MotionErrors, first: float) -> list[tuple[str, float, Array]]:
    """(what it is called, s since the first stamp, errors of position m, velocity m/s, attitude rad) of some rows."""
    since = drift.t - first
    errors = np.stack([drift.position, drift.velocity, drift.attitude], axis=1)
    rows = [int(np.argmin(np.abs(since - after))) for after in _AFTER if after < since[-1]]
    named = [(f"after {since[k]:.4g} s", float(since[k]), errors[k]) for k in (*rows, len(since) - 1)]
    return list({name: (name, when, error) for name, when, error in named}.values())


def _first(drift: MotionErrors, motion: Motion) -> float:
    """The first stamp of the motion on the clock of the errors, s."""
    return float(motion.t[0] + (motion.t0_ns - drift.t0_ns) / 1e9)


def _told(
    args: Namespace, recording: ImuRecording | ImuIncrements, motion: Motion, drift: MotionErrors | None
) -> list[str]:
    from kreisel.cli.tables import plain

    what = "increments" if isinstance(recording, ImuIncrements) else "samples"
    start = args.initial or args.truth
    lines = [f"{args.input}: {len(recording)} {what} over {motion.t[-1] - motion.t[0]:.6g} s, from {start}"]
    lines += [f"  {line}" for line in describe_notes(motion.notes)]
    if drift is not None:
        lines += [f"drift from {args.truth}, at {len(drift)} of {len(motion)} stamps:"]
        rows = [[name, *two_digits(list(error))] for name, _, error in _moments(drift, _first(drift, motion))]
        rows.append(["at most", *two_digits(_largest(drift))])
        lines += [f"  {line}" for line in plain(["", "position, m", "velocity, m/s", "attitude, deg"], rows)]
    if args.output is None:
        return [*lines, "nothing written: -o motion.csv keeps the motion"]
    return [*lines, f"written: {args.output}, the motion of the sensor"]


def _largest(drift: MotionErrors) -> list[float]:
    return [float(x.max()) for x in (drift.position, drift.velocity, drift.attitude)]


def _report(
    args: Namespace, recording: ImuRecording | ImuIncrements, motion: Motion, drift: MotionErrors | None
) -> dict[str, Any]:
    def numbers(error: Sequence[float] | Array) -> dict[str, float]:
        p, v, turn = (float(x) for x in error)
        return {"position_m": p, "velocity_m_s": v, "attitude_deg": float(np.rad2deg(turn))}

    drifted = None
    if drift is not None:
        moments = _moments(drift, _first(drift, motion))
        drifted = {
            "truth": args.truth,
            "stamps": len(drift),
            "after": [{"s": when, **numbers(error)} for _, when, error in moments],
            "largest": numbers(_largest(drift)),
        }
    return {
        "schema": SCHEMA,
        "file": args.input,
        "noun": type(recording).__name__,
        "rows": len(recording),
        "span_s": float(motion.t[-1] - motion.t[0]),
        "initial": args.initial or args.truth,
        "output": args.output,
        "notes": describe_notes(motion.notes),
        "drift": drifted,
    }
