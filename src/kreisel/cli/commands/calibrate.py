"""Turns a recording into a calibration file, or with one into a better recording: `kreisel calibrate`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from kreisel.atomic import is_standard_output
from kreisel.cli.inputs import add_input_arguments, add_trust_units, read_input
from kreisel.cli.notes import note
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import UsageError, number
from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording

HELP = (
    "constant errors of the sensors: gyro bias, accelerometer, hard and soft iron; take them off a recording"
)

SCHEMA = "kreisel.calibrate/1"

_EXAMPLES = """\
examples:
  kreisel calibrate turned.csv --mag -o calibration.toml
  kreisel calibrate desk.csv -o calibration.toml             whatever the recording shows
  kreisel calibrate walk.csv --apply calibration.toml -o walk_calibrated.csv
  kreisel simulate poses.csv -o out/ --imu calibration.toml   a sensor with these errors

The gyro needs 2 s of rest; the accelerometer six poses at rest (12 for misalignment), a few seconds each; the
magnetometer to be turned every way, slowly, far from iron that does not turn with it.
"""

_SENSORS = ("gyro", "accel", "mag")

# Elements above the diagonal: what one axis hears of another.
_PAIRS = np.triu_indices(3, 1)


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser)
    parser.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="OUT",
        help="calibration file (.toml), with a picture beside it; or with --apply the recording",
    )
    for name, text in zip(_SENSORS, ("gyroscope", "accelerometer", "magnetometer"), strict=True):
        parser.add_argument(f"--{name}", action="store_true", help=f"calibrate the {text}")
    parser.add_argument(
        "--field-ut",
        type=number("microtesla", lowest=1.0, highest=1000.0),
        metavar="UT",
        help="strength of the magnetic field, microtesla",
    )
    parser.add_argument(
        "--gravity",
        type=number("m/s^2", lowest=0.1, highest=100.0),
        metavar="M/S2",
        help="gravity where the accelerometer was calibrated (default: the standard one, 9.80665; it is 9.78 at the "
        "equator, 9.83 at the poles)",
    )
    parser.add_argument(
        "--apply", metavar="FILE", help="take the errors in this calibration file off the recording"
    )
    add_report_arguments(parser, dry_run=True)
    add_trust_units(parser)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, calibrate or apply, write."""
    from kreisel.cli.inputs import check_units

    _check_options(args)
    recording = read_input(args, kind="imu")
    assert isinstance(recording, ImuRecording)  # the kind asked for
    check_units(recording, args.input, args.trust_units)
    if args.apply is not None:
        return _apply(args, recording)
    from kreisel.files.calibrations import write_calibration

    if args.dry_run:
        pictured = args.accel or args.mag or not args.gyro
        writes = [args.output, *([_picture(args)] if pictured else [])]
        return tell_plan(args, {args.input: described(recording)}, writes)
    found = _calibrated(args, recording)
    calibration = Calibration(**{name: part.triad for name, part in found.items()})
    write_calibration(args.output, calibration)
    drawn = _draw(args, recording, calibration)
    if args.json:
        print_json(_report(args, found))
        return 0
    print("\n".join(line for part in found.values() for line in part.lines))
    print(
        f"{args.output}: the calibration; kreisel calibrate FILE --apply {args.output} takes it off a recording, "
        f"kreisel simulate POSES --imu {args.output} simulates a sensor with these errors"
    )
    if drawn:
        print(f"{_picture(args)}: the readings before and after")
    return 0


def _check_options(args: Namespace) -> None:
    """Refuse options that contradict each other."""
    asked = [f"--{name}" for name in _SENSORS if getattr(args, name)]
    given = {"--field-ut": args.field_ut, "--gravity": args.gravity}
    numbers = [option for option, value in given.items() if value is not None]
    if args.apply is not None and (asked or numbers):
        raise UsageError(
            f"--apply takes off all that {args.apply} holds; {', '.join([*asked, *numbers])} belongs to a calibration."
        )


def _apply(args: Namespace, recording: ImuRecording) -> int:
    from kreisel.data.frames import from_enu_flu
    from kreisel.files.calibrations import read_calibration
    from kreisel.files.doors import write

    better = read_calibration(args.apply).apply(recording)
    if args.dry_run:
        return tell_plan(args, {args.input: described(recording), args.apply: "a calibration"}, [args.output])
    write(Path(args.output), from_enu_flu(better, args.frame))
    if args.json:
        print_json({"schema": SCHEMA, "file": args.input, "output": args.output, "applied": args.apply})
    else:
        print(f"{args.output}: {len(better)} samples, calibrated")
    return 0


