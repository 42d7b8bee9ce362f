"""Turns a recording into a calibration file, or with one into a better recording: `kreisel calibrate`."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path

import numpy as np

from kreisel.cli.inputs import add_input_arguments, read_input
from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.data.checks import scalar
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording

HELP = (
    "constant errors of the sensors: gyro bias, accelerometer, hard and soft iron; take them off a recording"
)

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
        help="calibration file (.toml), or with --apply the recording",
    )
    for name, text in zip(_SENSORS, ("gyroscope", "accelerometer", "magnetometer"), strict=True):
        parser.add_argument(f"--{name}", action="store_true", help=f"calibrate the {text}")
    parser.add_argument(
        "--field-ut", type=float, metavar="UT", help="strength of the magnetic field, microtesla"
    )
    parser.add_argument(
        "--gravity",
        type=float,
        metavar="M/S2",
        help="gravity where the accelerometer was calibrated (default: the standard one, 9.80665; it is 9.78 at the "
        "equator, 9.83 at the poles)",
    )
    parser.add_argument(
        "--apply", metavar="FILE", help="take the errors in this calibration file off the recording"
    )
    parser.add_argument("--trust-units", action="store_true", help="go on where units look impossible")
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

    calibration = _calibrated(args, recording)
    write_calibration(args.output, calibration)
    print(
        f"{args.output}: the calibration; kreisel calibrate FILE --apply {args.output} takes it off a recording, "
        f"kreisel simulate POSES --imu {args.output} simulates a sensor with these errors"
    )
    return 0


def _check_options(args: Namespace) -> None:
    """Refuse numbers that cannot be before anything is read, as without flags a sensor that fails is only noted."""
    asked = [f"--{name}" for name in _SENSORS if getattr(args, name)]
    given = {"--field-ut": args.field_ut, "--gravity": args.gravity}
    numbers = [option for option, value in given.items() if value is not None]
    if args.apply is not None and (asked or numbers):
        raise ValueError(
            f"--apply takes off all that {args.apply} holds; {', '.join([*asked, *numbers])} belongs to a calibration."
        )
    if args.field_ut is not None:
        scalar("--field-ut", args.field_ut, "uT", 1.0, 1000.0)
    if args.gravity is not None:
        scalar("--gravity", args.gravity, "m/s^2", 0.1, 100.0)


def _apply(args: Namespace, recording: ImuRecording) -> int:
    from kreisel.data.frames import from_enu_flu
    from kreisel.files.calibrations import read_calibration
    from kreisel.files.doors import write

    better = read_calibration(args.apply).apply(recording)
    write(Path(args.output), from_enu_flu(better, args.frame))
    print(f"{args.output}: {len(better)} samples, calibrated")
    return 0


def _calibrated(args: Namespace, recording: ImuRecording) -> Calibration:
    """The sensors asked for; without any asked for those the recording shows, with a note on each other."""
    asked = [name for name in _SENSORS if getattr(args, name)]
    found: dict[str, TriadCalibration] = {}
    for name in asked or _SENSORS:
        try:
            found[name] = _DO[name](args, recording)
        except ValueError as error:
            if asked:
                raise
            sys.stderr.write(f"kreisel: note: no {name}: {error}\n")
    if not found:
        raise ValueError(
            f"{args.input} shows no sensor's errors; see kreisel calibrate --help for what each needs."
        )
    return Calibration(**found)


def _gyro(args: Namespace, recording: ImuRecording) -> TriadCalibration:
    from kreisel.evaluate.calibrate import calibrate_gyro

    triad = calibrate_gyro(recording)
    print(f"gyro   bias {_vector(np.rad2deg(triad.bias), np.rad2deg(triad.bias_error))} deg/s")
    return triad


def _accel(args: Namespace, recording: ImuRecording) -> TriadCalibration:
    from kreisel.evaluate.calibrate import calibrate_accel

    triad = calibrate_accel(recording, STANDARD_GRAVITY if args.gravity is None else args.gravity)
    scale, error = np.diagonal(triad.matrix), np.diagonal(triad.matrix_error)
    print(f"accel  bias {_vector(triad.bias, triad.bias_error)} m/s^2; scale {_vector(scale, error)}")
    lean, lean_error = (np.rad2deg(m[_PAIRS]) for m in (triad.matrix, triad.matrix_error))
    fitted = lean_error.any()
    told = (
        f"xy, xz, yz {_vector(lean, lean_error)} deg" if fitted else "not fitted: it needs 12 poses or more"
    )
    print(f"       misalignment {told}")
    return triad


def _mag(args: Namespace, recording: ImuRecording) -> TriadCalibration:
    from kreisel.evaluate.calibrate import calibrate_mag

    fit = calibrate_mag(recording, args.field_ut)
    dip = "" if fit.dip_deg is None else f", dip {fit.dip_deg:.3g} deg"
    print(
        f"mag    hard iron {_vector(fit.triad.bias, fit.triad.bias_error)} uT; field {fit.field_uT:.4g} uT{dip}; "
        f"left {fit.rms_uT:.2g} uT RMS"
    )
    return fit.triad


def _vector(values: np.ndarray, errors: np.ndarray) -> str:
    return "(" + ", ".join(f"{v:.4g} ± {e:.1g}" for v, e in zip(values, errors, strict=True)) + ")"


_DO: dict[str, Callable[[Namespace, ImuRecording], TriadCalibration]] = {
    "gyro": _gyro,
    "accel": _accel,
    "mag": _mag,
}
