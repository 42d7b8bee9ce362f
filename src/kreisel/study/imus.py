"""Turns the recipe of an IMU into the IMU: its sensor, what its datasheet says, its clock, temperature and effects."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kreisel import discovery
from kreisel.data.checks import file_name
from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.data.temperature import TemperatureHistory
from kreisel.maths.random import stream
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.context import Context
from kreisel.simulate.datasheet import PARAMETERS, spelled_out
from kreisel.simulate.effects import Effect
from kreisel.simulate.imu import Imu
from kreisel.simulate.order import placed
from kreisel.simulate.trajectories.rest import rest
from kreisel.study.scenario import EffectRecipe, ImuRecipe
from kreisel.study.sensor import sensor_imu
from kreisel.study.signature import Place, call, unknown_kind

EFFECTS = "kreisel.simulate.effects"

_LISTS = {"gyro": "gyro_effects", "accel": "accel_effects", "mag": "mag_effects"}
_READINGS = {"gyro": "gyro", "accel": "accel", "mag": "mag_uT"}


Where = Callable[..., Place]
"""Key and steps into its value -> where that stands, for complaints: in a file, or on the command line."""


def make_imu(recipe: ImuRecipe, mount: Mount, environment: Environment, folder: Path, at: Where) -> Imu:
    """The IMU of `recipe` at `mount`, which says where it sits and what it is called.

    folder: where relative paths begin. Raises ValueError, after the place of the key, for what cannot be.
    """
    _check_numbers(recipe.datasheet, environment, at)
    sensor = _or_say(at("sensor"), sensor_imu, recipe.sensor, mount, environment, folder)
    if recipe.datasheet:
        known = recipe.sensor, mount, environment, folder
        sensor = _or_say(at("datasheet"), sensor_imu, *known, recipe.datasheet)
        for name, effects in _LISTS.items():
            for effect in getattr(sensor, effects):
                _check_suits(effect, sensor, name, at("datasheet"))
    imu = replace(
        sensor,
        clock=_clock(recipe.clock, at),
        temperature=_temperature(recipe.temperature, folder, at("temperature")),
    )
    for k, effect in enumerate(recipe.effects):
        imu = _with_effect(imu, effect, at("effects", k))
    return imu


def _or_say(where: Place, make: Any, *given: Any) -> Any:
    try:
        return make(*given)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{where}: {error}") from None


# --- datasheet ---


def _check_numbers(datasheet: Mapping[str, Any], environment: Environment, at: Where) -> None:
    for key, value in datasheet.items():
        where, name = at("datasheet", key), spelled_out(key)
        if name not in PARAMETERS:
            near = difflib.get_close_matches(name, PARAMETERS, n=1)
            hint = f"did you mean {near[0]!r}?" if near else "kreisel sensors --keys lists all."
            raise ValueError(f"{where} is unknown; {hint}")
        numbers = value if isinstance(value, tuple) else (value,)
        if len(numbers) not in (1, 3) or any(
            isinstance(x, bool) or not isinstance(x, int | float) for x in numbers
        ):
            unit = PARAMETERS[name].unit
            shown = list(value) if isinstance(value, tuple) else value
            raise ValueError(
                f"{where} must be one number, or three, one per axis, {unit}; got {shown!r:.60}."
            )
        if name.startswith("mag_") and environment.field_N_uT is None:
            raise ValueError(f"{where} says nothing where there is no magnetic field; {_FIELD}")


_FIELD = "give the environment field_N_uT, or a place and a date (--place and --date)."

# --- clock and temperature ---


def _clock(table: Mapping[str, Any], at: Where) -> Clock:
    ready = {
        name: call(Sampling, _table(table[name], at("clock", name)), at("clock", name))
        for name in _LISTS
        if name in table
    }
    rest = {name: value for name, value in table.items() if name not in ready}
    return call(_ticking, rest, at("clock"), ready=ready)


def _table(value: Any, where: Place) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ValueError(f"{where} must be a table with rate, latency, window; got {value!r:.60}.")
    return value


def _ticking(
    offset: float = 0.0,
    rate_offset: float = 0.0,
    rate_offset_ppm: float = 0.0,
    jitter: float = 0.0,
    loss: float = 0.0,
    gyro: Sampling | None = None,
    accel: Sampling | None = None,
    mag: Sampling | None = None,
) -> Clock:
    if rate_offset and rate_offset_ppm:
        raise ValueError("rate_offset and rate_offset_ppm say the same; give one of them.")
    sensors = (sensor or Sampling() for sensor in (gyro, accel, mag))
    return Clock(offset, rate_offset or 1e-6 * rate_offset_ppm, jitter, loss, *sensors)


def _temperature(told: Any, folder: Path, where: Place) -> TemperatureHistory | None:
    if told is None:
        return None
    if isinstance(told, str):
        # Loaded here: it brings the readers of files, which a number does without.
        from kreisel.files.temperatures import read_temperature

        found: TemperatureHistory = _or_say(where, read_temperature, folder / told)
        return found
    if isinstance(told, int | float) and not isinstance(told, bool):
        return _or_say(where, TemperatureHistory.constant, told)
    rows = told if isinstance(told, tuple) else ()
    if not rows or any(not isinstance(row, tuple) or len(row) != 2 for row in rows):
        raise ValueError(
            f"{where} must be one temperature, deg C, pairs [time in s, deg C] or the name of a file; got {told!r:.60}."
        )
    history: TemperatureHistory = _or_say(where, _history, rows)
    return history


def _history(rows: tuple[tuple[float, float], ...]) -> TemperatureHistory:
    t, degrees = np.array(rows, dtype=np.float64).T
    return TemperatureHistory(t, degrees)


# --- effects ---


def effect_kinds() -> list[str]:
    """The effects that a scenario can name."""
    return discovery.names(EFFECTS)


def _with_effect(imu: Imu, recipe: EffectRecipe, where: Place) -> Imu:
    if recipe.sensor == "mag" and imu.environment.field_N_uT is None:
        raise ValueError(f"{where} says nothing where there is no magnetic field; {_FIELD}")
    effect, name = _effect(recipe, imu, where), _LISTS[recipe.sensor]
    effects = _or_say(where, placed, getattr(imu, name), effect, recipe.before, recipe.after)
    twice = [each.name for each in effects].count(effect.name) > 1
    if twice:
        raise ValueError(
            f"{where}: the {recipe.sensor} has an effect called {effect.name!r} already, which would draw the same "
            f'numbers; give this one another name, as in name = "{effect.name}_2".'
        )
    return replace(imu, **{name: effects})


def _effect(recipe: EffectRecipe, imu: Imu, where: Place) -> Effect:
    if recipe.kind not in effect_kinds():
        unknown_kind(where, recipe.kind, effect_kinds())
    make = type(discovery.load(EFFECTS, recipe.kind).example())
    effect: Effect = call(make, recipe.parameters, where)
    _or_say(where, file_name, "name", effect.name)
    _check_suits(effect, imu, recipe.sensor, where)
    return effect


def _check_suits(effect: Effect, imu: Imu, sensor: str, where: Place) -> None:
    """Refuse now what would be refused when the recording is made."""
    motion = rest().sample(np.array([0.0, 1.0]))
    surroundings = imu.environment, imu.mount, motion, slice(0, 2), imu.temperature
    at_rest = Context(_READINGS[sensor], 0, motion.t, np.ones(2), np.zeros((2, 3)), *surroundings)
    _or_say(where, effect.start, at_rest, stream(0, 0, sensor, effect.name))