def _picture(args: Namespace) -> Path:
    return Path(args.output).with_suffix(".png")


def _draw(args: Namespace, recording: ImuRecording, calibration: Calibration) -> bool:
    """Whether there was anything to draw: of a gyro's bias there is not."""
    from kreisel import show

    if is_standard_output(args.output) or (calibration.accel is None and calibration.mag is None):
        return False
    gravity = STANDARD_GRAVITY if args.gravity is None else args.gravity
    show.save(show.plot_calibration(recording, calibration, gravity), _picture(args))
    return True


class _Found(NamedTuple):
    """What was found of one sensor."""

    triad: TriadCalibration
    lines: tuple[str, ...]  # for people
    numbers: dict[str, float | None]  # for programs, besides those of the triad


def _report(args: Namespace, found: Mapping[str, _Found]) -> dict[str, Any]:
    """Bias and matrix of each sensor with their standard errors, in SI units and microtesla."""
    parts = ("bias", "bias_error", "matrix", "matrix_error")
    sensors = {
        name: {part: getattr(one.triad, part).tolist() for part in parts} | one.numbers
        for name, one in found.items()
    }
    return {"schema": SCHEMA, "file": args.input, "output": args.output, "sensors": sensors}


def _calibrated(args: Namespace, recording: ImuRecording) -> dict[str, _Found]:
    """The sensors asked for; without any asked for those the recording shows, with a note on each other."""
    asked = [name for name in _SENSORS if getattr(args, name)]
    found: dict[str, _Found] = {}
    for name in asked or _SENSORS:
        try:
            found[name] = _DO[name](args, recording)
        except ValueError as error:
            if asked:
                raise
            note(f"no {name}: {error}")
    if not found:
        raise ValueError(
            f"{args.input} shows no sensor's errors; see kreisel calibrate --help for what each needs."
        )
    return found


def _gyro(args: Namespace, recording: ImuRecording) -> _Found:
    from kreisel.evaluate.calibrate import calibrate_gyro

    triad = calibrate_gyro(recording)
    told = _vector(np.rad2deg(triad.bias), np.rad2deg(triad.bias_error))
    return _Found(triad, (f"gyro   bias {told} deg/s",), {})


def _accel(args: Namespace, recording: ImuRecording) -> _Found:
    from kreisel.evaluate.calibrate import calibrate_accel

    triad = calibrate_accel(recording, STANDARD_GRAVITY if args.gravity is None else args.gravity)
    scale, error = np.diagonal(triad.matrix), np.diagonal(triad.matrix_error)
    line = f"accel  bias {_vector(triad.bias, triad.bias_error)} m/s^2; scale {_vector(scale, error)}"
    lean, lean_error = (np.rad2deg(m[_PAIRS]) for m in (triad.matrix, triad.matrix_error))
    fitted = lean_error.any()
    told = (
        f"xy, xz, yz {_vector(lean, lean_error)} deg" if fitted else "not fitted: it needs 12 poses or more"
    )
    return _Found(triad, (line, f"       misalignment {told}"), {})


def _mag(args: Namespace, recording: ImuRecording) -> _Found:
    from kreisel.evaluate.calibrate import calibrate_mag

    fit = calibrate_mag(recording, args.field_ut)
    dip = "" if fit.dip_deg is None else f", dip {fit.dip_deg:.3g} deg"
    line = (
        f"mag    hard iron {_vector(fit.triad.bias, fit.triad.bias_error)} uT; field {fit.field_uT:.4g} uT{dip}; "
        f"left {fit.rms_uT:.2g} uT RMS"
    )
    numbers = {"field_uT": fit.field_uT, "dip_deg": fit.dip_deg, "rms_uT": fit.rms_uT}
    return _Found(fit.triad, (line,), numbers)


def _vector(values: np.ndarray, errors: np.ndarray) -> str:
    return "(" + ", ".join(f"{v:.4g} ± {e:.1g}" for v, e in zip(values, errors, strict=True)) + ")"


_DO: dict[str, Callable[[Namespace, ImuRecording], _Found]] = {
    "gyro": _gyro,
    "accel": _accel,
    "mag": _mag,
}
