"""Turns one file into another: format, units, columns and world, as `kreisel convert`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Iterator

from kreisel.cli.inputs import add_input_arguments, read_content_blocks
from kreisel.cli.outputs import summary_stream
from kreisel.data.checks import choice
from kreisel.data.frames import WORLDS, from_enu_flu, to_enu_flu
from kreisel.data.trial import Trial
from kreisel.files.blocks import write_blocks
from kreisel.files.doors import writable_names
from kreisel.files.formats import Noun

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
    parser.add_argument("--to", metavar="FORMAT", help=f"format of the output: {', '.join(writable_names())}")
    parser.add_argument(
        "--to-frame",
        default="enu-flu",
        metavar="WORLD",
        help=f"world of the output: {', '.join(WORLDS)} (default: enu-flu)",
    )
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, turn, write."""
    choice("--to-frame", args.to_frame, tuple(WORLDS))
    found = _Found()
    write_blocks(args.output, found.of(_turned(args)), args.to)
    span = found.last - found.first
    print(f"{args.output}: {found.rows} rows over {span:.6g} s", file=summary_stream(args.output))
    return 0


def _turned(args: Namespace) -> Iterator[Noun]:
    for content in read_content_blocks(args):
        data = content.recording if isinstance(content, Trial) else content
        yield from_enu_flu(to_enu_flu(data, args.frame), args.to_frame)


class _Found:
    """What the summary tells, gathered from the blocks on their way."""

    def __init__(self) -> None:
        self.rows, self.first, self.last = 0, 0.0, 0.0

    def of(self, blocks: Iterable[Noun]) -> Iterator[Noun]:
        """The same blocks."""
        for block in blocks:
            self.first = self.first if self.rows else float(block.t[0])
            self.rows += len(block)
            self.last = float(block.t[-1])
            yield block
