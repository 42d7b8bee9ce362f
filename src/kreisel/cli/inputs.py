"""Turns the arguments that say how to read a file into the noun in it, in our axes."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace, _ActionsContainer
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from kreisel.cli.memory import is_long
from kreisel.cli.notes import note
from kreisel.cli.values import UsageError, as_typed, number, one_of
from kreisel.data.checks import choice
from kreisel.data.facts import Units
from kreisel.data.frames import WORLDS, to_enu_flu
from kreisel.data.recording import ImuRecording
from kreisel.data.trial import Trial
from kreisel.files.blocks import read_blocks
from kreisel.files.columns import GROUP_OF, GROUPS, KNOWN, split_unit
from kreisel.files.doors import KINDS, format_names, read
from kreisel.files.formats import Content, Noun
from kreisel.files.units import scale

world = one_of(tuple(WORLDS))
"""A type for argparse: the name of a world of axes."""

rate = number("hertz", above=0.0)
"""A type for argparse: a rate, Hz."""


def add_input_arguments(parser: ArgumentParser, many: bool = False) -> None:
    """`input` (a list with `many`), --from, --kind, --frame, --column, --input-rate, --times and --topic."""
    if many:
        parser.add_argument(
            "input", nargs="+", metavar="FILE", help="files to read, or patterns such as 'rec/**/*.csv'"
        )
    else:
        parser.add_argument("input", metavar="IN", help="file to read")
    parser.add_argument(
        "--from",
        dest="from_format",
        metavar="FORMAT",
        type=one_of(format_names),
        help=f"format of the input, where suffix and content do not tell: {', '.join(format_names())}",
    )
    parser.add_argument(
        "--kind",
        metavar="KIND",
        type=one_of(tuple(KINDS)),
        help=f"what to take from a file that has several: {', '.join(KINDS)}",
    )
    parser.add_argument(
        "--frame",
        default="enu-flu",
        metavar="WORLD",
        type=world,
        help=f"world of the input: {', '.join(WORLDS)} (default: enu-flu)",
    )
    parser.add_argument(
        "--column",
        action="append",
        metavar="NAME=HEADER",
        help="a column of a foreign csv, with its unit where the header has none: --column t='Time [ms]', "
        "--column p_x='X [mm]', --column p_y='#3 [mm]' for the third; may be given several times",
    )
    parser.add_argument("--input-rate", type=rate, metavar="HZ", help="rate of an input that holds no time")
    parser.add_argument("--times", metavar="FILE", help="stamps in s, one a line, for an input without time")
    parser.add_argument(
        "--topic",
        action="append",
        metavar="TOPIC",
        help="topic of a ROS bag, as in --topic /imu/data or --topic /tf:odom.base_link (kreisel info lists them); "
        "a second one names the magnetometer's, where it is not clear",
    )


def add_max_gap(parser: _ActionsContainer) -> None:
    """--max-gap, which is None where it is not given."""
    parser.add_argument(
        "--max-gap",
        type=number("seconds", lowest=0.0),
        metavar="S",
        help="longest time without poses that is bridged (default 0.25 s)",
    )


def read_input(args: Namespace, path: str | None = None, kind: str | None = None) -> Noun:
    """What `args.input`, or `path` in its place, holds: in ENU/FLU, SI units and radians.

    Of a benchmark's trial it is the recording.
    kind : "poses", "motion" or "imu" to insist on one whatever --kind says, as `kreisel.read` has it.
    """
    data = read_content(args, path, kind)
    return to_enu_flu(data.recording if isinstance(data, Trial) else data, args.frame)


def read_content(args: Namespace, path: str | None = None, kind: str | None = None) -> Content:
    """The same in the axes of the file, and a benchmark's trial as a whole."""
    place, format, options = _asked(args, path, kind)
    return read(place, format, **options)


def read_content_blocks(
    args: Namespace, path: str | None = None, kind: str | None = None
) -> Iterator[Content]:
    """The same block by block where the file is larger than memory has room for, else as one block."""
    place, format, options = _asked(args, path, kind)
    return read_blocks(place, format, **options) if is_long(place) else iter([read(place, format, **options)])


def in_any_folder(args: Namespace) -> Namespace:
    """The arguments for workers, which have a working folder of their own: --times and --picture by absolute names."""
    if args.backend is None:
        return args
    named = {name: path for name in ("times", "picture") if (path := getattr(args, name, None)) is not None}
    return Namespace(**vars(args) | {name: str(Path(path).absolute()) for name, path in named.items()})


def _asked(args: Namespace, path: str | None, kind: str | None) -> tuple[Path, str | None, dict[str, Any]]:
    options = {
        "kind": kind or args.kind,
        "columns": parse_columns(args.column),
        "rate_hz": args.input_rate,
        "times": args.times,
        "topic": args.topic or (),
    }
    return Path(args.input if path is None else path), args.from_format, options


def parse_columns(pairs: Sequence[str] | None) -> dict[str, str] | None:
    """{"t": "Time [ms]"} from ["t=Time [ms]"]; None from nothing."""
    if not pairs:
        return None
    columns = {}
    for pair in pairs:
        name, _, header = (part.strip() for part in pair.partition("="))
        if not name or not header:
            raise UsageError(f"--column takes NAME=HEADER, such as --column t='Time [ms]'; got {pair!r}.")
        with as_typed():
            group = GROUP_OF[choice("NAME of --column", name, KNOWN)]
        unit = split_unit(header)[1]
        if unit is not None:
            check_unit(f"--column {name}", unit, group)
        columns[name] = header
    return columns


def check_unit(option: str, unit: str, group: str) -> None:
    """Refuse a unit that is none of the columns of `group`, as `kreisel.files.columns.GROUPS` has it."""
    try:
        scale(unit, GROUPS[group][1])
    except ValueError as error:
        raise UsageError(f"{option}: {error}") from None


def add_trust_units(parser: _ActionsContainer) -> None:
    """--trust-units, which `check_units` takes."""
    parser.add_argument("--trust-units", action="store_true", help="go on where units look impossible")


def check_units(recording: ImuRecording, path: str, trusted: bool, *, unit: str = "", by: str = "") -> None:
    """Refuse impossible units unless they are trusted; doubtful ones are a note on stderr.

    unit : how the unit of a column is named, for the complaint, where columns are not those of rates and forces.
    by : what does so, of a command that has no --column.
    """
    check_units_of(Units.of(recording), path, trusted, unit=unit, by=by)


CONVERT = "kreisel convert FILE OUT.csv "
"""What names the units of files for commands that have no --column."""


def check_readings_of(units: Units, path: str) -> None:
    """Refuse a recording whose gyroscope or accelerometer never reads anything: a filter would hold its start."""
    silent = units.silent()
    if silent:
        raise ValueError(f"{path}: no reading of the {' and the '.join(silent)}: every row is NaN.")


def check_units_of(units: Units, path: str, trusted: bool, *, unit: str = "", by: str = "") -> None:
    """The same of what was gathered from blocks."""
    impossible = units.impossible()
    if impossible and not trusted:
        unit = unit or ("accel_x='ax [g]'" if "accel" in impossible[0] else "gyro_x='gx [deg/s]'")
        raise ValueError(
            f"{path}: {' And '.join(impossible)} Name the unit ({by}--column {unit}), or insist with --trust-units."
        )
    for doubt in units.doubts():
        note(f"{path}: {doubt}")
