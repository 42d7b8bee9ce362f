"""Turns a scenario file into many runs of it: statistics, what drives the errors, pictures: `kreisel montecarlo`."""

from __future__ import annotations

import math
import shutil
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from kreisel.cli.notes import note
from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    aligned,
    check_outputs,
    picture,
    write_outputs,
    written,
)
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, print_json, tell_plan
from kreisel.cli.surroundings import describe_free_heading
from kreisel.cli.sweeps import backend
from kreisel.cli.tables import print_table
from kreisel.cli.values import UsageError, as_typed, typed, whole

if TYPE_CHECKING:
    from kreisel.study.ensemble.ensemble import Ensemble
    from kreisel.study.scenario import Scenario

HELP = "many runs of a scenario file, on all cores: how good, how often, and what drives it"

_EXAMPLES = """\
examples:
  kreisel montecarlo scenario.toml --runs 1000 -o ensemble/
  kreisel montecarlo scenario.toml --runs 1000 --vary 'imu.imu.p_BS[0]=normal(0, 0.01)' -o ensemble/
  kreisel montecarlo scenario.toml --runs 100000 -o ensemble/ --resume      # on from where it was interrupted
  kreisel montecarlo scenario.toml --runs 100000 -o ensemble/ --backend tcp://10.0.0.1:8786

What varies beside the noise stands in the file's own [vary] or in --vary: docs/montecarlo.md. Finished runs are kept in
FOLDER/blocks until all are there; clusters: docs/cluster.md.
"""

_ROWS = (
    ("total RMSE, deg", "total_rmse_deg"),
    ("heading RMSE, deg", "heading_rmse_deg"),
    ("inclination RMSE, deg", "inclination_rmse_deg"),
    ("largest total error, deg", "total_max_deg"),
    ("below 5 deg for good after, s", "convergence_time_s"),
    ("(error / sigma)^2", "nees"),
)
BLOCKS = "blocks"
"""Folder of finished runs, beside what is made of them in the end."""

_STATISTICS = ("mean", "p05", "median", "p95", "max")
_MOST_DRIVERS = 5


