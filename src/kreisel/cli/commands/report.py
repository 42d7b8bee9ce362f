"""Turns a scenario, the folder of a run, or a recording with its estimates into one HTML page: `kreisel report`."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from kreisel.cli.batch import holds_files
from kreisel.cli.inputs import CONVERT, add_trust_units, check_units
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, print_json, tell_plan
from kreisel.cli.values import UsageError, as_typed, one_of

if TYPE_CHECKING:
    from kreisel.data.attitude import AttitudeHistory
    from kreisel.data.recording import ImuRecording
    from kreisel.evaluate.attitude_errors import Truth
    from kreisel.study.account import Account

SCHEMA = "kreisel.report/1"

HELP = "one HTML page of a run: the body in space, played, and linked charts"

_EXAMPLES = """\
examples:
  kreisel report scenario.toml                               runs it first
  kreisel report out/ -o report.html                         what `kreisel run scenario.toml -o out/` wrote
  kreisel report imu.csv --estimate attitude.tum --truth truth.npz
  kreisel report trial.mat --estimate mine.tum --estimate other.tum --align heading

The page works in any browser without a network. docs/report.md says what is on it.
"""

_OF_RECORDINGS = ("estimate", "truth", "imu", "align")


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "result", metavar="RESULT", help="scenario file, folder that kreisel run wrote, or IMU recording"
    )
    parser.add_argument(
        "-o", "--output", metavar="HTML", default="report.html", help="the page (default: report.html)"
    )
    of_recordings = parser.add_argument_group("where RESULT is an IMU recording or a BROAD trial")
    of_recordings.add_argument(
        "--estimate",
        action="append",
        metavar="FILE",
        help="attitude estimated from it; may be given several times",
    )
    of_recordings.add_argument(
        "--truth", metavar="FILE", help="motion, poses, attitude or reference; a trial brings its own"
    )
    of_recordings.add_argument(
        "--imu",
        metavar="[NAME:]X,Y,Z[:RX,RY,RZ]",
        help="how the sensor is mounted on the body of which the truth tells, as kreisel simulate takes it",
    )
    of_recordings.add_argument(
        "--align",
        metavar="WHAT",
        type=one_of(("heading", "frame", "frame+sensor")),
        help="leave the constant offset that fits best out of the errors: heading, frame or frame+sensor",
    )
    add_trust_units(of_recordings)
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Find out what RESULT is, and write its page."""
    from kreisel.files.extras import library
    from kreisel.show.report import write_report
    from kreisel.show.saving import writable

    started = time.perf_counter()
    # Both now, and not when a long scenario has been run.
    library("bokeh", "report", "kreisel report")
    with as_typed():
        writable(args.output, (".html",))
    if args.dry_run:
        return tell_plan(args, {args.result: _described(args)}, [args.output])
    with Progress(None, "report"):
        path = write_report(_account(args), args.output)
    size = path.stat().st_size
    if args.json:
        print_json({"schema": SCHEMA, "result": args.result, "bytes": size, "files": [str(path)]})
        return 0
    seconds = time.perf_counter() - started
    print(f"{path}: {size / 1e6:.1f} MB, written in {seconds:.1f} s; open it in a browser")
    return 0


def _is_scenario(source: Path) -> bool:
    return source.suffix.lower() == ".toml"


def _described(args: Namespace) -> str:
    """What RESULT is, in a few words; a scenario is checked and not run."""
    source = Path(args.result)
    if _is_scenario(source):
        from kreisel.study.building import build
        from kreisel.study.scenario import Scenario

        _refuse_options_of_recordings(args, "a scenario")
        return f"a scenario of {len(build(Scenario.load(source)).t)} samples"
    account = _account(args)
    imus, answers = len(account.readings), len(account.answers)
    return f"{imus} IMU{'' if imus == 1 else 's'}, {answers} estimate{'' if answers == 1 else 's'}"


def _account(args: Namespace) -> Account:
    source = Path(args.result)
    if holds_files(source):
        from kreisel.study.folder import read_account

        _refuse_options_of_recordings(args, "a folder")
        return read_account(source)
    if not _is_scenario(source):
        return _of_recording(args, source)
    from kreisel.study.account import account_of
    from kreisel.study.run import run as run_scenario
    from kreisel.study.scenario import Scenario

    _refuse_options_of_recordings(args, "a scenario")
    return account_of(run_scenario(Scenario.load(source)))


def _refuse_options_of_recordings(args: Namespace, kind: str) -> None:
    given = next((name for name in _OF_RECORDINGS if getattr(args, name) is not None), None)
    if given is not None:
        raise UsageError(f"--{given} goes with an IMU recording; {args.result} is {kind} and says it all.")


def _of_recording(args: Namespace, source: Path) -> Account:
    from kreisel.cli.commands.evaluate import read_truth
    from kreisel.cli.commands.simulate import parse_mount
    from kreisel.study.account import account_of_files

    recording, truth = _recording(source)
    check_units(recording, str(source), args.trust_units, by=CONVERT)
    if args.truth is not None:
        truth = read_truth(args.truth)
    if args.estimate is None and truth is None:
        raise UsageError(
            f"{source} is an IMU recording: give --estimate (kreisel estimate {source} -o attitude.tum) "
            "or --truth, or both."
        )
    with as_typed():
        mount = parse_mount(args.imu) if args.imu is not None else None
    estimates = _estimates(args.estimate or [])
    return account_of_files(recording, estimates, truth, mount=mount, align=args.align)


def _recording(source: Path) -> tuple[ImuRecording, Truth | None]:
    from kreisel.data.recording import ImuRecording
    from kreisel.data.trial import Trial
    from kreisel.files.doors import KINDS, read

    data = read(source)
    if isinstance(data, Trial):
        return data.recording, data.reference
    if not isinstance(data, ImuRecording):
        raise ValueError(
            f"{source} is no result: it must be a scenario (.toml), the folder that kreisel run wrote, or "
            f"{KINDS['imu']} with --estimate or --truth."
        )
    return data, None


def _estimates(paths: list[str]) -> dict[str, AttitudeHistory]:
    """Attitudes by the names of their files."""
    from kreisel.data.attitude import AttitudeHistory
    from kreisel.files.doors import read

    found: dict[str, AttitudeHistory] = {}
    for path in paths:
        data = read(path, kind="attitude")
        assert isinstance(data, AttitudeHistory)  # the kind asked for
        # Of two files with one name the folders tell which is which.
        found[Path(path).stem if Path(path).stem not in found else path] = data
    return found
