"""Turns true and estimated attitudes, files, into a table of errors and pictures: `kreisel evaluate`."""

from __future__ import annotations

import math
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.cli.batch import Batch, derived, expanded, over_files, shortened
from kreisel.cli.evaluations import mean_of, partner, print_reports, truths_in
from kreisel.cli.notes import complain, note
from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    aligned,
    picture,
    removed,
    write_json,
    write_outputs,
    written,
)
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import UsageError, as_typed, number, one_of

if TYPE_CHECKING:
    from kreisel.data.attitude import AttitudeHistory
    from kreisel.evaluate.attitude_errors import AttitudeErrors, Summary, Truth

HELP = "errors of estimated attitudes against the truth"

SCHEMA = "kreisel.evaluate/1"
SCHEMA_MANY = "kreisel.evaluate-many/1"

_EXAMPLES = """\
examples:
  kreisel evaluate out/truth.npz attitude.npz -o report/
  kreisel evaluate trial.mat attitude.tum --align heading
  kreisel evaluate mocap.csv attitude.csv --align frame+sensor --clock-offset estimate
  kreisel evaluate truth.tum attitude.tum --json --max-total-rmse-deg 2
  kreisel evaluate truths/ 'attitudes/*.tum' -o report/      each against the truth of its own name
  kreisel evaluate 'broad/*.mat' 'attitudes/*.tum' --json
  kreisel evaluate truth.npz dcm.tum mekf.tum                several against one truth

Angles are in degrees. The total error is the angle of the whole rotation between the two, heading its part about
up, inclination the angle between the two directions of up. Files in other worlds or with columns of other names:
kreisel convert them first. Exit code 3: a limit (--max-...) was missed.
"""

