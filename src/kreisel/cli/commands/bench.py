"""Turns a folder of benchmark recordings into a table of filters and their errors: `kreisel bench`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    check_outputs,
    picture,
    write_json,
    write_outputs,
    written,
)
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import one_of

if TYPE_CHECKING:
    from kreisel.study.broad import Score

HELP = "attitude filters, ours and others', on the BROAD benchmark"

SCHEMA = "kreisel.bench.broad/1"

_EXAMPLES = """\
examples:
  kreisel bench broad BROAD/data_mat
  kreisel bench broad BROAD/data_mat --filter dcm --filter vqf-offline
  kreisel bench broad BROAD/data_mat --json > scores.json

Root mean squares in degrees, over the samples that the benchmark counts, without alignment; "free" ones after each
trial's constant heading offset has been removed. One set of parameters, the default, for all trials. The filters of
others need pip install 'kreisel[compare]'; vqf runs along wherever it is installed, for the ratio to it.
"""

_COLUMNS = {
    "total_rmse_deg": "total",
    "heading_rmse_deg": "heading",
    "inclination_rmse_deg": "inclination",
    "free_total_rmse_deg": "free total",
    "free_heading_rmse_deg": "free heading",
}


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("benchmark", choices=["broad"], help="broad: doi 10.3390/data6070072")
    parser.add_argument("folder", metavar="DIR", help="folder with its trials, *.mat or *.hdf5")
    parser.add_argument(
        "--filter",
        action="append",
        metavar="NAME",
        type=one_of(_filter_names),
        help="a filter to run; may be given several times (default: ours, and all others installed)",
    )
    add_output_folder(parser, "folder for scores.json and a picture")
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Run every filter on every trial and report."""
    from kreisel.study import broad

    names, paths = _chosen(args.filter), broad.trial_files(Path(args.folder))
    outputs = _outputs()
    check_outputs(args.output or Path(), outputs)
    if args.dry_run:
        reads = {str(path): described(broad.read_trial(path)) for path in paths}
        return tell_plan(args, reads, written(args.output, outputs))
    scores = list(_with_progress(broad.scores(names, paths), len(names) * len(paths)))
    means = [broad.mean(_of(scores, name)) for name in names]
    report = _report(scores, means)
    if args.output is not None:
        write_outputs(args.output, outputs, (report, scores))
    if args.json:
        print_json(report)
    else:
        _print(scores, means)
    return 0


def _filter_names() -> list[str]:
    from kreisel.study import broad

    return broad.filter_names()


def _chosen(asked: Sequence[str] | None) -> list[str]:
    """The filters to run, each once; those that are not installed only where they were asked for."""
    from kreisel.study import broad

    known = _filter_names()
    names = [name for name in asked or known if asked or broad.installed(name)]
    if broad.installed(broad.YARDSTICK):
        names.append(broad.YARDSTICK)
    return list(dict.fromkeys(names))


def _with_progress(scores: Iterable[Score], total: int) -> Iterator[Score]:
    """The same scores, counted where a person looks on."""
    with Progress(total, "filters on trials") as progress:
        for score in scores:
            yield score
            progress.advance()


def _of(scores: Sequence[Score], name: str) -> list[Score]:
    return [score for score in scores if score.filter == name]


def _ratios(means: Sequence[Score]) -> dict[str, float]:
    """Mean total error over that of the yardstick; nothing where it did not run."""
    from kreisel.study.broad import YARDSTICK

    yardstick = next((mean.total_rmse_deg for mean in means if mean.filter == YARDSTICK), None)
    return {} if yardstick is None else {mean.filter: mean.total_rmse_deg / yardstick for mean in means}


def _report(scores: Sequence[Score], means: Sequence[Score]) -> dict[str, Any]:
    from kreisel.study.broad import YARDSTICK, settings

    ratios = _ratios(means)
    return {
        "schema": SCHEMA,
        "filters": {mean.filter: settings(mean.filter) for mean in means},
        "scores": [asdict(score) for score in scores],
        "means": [asdict(mean) | {f"ratio_to_{YARDSTICK}": ratios.get(mean.filter)} for mean in means],
    }


def _print(scores: Sequence[Score], means: Sequence[Score]) -> None:
    from kreisel.cli.tables import print_table
    from kreisel.study.broad import YARDSTICK, settings

    for mean in means:
        print(f"{mean.filter}: {settings(mean.filter)}")
        header = ["RMSE, deg", *_COLUMNS.values(), "offset"]
        rows = [[score.trial, *_cells(score)] for score in _of(scores, mean.filter)]
        print_table(header, rows, [[mean.trial, *_cells(mean)]])
        print()
    ratios = _ratios(means)
    header = ["mean RMSE, deg", *_COLUMNS.values(), *([f"total to {YARDSTICK}'s"] if ratios else [])]
    rows = [
        [mean.filter, *_cells(mean)[:-1], *([f"{ratios[mean.filter]:.3f}"] if ratios else [])]
        for mean in sorted(means, key=lambda mean: mean.total_rmse_deg)
    ]
    print_table(header, rows)


def _cells(score: Score) -> list[str]:
    return [f"{getattr(score, name):.3f}" for name in (*_COLUMNS, "heading_offset_deg")]


def _outputs() -> list[Output[tuple[dict[str, Any], Sequence[Score]]]]:
    from kreisel import show

    return [
        Output("scores.json", "all scores, for programs", lambda made, path: write_json(made[0], path)),
        picture("scores.png", "the scores, trial by trial", lambda made: show.plot_broad(made[1])),
    ]
