"""Turns one file into another: format, units, columns and world, as `kreisel convert`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from kreisel.cli.inputs import add_input_arguments, read_input, world
from kreisel.cli.outputs import check_format, summary_stream
from kreisel.cli.values import one_of
from kreisel.data.frames import WORLDS, from_enu_flu
from kreisel.files.doors import writable_names, write

HELP = "a file in another format, other units or another world"

_EXAMPLES = """\
examples:
  kreisel convert flight.csv flight.tum
  kreisel convert log.txt imu.csv --frame ned-frd
  kreisel convert flight.bag flight.mcap --topic /imu/data
  kreisel convert mocap.csv poses.csv --column t='Time [ms]' --column p_x='X [mm]' \\
      --column p_y='Y [mm]' --column p_z='Z [mm]'
  kreisel convert 00.txt 00.tum --from kitti --times times.txt
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser)
    parser.add_argument("output", metavar="OUT", help="file to write; its suffix tells the format")
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
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, turn, write."""
    check_format(args.output, args.to)
    data = from_enu_flu(read_input(args), args.to_frame)
    write(args.output, data, args.to)
    span = data.t[-1] - data.t[0]
    print(f"{args.output}: {len(data)} rows over {span:.6g} s", file=summary_stream(args.output))
    return 0
