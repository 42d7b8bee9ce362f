"""Turns the recipes of a scenario into the objects they stand for: a trajectory, its times, IMUs and filters."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from kreisel import discovery
from kreisel.data.checks import Array, choice
from kreisel.data.environment import Environment
from kreisel.data.frames import WORLDS, to_enu_flu
from kreisel.data.motion import Mount
from kreisel.data.trajectory import Poses, Trajectory, even_times
from kreisel.files.doors import read
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.imu import Imu
from kreisel.study.scenario import EnvironmentRecipe, FilterRecipe, ImuRecipe, Scenario, TrajectoryRecipe
from kreisel.study.sensor import sensor_imu
from kreisel.study.signature import Place, call

TRAJECTORIES = "kreisel.simulate.trajectories"
FILTERS = "kreisel.estimate.filters"


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """What a scenario is run with."""

    trajectory: Trajectory
    t: Array  # (n,) s
    imus: tuple[Imu, ...]
    filters: tuple[tuple[str, Any], ...]  # name and AttitudeFilter


def build(scenario: Scenario, where: Place | None = None) -> Parts:
    """Everything a run needs; ValueError with the key, after `where`, for what cannot be made."""
    place = where or Place(f"scenario {scenario.name!r}" if scenario.name else "scenario")
    trajectory = _trajectory(scenario, place)
    surroundings = _environment(scenario.environment)
    return Parts(
        trajectory,
        _times(scenario, trajectory, place),
        tuple(
            _imu(imu, surroundings, scenario.folder, place.at("imu", k))
            for k, imu in enumerate(scenario.imus)
        ),
        tuple(
            (recipe.name, _filter(recipe, declination(scenario.environment), place.at("filter", k)))
            for k, recipe in enumerate(scenario.filters)
        ),
    )


def declination(environment: EnvironmentRecipe) -> float:
    """What filters are told, rad, east positive: as given, else that of the field, else 0."""
    if environment.declination_deg is not None:
        return float(np.deg2rad(environment.declination_deg))
    if environment.field_N_uT is None:
        return 0.0
    east, north, _ = environment.field_N_uT
    return float(np.arctan2(east, north))


# --- trajectory and times ---


def trajectory_kinds() -> list[str]:
    """The kinds that a scenario can name: plug-ins with a function of their own name, and "file"."""
    found = discovery.names(TRAJECTORIES)
    return sorted(["file", *(kind for kind in found if hasattr(discovery.load(TRAJECTORIES, kind), kind))])


def _trajectory(scenario: Scenario, place: Place) -> Trajectory:
    recipe, where = scenario.trajectory, place.at("trajectory")
    if not isinstance(recipe, TrajectoryRecipe):
        return recipe
    if recipe.kind == "file":
        return call(_from_file(scenario.folder), recipe.parameters, where)
    make = None
    if recipe.kind in discovery.names(TRAJECTORIES):
        make = getattr(discovery.load(TRAJECTORIES, recipe.kind), recipe.kind, None)
    if make is None:
        _unknown_kind(recipe.kind, trajectory_kinds(), where)
    found: Trajectory = call(make, recipe.parameters, where)
    return found


def _unknown_kind(kind: str, known: list[str], where: Place) -> NoReturn:
    near = difflib.get_close_matches(kind, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(known) or 'none'}."
    raise ValueError(f"{where.at('kind')} {kind!r} is unknown; {hint}")


def _from_file(folder: Path) -> Callable[..., Trajectory]:
    """The maker of kind "file"; relative paths begin at `folder`."""
    # Loaded here: it brings SciPy, which functions of time do without.
    from kreisel.simulate.trajectories.sampled import MAX_GAP, SampledTrajectory

    def file(
        path: str,
        method: str = "auto",
        orientation: str | None = None,
        frame: str = "enu-flu",
        format: str | None = None,
        position_noise: float | tuple[float, float, float] | None = None,
        attitude_noise: float | tuple[float, float, float] | None = None,
        max_gap: float = MAX_GAP,
    ) -> Trajectory:
        choice("frame", frame, tuple(WORLDS))
        poses = read(folder / path, format, kind="poses")
        assert isinstance(poses, Poses)
        return SampledTrajectory.from_poses(
            to_enu_flu(poses, frame),
            orientation,
            method,
            position_noise=position_noise,
            attitude_noise=attitude_noise,
            max_gap=max_gap,
        )

    return file


def _times(scenario: Scenario, trajectory: Trajectory, place: Place) -> Array:
    """Times of the samples (n,) s."""
    begins, ends = trajectory.span
    first = scenario.start if scenario.start is not None else (begins if np.isfinite(begins) else 0.0)
    if scenario.duration is None and not np.isfinite(ends):
        raise ValueError(f"{place.at('duration')} is missing; this trajectory has no end of its own.")
    last = ends if scenario.duration is None else first + scenario.duration
    # The sum may be rounded beyond the end it was meant to reach.
    slack = 4.0 * np.spacing(max(abs(first), abs(last)))
    if first < begins or last > ends + slack:
        raise ValueError(
            f"{place}: start and duration ask for {first:.9g} to {last:.9g} s; the trajectory holds from "
            f"{begins:.9g} to {ends:.9g} s."
        )
    last = min(last, ends)
    if scenario.rate_hz is not None:
        try:
            return even_times(first, last, scenario.rate_hz)
        except ValueError as error:
            raise ValueError(f"{place}: {error}") from None
    own: Array | None = getattr(trajectory, "t", None)
    if own is None:
        raise ValueError(f"{place.at('rate_hz')} is missing; only a file has times of its own.")
    return own[(own >= first) & (own <= last)]


# --- surroundings, sensors, filters ---


def _environment(recipe: EnvironmentRecipe) -> Environment:
    field = None if recipe.field_N_uT is None else np.array(recipe.field_N_uT)
    return Environment(np.array([0.0, 0.0, -recipe.gravity]), field)


def _imu(recipe: ImuRecipe, environment: Environment, folder: Path, where: Place) -> Imu:
    R_BS = matrix_from_euler(np.deg2rad(recipe.rotation_deg))
    mount = Mount(np.array(recipe.p_BS), R_BS, recipe.name)
    try:
        return sensor_imu(recipe.sensor, mount, environment, folder)
    except ValueError as error:
        raise ValueError(f"{where.at('sensor')}: {error}") from None


def filter_kinds() -> list[str]:
    """The filters that a scenario can name."""
    return [name.replace("_", "-") for name in discovery.names(FILTERS)]


def _filter(recipe: FilterRecipe, declination: float, where: Place) -> Any:
    if recipe.kind not in filter_kinds():
        _unknown_kind(recipe.kind, filter_kinds(), where)
    make = discovery.load(FILTERS, recipe.kind.replace("-", "_")).FILTER
    tuning = dict(recipe.tuning)
    if any(f.name == "declination" for f in fields(make)):
        tuning.setdefault("declination", declination)
    return call(make, tuning, where)
