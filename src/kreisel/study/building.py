"""Turns the recipes of a scenario into the objects they stand for: a trajectory, its times, IMUs and filters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from kreisel import discovery
from kreisel.data.checks import Array, choice
from kreisel.data.environment import Disturbance, Environment
from kreisel.data.frames import WORLDS, to_enu_flu
from kreisel.data.motion import Mount
from kreisel.data.motion_definition import MotionDefinition
from kreisel.data.trajectory import Poses, Trajectory, even_times
from kreisel.files.doors import read
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.imu import Imu
from kreisel.study.imus import make_imu
from kreisel.study.scenario import (
    DisturbanceRecipe,
    EnvironmentRecipe,
    FilterRecipe,
    ImuRecipe,
    Scenario,
    TrajectoryRecipe,
)
from kreisel.study.signature import Place, call, unknown_kind

TRAJECTORIES = "kreisel.simulate.trajectories"
FILTERS = "kreisel.estimate.filters"
DISTURBANCES = "kreisel.simulate.disturbances"


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
    t = _times(scenario, trajectory, place)
    environment = surroundings(scenario.environment, place.at("environment"))
    _check_they_act(environment, t, place.at("environment"))
    made = imus(scenario, environment, place)
    _check_they_last(made, t, place)
    return Parts(
        trajectory,
        t,
        made,
        tuple(
            (recipe.name, _filter(recipe, _told(scenario.environment, environment), place.at("filter", k)))
            for k, recipe in enumerate(scenario.filters)
        ),
    )


def declination(recipe: EnvironmentRecipe) -> float:
    """What filters are told, rad, east positive: as given, else that of the field, else 0."""
    return _told(recipe, surroundings(recipe))


def _told(recipe: EnvironmentRecipe, environment: Environment) -> float:
    if recipe.declination_deg is not None:
        return float(np.deg2rad(recipe.declination_deg))
    return environment.declination or 0.0


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
    if recipe.kind in ("waypoints", "profile") and "path" in recipe.parameters:
        return _from_table(recipe, scenario.folder, where)
    make = None
    if recipe.kind in discovery.names(TRAJECTORIES):
        make = getattr(discovery.load(TRAJECTORIES, recipe.kind), recipe.kind, None)
    if make is None:
        unknown_kind(where, recipe.kind, trajectory_kinds())
    found: Trajectory = call(make, recipe.parameters, where)
    return found


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


def _from_table(recipe: TrajectoryRecipe, folder: Path, where: Place) -> Trajectory:
    """Waypoints or a motion profile whose rows are in a file of their own."""
    from kreisel.files.profiles import read_profile
    from kreisel.files.waypoints import read_waypoints
    from kreisel.simulate.trajectories.gnss_ins_sim import CommandedMotion
    from kreisel.simulate.trajectories.profile import profile
    from kreisel.simulate.trajectories.waypoints import waypoints

    rest = dict(recipe.parameters)
    path = rest.pop("path")
    rows = {"waypoints": "points", "profile": "segments"}[recipe.kind]
    if rows in rest:
        raise ValueError(f"{where}: both path and {rows} say where to go. Give one of the two.")
    if not isinstance(path, str):
        raise ValueError(f"{where.at('path')} must be text in quotes; got {path!r:.60}.")
    if recipe.kind == "waypoints":
        return call(waypoints, rest, where, ready={rows: read_waypoints(folder / path)})
    found = read_profile(folder / path)
    if isinstance(found, MotionDefinition):
        return call(CommandedMotion, rest, where, ready={"definition": found})
    return call(profile, rest, where, ready={rows: found})


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
    # Loaded here: it brings SciPy, which functions of time do without.
    from kreisel.simulate.trajectories.sampled import SampledTrajectory

    if not isinstance(trajectory, SampledTrajectory):
        raise ValueError(f"{place.at('rate_hz')} is missing; only a file has times of its own.")
    own = trajectory.t
    return own[(own >= first) & (own <= last)]


# --- surroundings, sensors, filters ---


def surroundings(recipe: EnvironmentRecipe, where: Place | None = None) -> Environment:
    """The environment of a recipe; ValueError with the key, after `where`, for a place or a date that is none."""
    where = where or Place("environment")
    found = Environment()
    if recipe.latitude_deg is not None and recipe.longitude_deg is not None:
        at = partial(Environment.at, recipe.latitude_deg, recipe.longitude_deg, recipe.height_m or 0.0)
        found = _or_say(where, at, None, turning=recipe.turning)
        if recipe.date is not None:
            found = _or_say(where.at("date"), at, recipe.date, turning=recipe.turning)
    g_N = found.g_N if recipe.gravity is None else np.array([0.0, 0.0, -recipe.gravity])
    field_N_uT = found.field_N_uT if recipe.field_N_uT is None else np.array(recipe.field_N_uT)
    disturbances = tuple(
        _disturbance(each, where.at("disturbance", k)) for k, each in enumerate(recipe.disturbances)
    )
    made = partial(replace, found)
    return _or_say(where, made, g_N=g_N, field_N_uT=field_N_uT, disturbances=disturbances)


def _or_say(where: Place, make: Callable[..., Environment], *given: Any, **named: Any) -> Environment:
    try:
        return make(*given, **named)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


def disturbance_kinds() -> list[str]:
    """The disturbances that a scenario can name."""
    return discovery.names(DISTURBANCES)


def _disturbance(recipe: DisturbanceRecipe, where: Place) -> Disturbance:
    if recipe.kind not in disturbance_kinds():
        unknown_kind(where, recipe.kind, disturbance_kinds())
    make = discovery.load(DISTURBANCES, recipe.kind).DISTURBANCE
    found: Disturbance = call(make, recipe.parameters, where)
    return found


def _check_they_act(environment: Environment, t: Array, where: Place) -> None:
    for k, disturbance in enumerate(environment.disturbances):
        first, last = disturbance.span
        if first > t[-1] or last < t[0]:
            raise ValueError(
                f"{where.at('disturbance', k)} acts from {first:.9g} to {last:.9g} s, and the run lasts from "
                f"{t[0]:.9g} to {t[-1]:.9g} s."
            )


def imus(scenario: Scenario, environment: Environment, where: Place | None = None) -> tuple[Imu, ...]:
    """The IMUs of a scenario; ValueError with the key, after `where`, for what cannot be made."""
    place = where or Place("scenario")
    return tuple(
        _imu(recipe, environment, scenario.folder, place.at("imu", k))
        for k, recipe in enumerate(scenario.imus)
    )


def _imu(recipe: ImuRecipe, environment: Environment, folder: Path, where: Place) -> Imu:
    R_BS = matrix_from_euler(np.deg2rad(recipe.rotation_deg))
    return make_imu(recipe, Mount(np.array(recipe.p_BS), R_BS, recipe.name), environment, folder, where.at)


def _check_they_last(imus: Sequence[Imu], t: Array, where: Place) -> None:
    """Refuse clocks and temperatures that do not suit the times of the run."""
    for k, imu in enumerate(imus):
        try:
            key = "clock"
            imu.clock.check(t)
            key = "temperature"
            if imu.temperature is not None:
                imu.temperature.check_covers(float(t[0]), float(t[-1]))
        except ValueError as error:
            raise ValueError(f"{where.at('imu', k, key)}: {error}") from None


def filter_kinds() -> list[str]:
    """The filters that a scenario can name."""
    return [name.replace("_", "-") for name in discovery.names(FILTERS)]


def _filter(recipe: FilterRecipe, declination: float, where: Place) -> Any:
    if recipe.kind not in filter_kinds():
        unknown_kind(where, recipe.kind, filter_kinds())
    make = discovery.load(FILTERS, recipe.kind.replace("-", "_")).FILTER
    tuning = dict(recipe.tuning)
    if any(f.name == "declination" for f in fields(make)):
        tuning.setdefault("declination", declination)
    return call(make, tuning, where)