# Statistic of the summary -> what it is called.
_LIMITS = {
    "total_rmse_deg": "total RMSE in deg",
    "heading_rmse_deg": "heading RMSE in deg",
    "inclination_rmse_deg": "inclination RMSE in deg",
    "convergence_time_s": "time of convergence in s",
}


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "truth",
        metavar="TRUTH",
        help="motion, poses, attitude, reference or a BROAD trial; or a folder or a pattern in quotes, whose files are "
        "the truths of estimates of the same name",
    )
    parser.add_argument(
        "estimate",
        nargs="+",
        metavar="ESTIMATE",
        help="attitude, or poses with attitude; files or patterns such as 'attitudes/*.tum'",
    )
    for name in ("truth", "estimate"):
        parser.add_argument(f"--{name}-topic", metavar="TOPIC", help=f"topic of {name.upper()}, a ROS bag")
    parser.add_argument(
        "--align",
        metavar="WHAT",
        type=one_of(("heading", "frame", "frame+sensor")),
        help="first remove the constant offset that fits best: heading (a turn about up), frame (any turn), "
        "frame+sensor (also one of the sensor's axes); default: compare as it is",
    )
    parser.add_argument(
        "--clock-offset",
        type=_clock_offset,
        default=0.0,
        metavar="S",
        help="seconds by which the estimate's stamps are ahead of the truth's, or estimate to find them",
    )
    parser.add_argument(
        "--imu",
        metavar="[NAME:]X,Y,Z[:RX,RY,RZ]",
        help="how the sensor is mounted, as kreisel simulate takes it, where TRUTH is the body's attitude",
    )
    parser.add_argument(
        "--limit-deg",
        type=number("degrees", above=0.0),
        default=5.0,
        metavar="DEG",
        help="total error that is converged (5)",
    )
    add_output_folder(parser, "folder for pictures and summary.json")
    add_report_arguments(parser, dry_run=True)
    for name, text in _LIMITS.items():
        parser.add_argument(
            f"--max-{name.replace('_', '-')}",
            dest=name,
            type=number(lowest=0.0),
            metavar=name.rpartition("_")[2].upper(),
            help=f"largest {text} allowed",
        )
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, compare, report; 1 where a file was bad, 3 where a limit was missed."""
    truths, estimates = truths_in(args.truth), expanded(args.estimate)
    if truths is not None or estimates != args.estimate[:1]:
        return _run_many(args, estimates, truths)
    truth = read_truth(args.truth, args.truth_topic or ())
    estimate = _estimate(estimates[0], args.estimate_topic or (), args.imu)
    if args.dry_run:
        outputs = _outputs(truth, estimate, args.limit_deg)
        reads = {args.truth: described(truth), estimates[0]: described(estimate)}
        return tell_plan(args, reads, written(args.output, outputs))
    report, summary, files = _evaluated(args, (args.truth, truth), (estimates[0], estimate), args.output)
    if args.json:
        print_json(report)
    else:
        _print(report, summary, files)
    return _complain_of(report["limits"])


def _run_many(args: Namespace, estimates: Sequence[str], truths: Sequence[str] | None) -> int:
    """The same for several: `truths` to be paired with by name, or one for all."""
    # A name that is wrong is told before anything is written.
    one = read_truth(args.truth, args.truth_topic or ()) if truths is None else None
    folders = [None] * len(estimates) if args.output is None else derived(estimates, f"{args.output}/", "")
    places = dict(zip(estimates, folders, strict=True))
    taken: list[str] = []

    def job(path: str) -> dict[str, Any]:
        name = args.truth if truths is None else partner(path, truths)
        taken.append(name)
        truth = one or read_truth(name, args.truth_topic or ())
        estimate = _estimate(path, args.estimate_topic or (), args.imu)
        if args.dry_run:
            outputs = _outputs(truth, estimate, args.limit_deg)
            return {"told": described(estimate), "writes": written(places[path], outputs)}
        return _evaluated(args, (name, truth), (path, estimate), places[path])[0]

    batch = over_files(estimates, job, "evaluating")
    # A folder may hold other things than truths.
    suffixes = {Path(name).suffix for name in taken}
    lonely = [name for name in truths or () if name not in taken and Path(name).suffix in suffixes]
    if lonely:
        note(f"truths without an estimate: {', '.join(shortened(lonely, 'truths'))}")
    if args.dry_run:
        reads = {path: made["told"] for path, made in batch.done.items()}
        writes = [path for made in batch.done.values() for path in made["writes"]]
        tell_plan(args, reads, writes if args.output is None else [args.output / "summary.json", *writes])
        return batch.code
    return _tell_many(args, batch, lonely)


def _tell_many(args: Namespace, batch: Batch[dict[str, Any]], lonely: Sequence[str]) -> int:
    reports = list(batch.done.values())
    whole = {
        "schema": SCHEMA_MANY,
        "files": reports,
        "mean": mean_of(reports) if reports else None,
        "failed": batch.failed,
        "truths_without_estimate": list(lonely),
    }
    if args.output is not None and reports:
        write_json(whole, args.output / "summary.json")
    if args.json:
        print_json(whole)
    elif reports:
        print_reports(reports)
        if args.output is not None:
            print(f"written: {args.output / 'summary.json'}, and a folder for each with its pictures")
    missed = max(_complain_of(each["limits"], f"{each['estimate']}: ") for each in reports) if reports else 0
    return batch.code or missed


def _evaluated(
    args: Namespace, truth: tuple[str, Truth], estimate: tuple[str, AttitudeHistory], folder: Path | None
) -> tuple[dict[str, Any], Summary, list[str]]:
    """What there is to report of one estimate, its statistics, and a line for each file written; names before data."""
    from kreisel.evaluate.attitude_errors import attitude_errors

    errors = attitude_errors(truth[1], estimate[1], align=args.align, clock_offset=args.clock_offset)
    summary = errors.summary(args.limit_deg)
    report = {
        "schema": SCHEMA,
        "truth": truth[0],
        "estimate": estimate[0],
        "span_s": float(errors.t[-1] - errors.t[0]),
        "summary": asdict(summary),
        "limits": _limits(args, summary),
    }
    files = []
    if folder is not None:
        files = write_outputs(folder, _outputs(truth[1], estimate[1], args.limit_deg), (report, errors))
    return report, summary, files


def _clock_offset(text: str) -> float | str:
    if text == "estimate":
        return text
    try:
        offset = float(text)
    except ValueError:
        offset = math.nan
    if not math.isfinite(offset):
        raise UsageError(f"takes a number of seconds or the word estimate; got {text!r}.")
    return offset


def read_truth(path: str, topic: str | tuple[()] = ()) -> Truth:
    """What a file knows of the true attitude; ValueError for an IMU recording."""
    from kreisel.data.increments import ImuIncrements
    from kreisel.data.recording import ImuRecording
    from kreisel.data.trial import Trial
    from kreisel.files.doors import read

    data = read(path, topic=topic)
    if isinstance(data, ImuRecording | ImuIncrements):
        raise ValueError(f"{path} is an IMU recording and has no attitude to compare with.")
    return data.reference if isinstance(data, Trial) else data


def _estimate(path: str, topic: str | tuple[()], imu: str | None) -> AttitudeHistory:
    from kreisel.data.attitude import AttitudeHistory
    from kreisel.files.doors import read

    data = read(path, kind="attitude", topic=topic)
    assert isinstance(data, AttitudeHistory)  # the kind asked for
    if imu is None:
        return data
    from dataclasses import replace

    from kreisel.cli.commands.simulate import parse_mount

    # Bias and flags stay those of the sensor, whatever frame the attitude is that of.
    with as_typed():
        mount = parse_mount(imu)
    return replace(data, R_NS=data.body(mount).R_NS)


def _limits(args: Namespace, summary: Summary) -> list[dict[str, Any]]:
    """One entry for each limit asked for: its value, and whether it was held."""
    asked = {name: getattr(args, name) for name in _LIMITS if getattr(args, name) is not None}
    values = {name: getattr(summary, name) for name in asked}
    return [
        # A convergence that never came is no number and misses every limit.
        {"name": n, "limit": asked[n], "value": v, "held": v is not None and v <= asked[n]}
        for n, v in values.items()
    ]


def _complain_of(limits: list[dict[str, Any]], where: str = "") -> int:
    missed = [limit for limit in limits if not limit["held"]]
    for limit in missed:
        value = "never" if limit["value"] is None else f"{limit['value']:.4g}"
        complain(f"{where}{_LIMITS[limit['name']]}: {value}, allowed {limit['limit']:g}")
    return 3 if missed else 0


def _print(report: dict[str, Any], summary: Summary, files: list[str]) -> None:
    from kreisel.cli.tables import print_table

    numbers = report["summary"]
    print(f"{report['estimate']} against {report['truth']}")
    print(f"{numbers['samples']} samples that count, over {report['span_s']:.6g} s\n")
    statistics = ("rmse", "mean", "median", "p95", "max")
    rows = [
        [name, *(f"{numbers[f'{name}_{statistic}_deg']:.4g}" for statistic in statistics)]
        for name in ("total", "heading", "inclination")
    ]
    print_table(["error, deg", "RMSE", "mean", "median", "95 %", "max"], rows)
    print()
    for line in _sentences(summary):
        print(line)
    if files:
        print("\n" + aligned(files))


def _sentences(summary: Summary) -> list[str]:
    """What the table does not say: convergence, and every offset that was removed first."""
    since = summary.convergence_time_s
    when = "never" if since is None else "from the start" if since == 0.0 else f"after {since:.4g} s"
    lines = [f"below {summary.convergence_limit_deg:g} deg for good: {when}"]
    return [*lines, *removed(summary)]


def _outputs(
    truth: Truth, estimate: AttitudeHistory, limit_deg: float
) -> list[Output[tuple[dict[str, Any], AttitudeErrors]]]:
    """The files of a report and the errors behind it."""
    from kreisel import show

    outputs: list[Output[tuple[dict[str, Any], AttitudeErrors]]] = [
        Output("summary.json", "all numbers, for programs", lambda made, path: write_json(made[0], path)),
        picture(
            "attitude.png", "the attitude, over the truth", lambda made: show.plot_attitude(estimate, truth)
        ),
        picture(
            "errors.png",
            "total, heading and inclination error over time",
            lambda made: show.plot_attitude_errors(made[1], limit_deg),
        ),
    ]
    if estimate.gyro_bias is not None:
        outputs.append(picture("bias.png", "the estimated gyro bias", lambda made: _bias(estimate, truth)))
    return outputs


def _bias(estimate: AttitudeHistory, truth: Truth) -> Any:
    from kreisel import show

    true_bias = getattr(truth, "gyro_bias", None)
    if true_bias is None:
        return show.plot_bias(estimate)
    return show.plot_bias(estimate, true_bias, truth.t + (truth.t0_ns - estimate.t0_ns) / 1e9)
