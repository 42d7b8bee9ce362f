"""Turns a scenario file into IMU data, truth, estimated attitude, errors and pictures: `kreisel run`."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.cli.output_options import add_output_folder
from kreisel.cli.outputs import (
    Output,
    aligned,
    check_imu_names,
    check_outputs,
    describe_notes,
    picture,
    removed,
    simulation_outputs,
    write_json,
    write_outputs,
    written,
)
from kreisel.cli.progress import Progress
from kreisel.cli.reports import add_report_arguments, print_json, tell_plan
from kreisel.cli.sensor_options import describe_sensor, sensor_called
from kreisel.cli.surroundings import describe_field, describe_free_heading, describe_gravity, describe_place
from kreisel.cli.values import UsageError
from kreisel.files.doors import write

if TYPE_CHECKING:
    from kreisel.study.run import Estimate, Result
    from kreisel.study.scenario import Scenario

HELP = "a scenario file: path, IMUs and filters in, data and attitude errors out"

_EXAMPLES = """\
examples:
  kreisel run scenario.toml -o out/
  kreisel run scenario.toml --dry-run        only look for mistakes

docs/scenarios.md explains every key; examples/scenarios/ has files to begin with.
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("scenario", metavar="SCENARIO", help="TOML file with the scenario")
    add_output_folder(parser)
    add_report_arguments(parser, dry_run=True)
    parser.add_argument("--no-pictures", action="store_true", help="write data only")
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, check, run, write."""
    from kreisel.study.building import build
    from kreisel.study.scenario import Scenario

    started = time.perf_counter()
    if args.output is None and not args.dry_run:
        raise UsageError(
            "run needs a folder for what it makes: -o FOLDER; or --dry-run to look for mistakes."
        )
    scenario = Scenario.load(args.scenario)
    outputs = _outputs(scenario, pictures=not args.no_pictures)
    check_outputs(args.output or Path(), outputs)
    if args.dry_run:
        t = build(scenario).t
        reads = {args.scenario: f"{len(t)} samples from {t[0]:.6g} to {t[-1]:.6g} s"}
        return tell_plan(args, reads, written(args.output, outputs))
    from kreisel.study.run import run as run_scenario

    imus, filters = len(scenario.imus), len(scenario.filters)
    with Progress(imus * (1 + filters), "IMUs and filters") as progress:
        result = run_scenario(scenario, on_done=progress.advance)
    lines = write_outputs(args.output, outputs, result)
    if args.json:
        files = [str(path) for path in written(args.output, outputs)]
        print_json(result.report() | {"files": files})
        return 0
    print("\n".join(_described(scenario, result)))
    print("\n".join(f"  {line}" for line in describe_notes(result.motion.notes)))
    print("\n".join([errors_table(result.estimates), *describe_free_heading(scenario)]))
    print(f"\nwritten in {time.perf_counter() - started:.1f} s:")
    print(aligned(lines))
    return 0


def _described(scenario: Scenario, result: Result) -> list[str]:
    from kreisel.study.scenario import TrajectoryRecipe

    t, recipe = result.motion.t, scenario.trajectory
    kind = recipe.kind if isinstance(recipe, TrajectoryRecipe) else type(recipe).__name__
    span = f"{len(t)} samples from {t[0]:.6g} to {t[-1]:.6g} s"
    sensors = ", ".join(dict.fromkeys(map(sensor_called, scenario.imus)))
    lines = [f"{scenario.name or 'scenario'}: {kind}, {span}, {sensors}, seed {scenario.seed}"]
    changed = [line for imu in scenario.imus for line in describe_sensor(imu, f"  {imu.name}, ")]
    return [*lines, *changed, *_surroundings(scenario)]


def _surroundings(scenario: Scenario) -> list[str]:
    from kreisel.study.building import declination, surroundings

    recipe, environment, lines = scenario.environment, surroundings(scenario.environment), []
    if recipe.latitude_deg is not None and recipe.longitude_deg is not None:
        place = describe_place(recipe.latitude_deg, recipe.longitude_deg, recipe.height_m or 0.0)
        day = f" on {recipe.date}" if recipe.date else ""
        lines.append(f"  at {place}{day}: {describe_gravity(environment)}")
    if environment.field_N_uT is not None:
        told = f"filters are told a declination of {np.rad2deg(declination(recipe)):.2f} deg"
        lines.append(f"  {describe_field(environment.field_N_uT)}; {told}")
    if recipe.disturbances:
        lines.append(f"  disturbed by: {', '.join(each.kind for each in recipe.disturbances)}")
    return lines


_COLUMNS = ("IMU", "filter", "total", "heading", "inclination", "largest", "below 5 deg for good")


def errors_table(estimates: Sequence[Estimate]) -> str:
    """Attitude errors in degrees, one row per IMU and filter, the columns aligned."""
    if not estimates:
        return "no filters: nothing was estimated"
    rows: list[tuple[str, ...]] = [_COLUMNS]
    for estimate in estimates:
        s = estimate.summary
        numbers = (s.total_rmse_deg, s.heading_rmse_deg, s.inclination_rmse_deg, s.total_max_deg)
        since = "never" if s.convergence_time_s is None else f"after {s.convergence_time_s:.4g} s"
        rows.append((estimate.imu, estimate.filter, *(f"{x:.3g}" for x in numbers), since))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    table = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
    taken = [f"{e.imu}, {e.filter}, {line}" for e in estimates for line in removed(e.summary)]
    return "attitude errors in deg, root mean square and largest total:\n  " + "\n  ".join([*table, *taken])


def _outputs(scenario: Scenario, pictures: bool) -> list[Output[Result]]:
    """Every file that a run of `scenario` writes."""
    from kreisel.study.building import imus as made_of
    from kreisel.study.building import surroundings
    from kreisel.study.folder import REPORT
    from kreisel.study.sensor import errs

    imus, world = [imu.name for imu in scenario.imus], surroundings(scenario.environment)
    check_imu_names(imus)
    erring = [imu.mount.name for imu in made_of(scenario, world) if errs(imu)]
    magnetometer = world.field_N_uT is not None
    outputs: list[Output[Result]] = [
        *simulation_outputs(imus, erring=erring, magnetometer=magnetometer, pictures=pictures),
        Output(
            REPORT,
            "the scenario and all errors, for programs",
            lambda made, path: write_json(made.report(), path),
        ),
    ]
    pairs = [(imu, filter.name) for imu in imus for filter in scenario.filters]
    for k, (imu, filter) in enumerate(pairs):
        outputs += _estimate_outputs(k, imu, filter, pictures)
    return outputs


def _estimate_outputs(k: int, imu: str, filter: str, pictures: bool) -> list[Output[Result]]:
    """The files of estimate number `k`."""
    from kreisel.study.folder import estimate_stem

    stem = estimate_stem(imu, filter)

    def attitude(made: Result, path: Path) -> None:
        write(path, made.estimates[k].attitude)

    data: list[Output[Result]] = [
        Output(f"{stem}.tum", f"attitude of {imu} by filter {filter!r}, as evo and others read it", attitude),
        Output(f"{stem}.npz", f"attitude of {imu} by filter {filter!r} with bias and flags", attitude),
    ]
    return [*data, *_estimate_pictures(k, imu, stem)] if pictures else data


def _estimate_pictures(k: int, imu: str, stem: str) -> list[Output[Result]]:
    from kreisel import show

    def over_truth(made: Result) -> Any:
        mount = next(mount for mount in made.mounts if mount.name == imu)
        return show.plot_attitude(made.estimates[k].attitude, made.motion.at(mount))

    def errors(made: Result) -> Any:
        return show.plot_attitude_errors(made.estimates[k].errors)

    def bias(made: Result) -> Any:
        return show.plot_bias(made.estimates[k].attitude, _true_bias(made, imu))

    return [
        picture(f"{stem}.png", "the attitude, over the truth", over_truth),
        picture(f"{stem}-errors.png", "heading and inclination error over time", errors),
        picture(f"{stem}-bias.png", "the estimated gyro bias, over the true one", bias),
    ]


def _true_bias(made: Result, imu: str) -> Any:
    """Gyro bias (n, 3) at the recording's stamps; zero for an IMU without errors."""
    known = next((r.gyro_bias for r in made.recorded if r.measured.name == imu), None)
    recording = next(r for r in made.recordings if r.name == imu)
    return np.zeros_like(recording.gyro) if known is None else known
