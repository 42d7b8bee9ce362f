"""Turns IMU recordings into attitude by one of our filters: `kreisel estimate`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kreisel.cli.batch import derived, expanded
from kreisel.cli.estimates import Found, table_of
from kreisel.cli.filters import add_filter_arguments, chosen_filter, tuning_help
from kreisel.cli.inputs import (
    add_input_arguments,
    add_trust_units,
    check_readings_of,
    check_units_of,
    in_any_folder,
    read_content,
    read_content_blocks,
    world,
)
from kreisel.cli.output_options import add_output_file, picture_file
from kreisel.cli.outputs import check_format, summary_stream
from kreisel.cli.reports import add_report_arguments, print_json, tell_plan
from kreisel.cli.sweeps import add_sweep_arguments, into_folder, left_to_do, over_many_files, told_of_skipped
from kreisel.cli.values import UsageError
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.facts import Units
from kreisel.data.frames import from_enu_flu, to_enu_flu
from kreisel.data.increments import ImuIncrements
from kreisel.data.recording import ImuRecording
from kreisel.data.trial import Trial
from kreisel.files.blocks import write_blocks

HELP = "attitude from IMU data, by one of the filters"

SCHEMA = "kreisel.estimate/1"

_EXAMPLES = """\
examples:
  kreisel estimate imu.csv -o attitude.tum
  kreisel estimate trial.mat -o attitude.npz --mode 6
  kreisel estimate flight.mcap --topic /imu/data_raw -o attitude.tum
  kreisel estimate imu.csv -o attitude.csv --filter mekf --smooth
  kreisel estimate log.csv --frame ned-frd --declination-deg 3.5 --set mag_time=30
  kreisel estimate trial.mat --set published.weight_accel=0.02 --set published.exact=true
  kreisel estimate 'recordings/**/*.csv' -o attitudes/ --to npz           on all cores; --backend: docs/cluster.md
  kreisel estimate 'recordings/**/*.csv' -o attitudes/ --to npz --resume  the rest, after an interruption

