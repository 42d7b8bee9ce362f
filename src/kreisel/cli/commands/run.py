"""Turns a scenario file into IMU data, truth, estimated attitude, errors and pictures: `kreisel run`."""

from __future__ import annotations

import json
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kreisel.cli.outputs import aligned, check_names, describe_notes, write_simulation
from kreisel.files.atomic import replacing
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
    either = parser.add_mutually_exclusive_group(required=True)
    either.add_argument("-o", "--output", metavar="FOLDER", help="folder for what is made")
    either.add_argument("--dry-run", action="store_true", help="check the scenario and write nothing")
    parser.add_argument("--no-pictures", action="store_true", help="write data only")
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, check, run, write."""
    from kreisel.study.building import build
    from kreisel.study.scenario import Scenario

    started = time.perf_counter()
    scenario = Scenario.load(args.scenario)
    check_names([imu.name for imu in scenario.imus])
    if args.dry_run:
        t = build(scenario).t
        print(f"{args.scenario}: sound; {len(t)} samples from {t[0]:.6g} to {t[-1]:.6g} s, nothing written")
        return 0
    from kreisel.study.run import run as run_scenario

    folder = Path(args.output)
    result = run_scenario(scenario)
    lines = _write(folder, result, pictures=not args.no_pictures)
    print("\n".join(_described(scenario, result)))
    print("\n".join(f"  {line}" for line in describe_notes(result.motion.notes)))
    print(errors_table(result.estimates))
    print(f"\nwritten in {time.perf_counter() - started:.1f} s:")
    print(aligned(lines))
    return 0


def _described(scenario: Scenario, result: Result) -> list[str]:
    from kreisel.study.building import declination
    from kreisel.study.scenario import TrajectoryRecipe

    t, recipe = result.motion.t, scenario.trajectory
    kind = recipe.kind if isinstance(recipe, TrajectoryRecipe) else type(recipe).__name__
    span = f"{len(t)} samples from {t[0]:.6g} to {t[-1]:.6g} s"
    sensors = ", ".join(dict.fromkeys(imu.sensor or "ideal sensor" for imu in scenario.imus))
    lines = [f"{scenario.name or 'scenario'}: {kind}, {span}, {sensors}, seed {scenario.seed}"]
    if scenario.environment.field_N_uT is not None:
        field = scenario.environment.field_N_uT
        size = f"{np.linalg.norm(field):.4g} uT, dip {np.rad2deg(np.arctan2(-field[2], np.hypot(*field[:2]))):.1f} deg"
        told = f"filters are told a declination of {np.rad2deg(declination(scenario.environment)):.2f} deg"
        lines.append(f"  magnetic field {size}; {told}")
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
    return "attitude errors in deg, root mean square and largest total:\n  " + "\n  ".join(table)


def _write(folder: Path, result: Result, pictures: bool) -> list[str]:
    """Write everything; the lines of a summary that names each file."""
    lines = write_simulation(
        folder, result.motion, result.mounts, result.recordings, recorded=result.recorded, pictures=pictures
    )
    for estimate in result.estimates:
        lines += _write_estimate(folder, estimate)
        if pictures:
            lines += _draw_estimate(folder, result, estimate)
    with replacing(folder / "report.json") as out:
        out.write((json.dumps(result.report(), indent=2, allow_nan=False) + "\n").encode())
    return [*lines, f"{folder / 'report.json'}  the scenario and all errors, for programs"]


def _stem(estimate: Estimate) -> str:
    return f"attitude-{estimate.imu}-{estimate.filter}".replace(" ", "-")


def _write_estimate(folder: Path, estimate: Estimate) -> list[str]:
    stem = _stem(estimate)
    write(folder / f"{stem}.tum", estimate.attitude)
    write(folder / f"{stem}.npz", estimate.attitude)
    return [
        f"{folder / stem}.tum  attitude of {estimate.imu} by filter {estimate.filter!r}, as evo and others read it",
        f"{folder / stem}.npz  the same with bias and flags, for numpy.load",
    ]


def _draw_estimate(folder: Path, result: Result, estimate: Estimate) -> list[str]:
    from kreisel import show

    stem = _stem(estimate)
    mount = next(mount for mount in result.mounts if mount.name == estimate.imu)
    show.save(show.plot_attitude(estimate.attitude, result.motion.at(mount)), folder / f"{stem}.png")
    show.save(show.plot_attitude_errors(estimate.errors), folder / f"{stem}-errors.png")
    return [
        f"{folder / stem}.png  the attitude, over the truth",
        f"{folder / stem}-errors.png  heading and inclination error over time",
    ]
