"""Turns the text of a scenario file into a Scenario and back; whatever could not be run is refused with its key."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from kreisel.files.small import read_small
from kreisel.study.building import build
from kreisel.study.scenario import (
    DisturbanceRecipe,
    EffectRecipe,
    EnvironmentRecipe,
    FilterRecipe,
    ImuRecipe,
    Scenario,
    TrajectoryRecipe,
)
from kreisel.study.signature import Place, call, unknown

_MAX_DEPTH = 10

_TABLES = ("trajectory", "imu", "environment", "filter", "vary")
_OF_FILTERS = ("name", "align", "clock_offset", "start_error_deg")  # keys of a filter that are no tuning
_OF_EFFECTS = ("sensor", "before", "after")  # keys of an effect that are no parameters
_PLURAL = {"imu": "imus", "filter": "filters"}


def load(path: Path) -> Scenario:
    """The scenario in a file; see `Scenario.load`."""
    data = read_small(path, "scenario")
    try:
        return parse(data.decode("utf-8-sig").replace("\r\n", "\n"), path.parent, str(path))
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no scenario: it is not text in UTF-8.") from None


def parse(text: str, folder: Path, source: str) -> Scenario:
    """The scenario that a text writes; see `Scenario.from_toml`."""
    where = Place(source)
    scenario = of_table(_read(text, where), folder, where)
    build(scenario, where)
    if scenario.vary:
        # Loaded here: it makes scenarios of tables with this module.
        from kreisel.study.ensemble.draws import Draws

        Draws(scenario, where).check()
    return scenario


def of_table(table: Mapping[str, Any], folder: Path, where: Place) -> Scenario:
    """The scenario whose plain table this is, its recipes not yet made; ValueError with the key."""
    scalars = {name: value for name, value in table.items() if name not in _TABLES}
    for name in scalars:
        _check_known(where, name)
    if "trajectory" not in table:
        raise ValueError(
            f"{where}: trajectory is missing; a scenario has a table [trajectory] with its kind."
        )
    parts = {
        "trajectory": _trajectory(table["trajectory"], where.at("trajectory")),
        "environment": _environment(_table(table, "environment", where), where.at("environment")),
        "folder": folder,
    }
    if "imu" in table:
        parts["imus"] = tuple(_imu(t, place) for t, place in _tables(table, "imu", where))
    if "filter" in table:
        parts["filters"] = tuple(_filter(t, place) for t, place in _tables(table, "filter", where))
    if "vary" in table:
        parts["vary"] = _checked_table(table["vary"], where.at("vary"))
    return call(Scenario, scalars, where, ready=parts)


def text(scenario: Scenario) -> str:
    """A scenario as TOML; see `Scenario.to_toml`."""
    import tomli_w

    return tomli_w.dumps(table_of(scenario))


def table_of(scenario: Scenario) -> dict[str, Any]:
    """The plain table of a scenario, which `of_table` makes it of again; ValueError for a trajectory of functions."""
    if not isinstance(scenario.trajectory, TrajectoryRecipe):
        raise ValueError(
            f"a {type(scenario.trajectory).__name__} cannot be written to a scenario file; write its functions as "
            'text: TrajectoryRecipe("expressions", {"position": ["cos(t)", "sin(t)", "0"]}).'
        )
    table = _given(scenario, leave_out=("trajectory", "imus", "environment", "filters", "vary", "folder"))
    table["trajectory"] = {"kind": scenario.trajectory.kind, **_filled(scenario.trajectory.parameters)}
    table["environment"] = _given(scenario.environment, leave_out=("disturbances",))
    if scenario.environment.disturbances:
        table["environment"]["disturbance"] = [
            {"kind": d.kind, **_filled(d.parameters)} for d in scenario.environment.disturbances
        ]
    table["imu"] = [_imu_table(imu) for imu in scenario.imus]
    table["filter"] = [{**_given(f, leave_out=("tuning",)), **_filled(f.tuning)} for f in scenario.filters]
    if scenario.vary:
        table["vary"] = dict(scenario.vary)
    made: dict[str, Any] = _lists(table)
    return made


# --- reading ---


def _read(text: str, where: Place) -> dict[str, Any]:
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise ValueError(f"{where} is no scenario: its values are nested too deeply.") from None
    except ValueError as error:
        raise ValueError(f"{where} is not TOML: {error}.") from None
    level: list[Any] = [table]
    for _ in range(_MAX_DEPTH):
        level = [inner for value in level for inner in _inside(value)]
    if level:
        raise ValueError(f"{where} is no scenario: its values are nested more than {_MAX_DEPTH} deep.")
    return table


def _inside(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return value if isinstance(value, list) else []


def _check_known(where: Place, name: str) -> None:
    known = [f.name for f in fields(Scenario) if f.name not in (*_PLURAL.values(), "vary", "folder")]
    if name not in known:
        unknown(where, name, [*known, *_PLURAL, "vary"])


def _trajectory(table: Any, where: Place) -> TrajectoryRecipe:
    kind, parameters = _kind(table, where)
    return call(TrajectoryRecipe, {"kind": kind}, where, ready={"parameters": parameters})


def _imu(table: Mapping[str, Any], where: Place) -> ImuRecipe:
    rest = dict(table)
    # Their keys are looked at when the IMU is built, where it is known what they mean.
    ready: dict[str, Any] = {
        name: _checked_table(rest.pop(name), where.at(name))
        for name in ("datasheet", "clock")
        if name in rest
    }
    if "effects" in rest:
        ready["effects"] = tuple(_effect(t, place) for t, place in _tables(table, "effects", where))
        del rest["effects"]
    for name in rest:
        known = [f.name for f in fields(ImuRecipe)]
        if name not in known:
            unknown(where, name, known)
    return call(ImuRecipe, rest, where, ready=ready)


def _effect(table: Mapping[str, Any], where: Place) -> EffectRecipe:
    kind, parameters = _kind(table, where)
    own = {name: parameters.pop(name) for name in _OF_EFFECTS if name in parameters}
    return call(EffectRecipe, {"kind": kind, **own}, where, ready={"parameters": parameters})


def _environment(table: Mapping[str, Any], where: Place) -> EnvironmentRecipe:
    known = [*(f.name for f in fields(EnvironmentRecipe) if f.name != "disturbances"), "disturbance"]
    for name in table:
        if name not in known:
            unknown(where, name, known)
    rest = dict(table)
    # TOML writes a date without quotes, which the check of the other keys does not know.
    ready: dict[str, Any] = {"date": rest.pop("date")} if "date" in rest else {}
    if "disturbance" in rest:
        found = _tables(table, "disturbance", where)
        ready["disturbances"] = tuple(_disturbance(t, place) for t, place in found)
        del rest["disturbance"]
    return call(EnvironmentRecipe, rest, where, ready=ready)


def _disturbance(table: Any, where: Place) -> DisturbanceRecipe:
    kind, parameters = _kind(table, where)
    return call(DisturbanceRecipe, {"kind": kind}, where, ready={"parameters": parameters})


def _filter(table: Any, where: Place) -> FilterRecipe:
    kind, tuning = _kind(table, where)
    own = {name: tuning.pop(name) for name in _OF_FILTERS if name in tuning}
    return call(FilterRecipe, {"kind": kind, **own}, where, ready={"tuning": tuning})


def _kind(table: Any, where: Place) -> tuple[str, dict[str, Any]]:
    """The kind that a table names, and the rest of it."""
    rest = dict(_checked_table(table, where))
    kind = rest.pop("kind", None)
    if not isinstance(kind, str):
        what = "is missing" if kind is None else f"must be text in quotes; got {kind!r}"
        raise ValueError(f"{where.at('kind')} {what}.")
    return kind, rest


def _table(table: Mapping[str, Any], name: str, where: Place) -> Mapping[str, Any]:
    return _checked_table(table.get(name, {}), where.at(name))


def _tables(table: Mapping[str, Any], name: str, where: Place) -> list[tuple[Mapping[str, Any], Place]]:
    """The tables [[name]], or the only one, [name], each with its place."""
    if isinstance(table[name], dict):
        return [(table[name], where.at(name))]
    if not isinstance(table[name], list):
        raise ValueError(f"{where.at(name)} must be tables [[{name}]]; got {table[name]!r:.60}.")
    places = [where.at(name, k) for k in range(len(table[name]))]
    return [(_checked_table(t, place), place) for t, place in zip(table[name], places, strict=True)]


def _checked_table(table: Any, where: Place) -> Mapping[str, Any]:
    if not isinstance(table, dict):
        raise ValueError(f"{where} must be a table; got {table!r:.60}.")
    return table


# --- writing ---


def _imu_table(imu: ImuRecipe) -> dict[str, Any]:
    table = _given(imu, leave_out=("datasheet", "clock", "effects"))
    table |= {name: _filled(getattr(imu, name)) for name in ("datasheet", "clock") if getattr(imu, name)}
    if imu.effects:
        table["effects"] = [
            {**_given(e, leave_out=("parameters",)), **_filled(e.parameters)} for e in imu.effects
        ]
    return table


def _given(part: Any, leave_out: tuple[str, ...] = ()) -> dict[str, Any]:
    """The fields of a recipe that hold something: TOML knows no None."""
    return _filled({f.name: getattr(part, f.name) for f in fields(part) if f.name not in leave_out})


def _filled(table: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in table.items() if value is not None}


def _lists(value: Any) -> Any:
    """Tuples as lists, all the way down."""
    if isinstance(value, dict):
        return {name: _lists(item) for name, item in value.items()}
    return [_lists(item) for item in value] if isinstance(value, list | tuple) else value