Without -o the summary is all that is made. TUM files hold the attitude alone; csv, npz and mat also gyro bias,
acceleration and flags. What the filter assumes of the sensors is in its tuning: --set help lists it.
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser, many=True)
    add_filter_arguments(parser)
    parser.add_argument(
        "--smooth", action="store_true", help="look at the whole recording, not only back (--filter mekf)"
    )
    add_trust_units(parser)
    add_output_file(
        parser,
        AttitudeHistory,
        "file, or for several inputs folder, to write",
        "by OUT's suffix, or tum in a folder",
    )
    parser.add_argument(
        "--to-frame", metavar="WORLD", type=world, help="world of the output (default: that of the input)"
    )
    parser.add_argument(
        "--picture",
        metavar="PICTURE",
        type=picture_file,
        help="draw the attitude: .png, .svg or .pdf; one input",
    )
    add_sweep_arguments(parser)
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, check, estimate, write, sum up."""
    if "help" in args.set:
        print(tuning_help(args.filter))
        return 0
    estimated, paths = _estimator(args), expanded(args.input)
    outputs = dict(zip(paths, _outputs(args, paths), strict=True))
    left = left_to_do(args, outputs)
    if args.dry_run:
        return _plan(args, left)
    job = _Estimation(in_any_folder(args), estimated)
    batch = over_many_files(args, left, job, "smoothing" if args.smooth else "estimating")
    files = [{"file": path, "output": _name(outputs[path]), **made} for path, made in batch.done.items()]
    skipped = [path for path in outputs if path not in left]
    if args.json:
        report = {"files": files, "failed": batch.failed, "skipped": skipped}
        print_json({"schema": SCHEMA, "filter": _described(args), **report})
    else:
        lines = [*(table_of(args, files) if files else ()), *told_of_skipped(skipped)]
        for line in lines:
            print(line, file=summary_stream(args.output or ""))
    return batch.code


def _plan(args: Namespace, outputs: Mapping[str, Path | None]) -> int:
    batch = over_many_files(args, outputs, _Check(in_any_folder(args)), "reading")
    writes = [outputs[path] for path in batch.done]
    tell_plan(args, batch.done, [*filter(None, writes), *([args.picture] if args.picture else [])])
    return batch.code


@dataclass(frozen=True, slots=True)
class _Estimation:
    """What is done with each recording."""

    args: Namespace
    estimated: Callable[[Iterable[ImuRecording]], Iterator[AttitudeHistory]]

    def __call__(self, path: str, output: Path | None) -> dict[str, Any]:
        args, found = self.args, Found()
        attitudes = found.of(self.estimated(_recordings(args, path, found)))
        if args.picture is not None:
            attitudes = iter([_drawn(attitudes, args.picture)])
        if output is not None:
            to_frame = args.to_frame or args.frame
            turned = (from_enu_flu(block, to_frame) for block in attitudes)
            # Of OUT itself the folder has to be there.
            alone = output == Path(args.output)
            write_blocks(output, turned if alone else into_folder(turned, output.parent), args.to)
        else:
            deque(attitudes, maxlen=0)
        return found.summary()


@dataclass(frozen=True, slots=True)
class _Check:
    """What --dry-run does with each recording."""

    args: Namespace

    def __call__(self, path: str, output: Path | None) -> str:
        found = Found()
        deque(_recordings(self.args, path, found), maxlen=0)
        return found.described


def _name(output: Path | None) -> str | None:
    return None if output is None else str(output)


def _estimator(args: Namespace) -> Callable[[Iterable[ImuRecording]], Iterator[AttitudeHistory]]:
    """What makes attitude of a recording: the filter asked for, smoothed where that was asked for too."""
    from functools import partial

    from kreisel.estimate.filters import SmoothingFilter
    from kreisel.estimate.long import run_long
    from kreisel.estimate.smooth import smooth

    filter = chosen_filter(args)
    if args.smooth and not isinstance(filter, SmoothingFilter):
        raise UsageError(
            f"--smooth needs a filter that keeps a covariance: --filter mekf; got {args.filter}."
        )
    return partial(map, partial(smooth, filter)) if args.smooth else partial(run_long, filter)


def _drawn(attitudes: Iterable[AttitudeHistory], picture: str) -> AttitudeHistory:
    """The attitude, in one block, when its picture is there."""
    from kreisel import show

    (attitude,) = attitudes
    show.save(show.plot_attitude(attitude), picture)
    return attitude


def _outputs(args: Namespace, paths: Sequence[str]) -> list[Path | None]:
    """Where the attitude of each input goes: a file, or files named like the inputs in a folder."""
    if args.picture is not None and len(paths) > 1:
        raise UsageError(f"--picture is for one input; got {len(paths)}.")
    if args.output is None:
        return [None] * len(paths)
    outputs = derived(paths, args.output, f".{args.to or 'tum'}")
    check_format(str(outputs[0]), args.to)
    return list(outputs)


def _recordings(args: Namespace, path: str, found: Found) -> Iterator[ImuRecording]:
    """The blocks of the IMU's part in our axes; units that cannot be are refused unless they are trusted."""
    # To look back from the end, and to be drawn, a recording has to be there as a whole.
    whole = args.smooth or args.picture is not None
    units = Units()
    waiting: ImuRecording | None = None
    for content in [read_content(args, path)] if whole else read_content_blocks(args, path):
        data = content.recording if isinstance(content, Trial) else content
        if not isinstance(data, ImuRecording):
            cure = " to take their mean rates" if isinstance(data, ImuIncrements) else " if it has both"
            raise ValueError(
                f"{path} holds {type(data).__name__}, not an IMU recording. Say --kind imu{cure}."
            )
        if waiting is not None:
            yield waiting
        waiting = to_enu_flu(data, args.frame)
        units.add(waiting)
        found.take(waiting, is_trial=isinstance(content, Trial))
    assert waiting is not None  # no file is read that has no rows
    check_units_of(units, path, args.trust_units)
    check_readings_of(units, path)
    yield waiting


def _described(args: Namespace) -> dict[str, Any]:
    return {
        "name": args.filter,
        "mode": args.mode,
        "smooth": args.smooth,
        "set": args.set,
        "declination_deg": args.declination_deg or 0.0,
    }
