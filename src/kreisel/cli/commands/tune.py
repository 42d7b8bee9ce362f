"""Turns recordings with truth into a setting for a filter, and into what it is worth: `kreisel tune`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.atomic import refuse_unwritable
from kreisel.cli.batch import expanded
from kreisel.cli.filters import add_filter_arguments, chosen_filter, tuning_help
from kreisel.cli.inputs import CONVERT, add_trust_units, check_readings_of, check_units_of
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import UsageError, as_typed, one_of, whole
from kreisel.data.facts import Units

if TYPE_CHECKING:
    from kreisel.data.recording import ImuRecording
    from kreisel.data.trial import Trial
    from kreisel.study.tune import Tuning

HELP = "a filter's numbers, from recordings with truth, and what they gain on recordings left out"

SCHEMA = "kreisel.tune/1"

_EXAMPLES = """\
examples:
  kreisel tune BROAD/data_mat/*.mat --vary accel_time,mag_time
  kreisel tune walk.toml run.toml --draws 5 -o filter.toml
  kreisel tune a.csv=a_truth.tum b.csv=b_truth.tum c.csv=c_truth.tum --mode 6 --score inclination

Recordings come with their truth: trials of BROAD, scenarios (simulated, --draws of each), or IMU=TRUTH. Every one is
left out in turn while the others choose; the gain that counts is that on recordings left out, and a gain that chance
explains is called so. With -o the filter is written as the table that a scenario takes.
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "trials", nargs="+", metavar="TRIAL", help="trial.mat, scenario.toml or imu.csv=truth.tum"
    )
    add_filter_arguments(parser)
    parser.add_argument("--vary", metavar="NAME,...", help="numbers to move (default: all that are positive)")
    parser.add_argument(
        "--score",
        default="total",
        type=one_of(("total", "heading", "inclination")),
        help="RMSE that is to fall: total, heading or inclination (total)",
    )
    parser.add_argument(
        "--draws", type=whole(1), default=3, metavar="N", help="times that each scenario is simulated (3)"
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="file for the filter's table (.toml)")
    add_trust_units(parser)
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, search, report; with -o write what was found."""
    if "help" in args.set:
        print(tuning_help(args.filter))
        return 0
    from kreisel.study.tune import tune

    filter = chosen_filter(args)
    if args.output is not None:
        refuse_unwritable(args.output)
    vary = None if args.vary is None else _varied(filter, args.vary)
    texts = expanded(args.trials)
    trials = [trial for text in texts for trial in _trials(text, args)]
    if args.dry_run:
        reads = {f"{k}: {trial.name or 'recording'}": described(trial) for k, trial in enumerate(trials, 1)}
        return tell_plan(args, reads, [args.output] if args.output else [])
    with Progress(None, f"trying settings on {len(trials)} recordings") as progress:
        tuning = tune(filter, trials, vary=vary, score=args.score, progress=progress.reach)
    if args.output is not None:
        _write(args, tuning)
    if args.json:
        print_json(_report(args, tuning))
    else:
        _print(args, tuning)
    return 0


def _varied(filter: Any, text: str) -> list[str]:
    from kreisel.data.checks import choice
    from kreisel.study.tune import tunable

    with as_typed():
        return [choice("--vary", name.strip(), tunable(filter)) for name in text.split(",")]


def _trials(text: str, args: Namespace) -> list[Trial]:
    from kreisel.data.attitude import AttitudeHistory
    from kreisel.data.motion import Motion
    from kreisel.data.recording import ImuRecording
    from kreisel.data.trajectory import Poses
    from kreisel.data.trial import Trial
    from kreisel.files.doors import read
    from kreisel.study.scenario import Scenario
    from kreisel.study.trials import paired, simulated

    if text.endswith(".toml"):
        return simulated(Scenario.load(text), args.draws)
    # A file whose own name has the sign comes first.
    imu, equals, truth = (text, "", "") if Path(text).exists() else text.partition("=")
    if equals and not (imu and truth):
        raise UsageError(f"a recording and its truth are two files, IMU=TRUTH; got {text!r}.")
    if equals:
        recording, reference = read(imu, kind="imu"), read(truth)
        assert isinstance(recording, ImuRecording)  # the kind asked for
        if not isinstance(reference, Motion | AttitudeHistory | Poses):
            raise ValueError(f"{truth} holds {type(reference).__name__}; a truth is a file of attitudes.")
        _check(recording, imu, args)
        return [paired(recording, reference, Path(imu).stem)]
    trial = read(imu)
    if not isinstance(trial, Trial):
        raise ValueError(f"{imu} has no truth in it. Name it: {imu}=TRUTH.")
    _check(trial.recording, imu, args)
    return [trial]


def _check(recording: ImuRecording, path: str, args: Namespace) -> None:
    units = Units.of(recording)
    check_units_of(units, path, args.trust_units, by=CONVERT)
    check_readings_of(units, path)


def _write(args: Namespace, tuning: Tuning) -> None:
    import tomli_w

    from kreisel.atomic import replacing

    table = {"kind": args.filter, **_given(args), **{name: new for name, (_, new) in tuning.changed.items()}}
    with replacing(args.output) as stream:
        stream.write(tomli_w.dumps({"filter": [table]}).encode())


def _given(args: Namespace) -> dict[str, Any]:
    from kreisel.cli.filters import parse_settings

    return {**({} if args.mode is None else {"mode": args.mode}), **parse_settings(args.set)}


def _report(args: Namespace, tuning: Tuning) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "filter": args.filter,
        "score": tuning.score,
        "changed": {name: {"from": old, "to": new} for name, (old, new) in tuning.changed.items()},
        "spread": tuning.spread,
        "default_deg": tuning.default_deg,
        "proposed_deg": tuning.proposed_deg,
        "left_out": [asdict(gain) for gain in tuning.left_out],
        "gain": tuning.gain,
        "p_value": tuning.p_value,
        "significant": tuning.significant,
        "verdict": tuning.verdict,
    }


def _print(args: Namespace, tuning: Tuning) -> None:
    from kreisel.cli.tables import print_table

    rows = [[g.recording, f"{g.default_deg:.3f}", f"{g.proposed_deg:.3f}"] for g in tuning.left_out]
    means = [
        sum(getattr(g, name) for g in tuning.left_out) / len(rows) for name in ("default_deg", "proposed_deg")
    ]
    header = [f"{tuning.score} RMSE of {args.filter}, deg", "as it was", "chosen without this recording"]
    print_table(header, rows, [["mean", *(f"{x:.3f}" for x in means)]])
    print()
    if tuning.changed:
        changes = [
            [
                name,
                f"{old:.4g}",
                f"{new:.4g}",
                "{:.4g} to {:.4g}".format(*tuning.spread.get(name, (old, old))),
            ]
            for name, (old, new) in tuning.changed.items()
        ]
        print_table(["chosen on all recordings", "as it was", "proposed", "over the choices"], changes)
        print(
            f"\nOn the recordings it was chosen on: {tuning.default_deg:.3f} to {tuning.proposed_deg:.3f} deg."
        )
    print(tuning.verdict)
    if tuning.significant:
        pairs = " ".join(f"--set {name}={new:.6g}" for name, (_, new) in tuning.changed.items())
        print(f"next: kreisel estimate imu.csv --filter {args.filter} {pairs} -o attitude.tum")
