"""Turns one file into another: format, units, columns and world, as `kreisel convert`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from kreisel.cli.batch import derived, expanded, over_files
from kreisel.cli.inputs import add_input_arguments, read_input, world
from kreisel.cli.outputs import check_format, summary_stream
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import UsageError, one_of
from kreisel.data.frames import WORLDS, from_enu_flu
from kreisel.files.doors import suffix, writable_names, write

HELP = "a file in another format, other units or another world"

SCHEMA = "kreisel.convert/1"

_EXAMPLES = """\
examples:
  kreisel convert flight.csv flight.tum
  kreisel convert log.txt imu.csv --frame ned-frd
  kreisel convert flight.bag flight.mcap --topic /imu/data
  kreisel convert 'rec/**/*.bag' -o out/ --to csv
  kreisel convert mocap.csv poses.csv --column t='Time [ms]' --column p_x='X [mm]' \\
      --column p_y='Y [mm]' --column p_z='Z [mm]'
  kreisel convert 00.txt 00.tum --from kitti --times times.txt
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser, many=True)
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        help="file to write, whose suffix tells the format, or for several inputs folder; without -o the last FILE",
    )
    parser.add_argument(
        "--to",
        metavar="FORMAT",
        type=one_of(writable_names),
        help=f"format of the output: {', '.join(writable_names())}",
    )
    parser.add_argument(
        "--to-frame",
        default="enu-flu",
        metavar="WORLD",
        type=world,
        help=f"world of the output: {', '.join(WORLDS)} (default: enu-flu)",
    )
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, turn, write."""
    place, places = _places(args)

    def one(path: str) -> dict[str, Any]:
        data, output = from_enu_flu(read_input(args, path), args.to_frame), places[path]
        if not args.dry_run:
            if output != place:
                output.parent.mkdir(parents=True, exist_ok=True)
            write(output, data, args.to)
        told = {"rows": len(data), "span_s": float(data.t[-1] - data.t[0])}
        return {"file": path, "output": str(output), "what": described(data), **told}

    batch = over_files(list(places), one, "reading" if args.dry_run else "converting")
    if args.dry_run:
        tell_plan(args, {f["file"]: f["what"] for f in batch.done}, [f["output"] for f in batch.done])
    elif args.json:
        print_json({"schema": SCHEMA, "files": batch.done, "failed": batch.failed})
    else:
        for f in batch.done:
            print(
                f"{f['output']}: {f['rows']} rows over {f['span_s']:.6g} s",
                file=summary_stream(f["output"]),
            )
    return batch.code


def _places(args: Namespace) -> tuple[Path, dict[str, Path]]:
    """OUT, and where each input goes; as with cp the last name is OUT where -o names none."""
    given, output = args.input, args.output
    if output is None:
        *given, output = given
        if not given:
            raise UsageError(f"convert needs a file to write besides {output}: kreisel convert IN OUT.")
    paths = expanded(given)
    outputs = derived(paths, output, suffix(args.to) if args.to else "")
    if args.to is None and outputs != [Path(output)]:
        raise UsageError(f"{output} is a folder: name the format of its files, as in --to csv.")
    check_format(str(outputs[0]), args.to)
    return Path(output), dict(zip(paths, outputs, strict=True))