def _varied(text: str) -> tuple[str, str]:
    """PATH=DISTRIBUTION in its two parts, the second checked."""
    from kreisel.study.ensemble.distributions import Distribution

    path, equals, distribution = text.partition("=")
    if not equals or not path.strip():
        raise ValueError(f"takes PATH=DISTRIBUTION, such as trajectory.period=uniform(6, 10); got {text!r}.")
    Distribution.of(distribution)
    return path.strip(), distribution


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("scenario", metavar="SCENARIO", help="TOML file with the scenario")
    parser.add_argument("--runs", type=whole(1), default=1000, metavar="N", help="how many (default 1000)")
    add_output_folder(parser)
    parser.add_argument(
        "--vary", action="append", type=typed(_varied), default=[], metavar="PATH=DISTRIBUTION",
        help="draw a value in every run: normal(mean, sigma), uniform(a, b), loguniform(a, b), choice(a, b, ...)",
    )  # fmt: skip
    parser.add_argument("--seed", type=whole(0), metavar="N", help="another seed than the file's")
    parser.add_argument("--threads", type=whole(1), metavar="N", help="how many at most (default: all cores)")
    parser.add_argument(
        "--backend", type=typed(backend), metavar="WHERE",
        help="dask for workers on this machine, tcp://HOST:PORT for a scheduler that runs (default: threads)",
    )  # fmt: skip
    parser.add_argument(
        "--resume", action="store_true", help="go on with the finished runs of FOLDER, if there are any"
    )
    parser.add_argument("--no-pictures", action="store_true", help="write data only")
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, check, run, write."""
    from kreisel.study.monte_carlo import monte_carlo

    if args.output is None and not args.dry_run:
        raise UsageError("montecarlo needs a folder for what it makes: -o FOLDER; or --dry-run to look only.")
    started = time.perf_counter()
    scenario = _scenario(args)
    outputs = _outputs(scenario, pictures=not args.no_pictures)
    check_outputs(args.output or Path(), outputs)
    if args.dry_run:
        varied = ", ".join(scenario.vary) or "noise alone"
        return tell_plan(
            args, {args.scenario: f"{args.runs} runs; varied: {varied}"}, written(args.output, outputs)
        )
    blocks = args.output / BLOCKS
    with _resumable(blocks), Progress(args.runs, "runs") as progress:
        made = monte_carlo(
            scenario,
            args.runs,
            backend=args.backend,
            threads=args.threads,
            folder=blocks,
            resume=args.resume,
            on_done=progress.reach,
        )
    spent = time.perf_counter() - started
    lines = write_outputs(args.output, outputs, made)
    # All that was in them is in the ensemble now.
    shutil.rmtree(blocks)
    if args.json:
        print_json(made.report() | {"files": [str(path) for path in written(args.output, outputs)]})
        return 0
    _tell(made)
    for line in describe_free_heading(scenario):
        print(line)
    print(f"\n{_count(made)} in {spent:.1f} s, {made.runs / spent:.0f} a second; written:")
    print(aligned(lines))
    return 0


@contextmanager
def _resumable(blocks: Path) -> Iterator[None]:
    """Say how to go on where what is done inside is interrupted or refused."""
    try:
        yield
    except KeyboardInterrupt:
        note(f"finished runs are in {blocks}: the same command with --resume goes on with them")
        raise


def _scenario(args: Namespace) -> Scenario:
    """The scenario with what was typed; a path that leads nowhere is told as typed."""
    from kreisel.study.monte_carlo import prepare
    from kreisel.study.scenario import Scenario

    scenario = Scenario.load(args.scenario)
    prepare(scenario, args.runs)
    if args.seed is not None:
        scenario = replace(scenario, seed=args.seed)
    with as_typed():
        return prepare(scenario, args.runs, dict(args.vary)).scenario


def _outputs(scenario: Scenario, pictures: bool) -> list[Output[Ensemble]]:
    """Every file that an ensemble of `scenario` writes."""
    from kreisel.study.ensemble import files

    made: list[Output[Ensemble]] = [
        Output(files.SCENARIO, "the scenario with what varies", files.write_scenario),
        Output(files.REPORT, "statistics and correlations, for programs", files.write_report),
        Output(files.ARRAYS, "every run's inputs and errors, quantiles over time", files.write_arrays),
    ]
    pairs = [(imu.name, filter.name) for imu in scenario.imus for filter in scenario.filters]
    for k, (imu, filter) in enumerate(pairs if pictures else []):
        made += _pictures(k, f"{imu}-{filter}".replace(" ", "-"), _draws_numbers(scenario))
    return made


def _draws_numbers(scenario: Scenario) -> bool:
    """Whether anything varies that errors can be correlated with; names, such as those of sensors, cannot."""
    from kreisel.study.ensemble.distributions import Distribution

    values = (Distribution.of(table).values for table in scenario.vary.values())
    return any(all(isinstance(value, int | float) for value in each) for each in values)


def _pictures(k: int, stem: str, drawn: bool) -> list[Output[Ensemble]]:
    from kreisel import show

    made: list[Output[Ensemble]] = [
        picture(f"{stem}-fans.png", "errors over time, as bands of runs", lambda e: show.plot_fans(e, k)),
        picture(f"{stem}-runs.png", "how many runs are how good", lambda e: show.plot_histograms(e, k)),
    ]
    driven: Output[Ensemble] = picture(
        f"{stem}-drivers.png", "what drives the errors", lambda e: show.plot_tornado(e, k)
    )
    return [*made, driven] if drawn else made


def _count(made: Ensemble) -> str:
    return f"{made.runs} run{'' if made.runs == 1 else 's'}"


def _tell(made: Ensemble) -> None:
    for k, each in enumerate(made.estimates):
        print(f"{_count(made)} of {made.base.name or 'a scenario'}: {each.filter} on {each.imu}")
        summary = each.summary()
        rows = [
            (label, *(_shown(summary[name][statistic], statistic) for statistic in _STATISTICS))
            for label, name in _ROWS
            if name in summary
        ]
        print_table(("over runs", "mean", "5 %", "median", "95 %", "worst"), rows)
        for line in _drivers(made, k):
            print(f"  {line}")


def _drivers(made: Ensemble, k: int) -> list[str]:
    """What the heading's error goes with, as far as chance alone would not make it."""
    chance = 2.0 / math.sqrt(made.runs)
    found = {path: rho for path, rho in made.correlations("heading_rmse_deg", k).items() if rho == rho}
    told = [
        f"heading RMSE goes with {path}: rank correlation {rho:+.2f}"
        for path, rho in found.items()
        if abs(rho) > chance
    ]
    if found and not told:
        return [
            f"heading RMSE: no rank correlation above {chance:.2g}, which {made.runs} runs show by chance"
        ]
    return told[:_MOST_DRIVERS]


def _shown(value: float, statistic: str) -> str:
    if value == float("inf"):
        # Of times some of which are never there is no mean.
        return "-" if statistic == "mean" else "never"
    return f"{value:.3g}"
