"""Turns a Scenario into a Result: true motion, what the IMUs read, what the filters made of it, and their errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.data.cards import Card, Shown, course
from kreisel.data.checks import Array
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.maths.rotations import euler_from_matrix, matrix_from_euler
from kreisel.study.building import build, declination, surroundings
from kreisel.study.scenario import EnvironmentRecipe, FilterRecipe, Scenario, TrajectoryRecipe
from kreisel.study.sensor import record_all

if TYPE_CHECKING:
    from kreisel.data.attitude import AttitudeHistory
    from kreisel.evaluate.attitude_errors import AttitudeErrors, Summary
    from kreisel.simulate.recorded import Recorded

SCHEMA = "kreisel.run/1"


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """What one filter made of what one IMU read."""

    imu: str
    filter: str
    attitude: AttitudeHistory  # of the sensor, R_NS
    errors: AttitudeErrors  # against the true attitude of the sensor

    @property
    def summary(self) -> Summary:
        """Statistics of the errors over all samples."""
        return self.errors.summary()


@dataclass(frozen=True, slots=True, eq=False)
class Result(Shown):
    """Everything that one run made."""

    scenario: Scenario
    motion: Motion  # of the body, the truth
    mounts: tuple[Mount, ...]  # one per IMU
    recordings: tuple[ImuRecording, ...]  # one per IMU
    estimates: tuple[Estimate, ...]  # one per IMU and filter, IMU by IMU
    recorded: tuple[Recorded, ...] = ()  # of the IMUs with errors: truth and every error term

    def card(self) -> Card:
        """The errors of every filter on every IMU."""
        found = [(e.imu, e.filter, e.summary) for e in self.estimates]
        rows = [
            (
                imu,
                filter,
                *(f"{getattr(s, f'{name}_rmse_deg'):.4g}" for name in ("total", "heading", "inclination")),
            )
            for imu, filter, s in found
        ]
        title = f"Result {self.scenario.name!r}: {course(self.motion, self.motion.t)}"
        return Card(title, ("IMU", "filter", "total RMSE, deg", "heading", "inclination"), rows)

    def report(self) -> dict[str, Any]:
        """The run in numbers and texts that JSON holds; "schema" names their layout.

        Angles in deg as their names say; `null` where there is none.
        """
        t = self.motion.t
        return {
            "schema": SCHEMA,
            "scenario": described(self.scenario),
            "samples": len(t),
            "start_s": float(t[0]),
            "end_s": float(t[-1]),
            "t0_ns": self.motion.t0_ns,
            "notes": [asdict(note) for note in self.motion.notes],
            "imus": [{"name": r.name, "magnetometer": r.mag_uT is not None} for r in self.recordings],
            "estimates": [
                {"imu": e.imu, "filter": e.filter, "errors": json_safe(asdict(e.summary))}
                for e in self.estimates
            ],
        }


def run(scenario: Scenario, on_done: Callable[[], object] | None = None) -> Result:
    """Sample, record, estimate, compare. Raises ValueError for a recipe that cannot be made.

    on_done : called after each IMU, and after each filter on each IMU.
    """
    parts = build(scenario)
    motion = parts.trajectory.sample(parts.t)
    recordings, recorded = record_all(parts.imus, motion, scenario.seed, on_done, scenario.run)
    estimates = []
    for imu, recording in zip(parts.imus, recordings, strict=True):
        for recipe, (_, filter) in zip(scenario.filters, parts.filters, strict=True):
            estimates.append(estimated(recipe, filter, recording, motion.at(imu.mount)))
            if on_done is not None:
                on_done()
    mounts = tuple(imu.mount for imu in parts.imus)
    return Result(scenario, motion, mounts, recordings, tuple(estimates), recorded)


def estimated(recipe: FilterRecipe, filter: Any, recording: ImuRecording, truth: Motion) -> Estimate:
    """What the `filter` of a recipe makes of a recording of the sensor whose true motion is `truth`."""
    # Loaded here: numba's kernels, which a scenario without filters need not wait for.
    from kreisel.estimate.run import run as attitude_of
    from kreisel.evaluate.attitude_errors import attitude_errors

    attitude = attitude_of(filter, recording, first_attitude(recipe, truth))
    errors = attitude_errors(truth, attitude, align=recipe.align, clock_offset=recipe.clock_offset)
    return Estimate(recording.name, recipe.name, attitude, errors)


def first_attitude(recipe: FilterRecipe, truth: Motion) -> Array | None:
    """R_NS (3, 3) that a filter begins with: the true one, its roll, pitch and heading off by what the recipe says."""
    if recipe.start_error_deg is None:
        return None
    return matrix_from_euler(euler_from_matrix(truth.R_NB[0]) + np.deg2rad(recipe.start_error_deg))


def described(scenario: Scenario) -> dict[str, Any]:
    """The scenario as its file would have it, but for a trajectory of functions, which is named by its class."""
    trajectory = scenario.trajectory
    if not isinstance(trajectory, TrajectoryRecipe):
        trajectory = TrajectoryRecipe(type(trajectory).__name__)
    table = asdict(replace(scenario, trajectory=trajectory))
    table["environment"] |= _resolved(scenario.environment)
    del table["folder"]
    return json_safe(table)


def _resolved(recipe: EnvironmentRecipe) -> dict[str, Any]:
    """What was left to the place and the date, in the keys of the recipe."""
    found = surroundings(recipe)
    return {
        "gravity": float(-found.g_N[2]),
        "field_N_uT": None if found.field_N_uT is None else found.field_N_uT.tolist(),
        "declination_deg": float(np.rad2deg(declination(recipe))),
        "date": None if recipe.date is None else recipe.date.isoformat(),
    }


def json_safe(value: Any) -> Any:
    """`value` with tuples as lists, and None for the numbers that JSON does not know."""
    if isinstance(value, Mapping):
        return {name: json_safe(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [json_safe(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
