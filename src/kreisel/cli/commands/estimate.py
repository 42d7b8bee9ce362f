"""Turns a file of IMU data into a file of attitude: `kreisel estimate`."""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Collection, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from kreisel import discovery
from kreisel.cli.inputs import add_input_arguments, read_input
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import choice
from kreisel.data.facts import impossible_units, unit_doubts
from kreisel.data.recording import ImuRecording

HELP = "attitude from IMU data, by one of the filters"

FILTERS = "kreisel.estimate.filters"

_EXAMPLES = """\
examples:
  kreisel estimate imu.csv -o attitude.tum
  kreisel estimate imu.csv -o attitude.npz --filter dcm --set mode=6 --set accel_time=3
  kreisel estimate trial.mat -o attitude.csv --picture attitude.png
  kreisel estimate log.csv -o attitude.csv --frame ned-frd --declination-deg 3.5

npz, mat and csv hold bias and flags as well, tum the attitude alone. kreisel evaluate compares with a truth.
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser)
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="file for the attitude")
    parser.add_argument("--to", metavar="FORMAT", help="its format, where the suffix does not tell")
    names = ", ".join(discovery.names(FILTERS))
    parser.add_argument("--filter", default="dcm", metavar="NAME", help=f"one of: {names} (default: dcm)")
    parser.add_argument(
        "--set",
        action="append",
        metavar="NAME=VALUE",
        help="a tuning parameter of the filter, in seconds, hertz and radians; may be given several times",
    )
    parser.add_argument(
        "--declination-deg",
        type=float,
        default=0.0,
        metavar="DEG",
        help="how far magnetic north lies east of true north (default: 0, heading from magnetic north)",
    )
    parser.add_argument("--picture", metavar="PICTURE", help="draw the attitude: .png, .svg or .pdf")
    parser.add_argument("--trust-units", action="store_true", help="go on where units look impossible")
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, check the units, estimate, write."""
    from kreisel.data.frames import from_enu_flu
    from kreisel.estimate.run import run as estimate
    from kreisel.files.doors import write

    filter = _filter(args)
    recording = read_input(args, kind="imu")
    assert isinstance(recording, ImuRecording)  # the kind asked for
    check_units(recording, args.input, args.trust_units)
    started = time.perf_counter()
    answer = estimate(filter, recording)
    seconds = time.perf_counter() - started
    write(Path(args.output), from_enu_flu(answer, args.frame), args.to)
    if args.picture is not None:
        from kreisel import show

        show.save(show.plot_attitude(answer), args.picture)
    mag = "with" if recording.mag_uT is not None else "without"
    print(f"{args.input}: {len(recording)} samples {mag} magnetometer; {args.filter} took {seconds:.2f} s")
    print("\n".join(_remarks(answer)))
    print(f"{args.output}: attitude of the sensor in {args.frame}")
    return 0


def _filter(args: Namespace) -> Any:
    """The filter that --filter, --set and --declination-deg describe."""
    from kreisel.study.signature import Place, call

    names = [name.replace("_", "-") for name in discovery.names(FILTERS)]
    make = discovery.load(FILTERS, choice("--filter", args.filter, names).replace("-", "_")).FILTER
    texts = {field.name for field in fields(make) if isinstance(field.default, str)}
    tuning = parse_settings(args.set or [], texts)
    if args.declination_deg and any(field.name == "declination" for field in fields(make)):
        tuning.setdefault("declination", float(np.deg2rad(args.declination_deg)))
    return call(make, tuning, Place("--set"))


def parse_settings(pairs: Sequence[str], texts: Collection[str] = ()) -> dict[str, Any]:
    """{"mode": "6", "accel_time": 3.0} from ["mode=6", "accel_time=3.0"]: values as in TOML, or bare words.

    texts : names whose value is a text even where it looks like a number.
    """
    import tomllib

    settings: dict[str, Any] = {}
    for pair in pairs:
        name, equals, value = (part.strip() for part in pair.partition("="))
        if not name or not equals or not value:
            raise ValueError(f"--set takes NAME=VALUE, such as --set accel_time=3; got {pair!r}.")
        try:
            parsed = tomllib.loads(f"value = {value}")["value"]
        except tomllib.TOMLDecodeError:
            parsed = value
        settings[name] = value if name in texts and not isinstance(parsed, str) else parsed
    return settings


def check_units(recording: ImuRecording, path: str, trusted: bool) -> None:
    """Refuse impossible units unless trusted; doubtful ones are a note on stderr."""
    impossible = impossible_units(recording)
    if impossible and not trusted:
        raise ValueError(
            f"{path}: {impossible[0]} Give its unit (--column), convert it, or insist with --trust-units."
        )
    for doubt in unit_doubts(recording):
        sys.stderr.write(f"kreisel: note: {path}: {doubt}\n")


def _remarks(answer: AttitudeHistory) -> list[str]:
    """What a person would want to know about the answer at once."""
    lines = []
    flags = {"at rest": answer.rest, "magnetometer not trusted": answer.disturbed, "held": answer.held}
    shares = [f"{text} {np.mean(flag):.0%}" for text, flag in flags.items() if flag is not None]
    if shares:
        lines.append(f"  of the time: {', '.join(shares)}")
    if answer.gyro_bias is not None:
        bias = ", ".join(f"{b:.3f}" for b in np.rad2deg(answer.gyro_bias[-1]))
        lines.append(f"  gyro bias at the end: ({bias}) deg/s")
    return lines
