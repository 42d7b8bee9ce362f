"""Turns one file into another: format, units, columns and world, as `kreisel convert`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kreisel.cli.batch import derived, expanded, shortened
from kreisel.cli.inputs import add_input_arguments, in_any_folder, read_content_blocks, world
from kreisel.cli.outputs import check_format, summary_stream
from kreisel.cli.reports import add_report_arguments, described_by, print_json, tell_plan
from kreisel.cli.sweeps import add_sweep_arguments, into_folder, left_to_do, over_many_files, told_of_skipped
from kreisel.cli.values import UsageError, one_of
from kreisel.data.frames import WORLDS, from_enu_flu, to_enu_flu
from kreisel.data.trial import Trial
from kreisel.files.blocks import write_blocks
from kreisel.files.doors import suffix, writable_names
from kreisel.files.formats import Noun

HELP = "a file in another format, other units or another world"

SCHEMA = "kreisel.convert/1"

_EXAMPLES = """\
examples:
  kreisel convert flight.csv flight.tum
  kreisel convert log.txt imu.csv --frame ned-frd
  kreisel convert flight.bag flight.mcap --topic /imu/data
  kreisel convert 'rec/**/*.bag' -o out/ --to csv          on all cores; docs/cluster.md
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
    add_sweep_arguments(parser)
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, turn, write."""
    place, places = _places(args)
    left = left_to_do(args, places)
    job = _Conversion(in_any_folder(args), place)
    batch = over_many_files(args, left, job, "reading" if args.dry_run else "converting")
    outputs = {path: str(places[path]) for path in batch.done}
    if args.dry_run:
        tell_plan(args, {path: made["what"] for path, made in batch.done.items()}, outputs.values())
        return batch.code
    files = [{"file": path, "output": outputs[path], **made} for path, made in batch.done.items()]
    skipped = [path for path in places if path not in left]
    if args.json:
        print_json({"schema": SCHEMA, "files": files, "failed": batch.failed, "skipped": skipped})
    else:
        lines = [f"{f['output']}: {f['rows']} rows over {f['span_s']:.6g} s" for f in files]
        rest = f"files, {sum(f['rows'] for f in files)} rows in all"
        for line in [*shortened(lines, rest), *told_of_skipped(skipped)]:
            print(line, file=summary_stream(str(place)))
    return batch.code


@dataclass(frozen=True, slots=True)
class _Conversion:
    """What is done with each file."""

    args: Namespace
    place: Path  # OUT

    def __call__(self, path: str, output: Path | None) -> dict[str, Any]:
        assert output is not None  # every file goes somewhere
        found = _Found()
        blocks = found.of(_turned(self.args, path))
        if self.args.dry_run:
            deque(blocks, maxlen=0)
        else:
            # Of OUT itself the folder has to be there.
            blocks = blocks if output == self.place else into_folder(blocks, output.parent)
            write_blocks(output, blocks, self.args.to)
        return {"what": found.described, "rows": found.rows, "span_s": found.span}


def _places(args: Namespace) -> tuple[Path, dict[str, Path | None]]:
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


def _turned(args: Namespace, path: str) -> Iterator[Noun]:
    for content in read_content_blocks(args, path):
        data = content.recording if isinstance(content, Trial) else content
        yield from_enu_flu(to_enu_flu(data, args.frame), args.to_frame)


class _Found:
    """What the summary tells, gathered from the blocks on their way."""

    def __init__(self) -> None:
        self.rows, self._stamps, self._noun = 0, 0, ""
        self._first = self._last = 0.0

    def of(self, blocks: Iterable[Noun]) -> Iterator[Noun]:
        """The same blocks."""
        for block in blocks:
            self._noun = type(block).__name__
            self._first = self._first if self._stamps else float(block.t[0])
            self._stamps += len(block.t)
            self.rows += len(block)
            self._last = float(block.t[-1])
            yield block

    @property
    def span(self) -> float:
        """From the first stamp to the last, s."""
        return self._last - self._first

    @property
    def described(self) -> str:
        """What was read, in a few words."""
        return described_by(self._noun, self._stamps, self.span)
