"""Turns --set, --clock, --temperature and --effect, which say what is wrong with sensors, into the recipe of an IMU."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from kreisel.cli.values import as_typed

if TYPE_CHECKING:
    from kreisel.data.environment import Environment
    from kreisel.data.motion import Mount
    from kreisel.simulate.imu import Imu
    from kreisel.study.scenario import EffectRecipe, ImuRecipe
    from kreisel.study.signature import Place

_OPTIONS = {"datasheet": "--set", "sensor": "--imu", "clock": "--clock", "temperature": "--temperature"}


def add_sensor_arguments(parser: ArgumentParser) -> None:
    """--set, --clock, --temperature and --effect."""
    group = parser.add_argument_group(
        "what is wrong with the sensors, all of them: where each has its own, write a scenario (docs/scenarios.md)"
    )
    group.add_argument(
        "--set",
        action="append",
        metavar="KEY=VALUE",
        help="a number of a datasheet in place of the sensor's or beside them, as in "
        "--set gyro_noise_dps_rthz=0.02 or --set accel_fixed_bias_mg=3/-2/5 for the axes; kreisel sensors --keys lists "
        "all; commas between several, or given several times",
    )
    group.add_argument(
        "--clock",
        action="append",
        metavar="KEY=VALUE",
        help="of the clock: offset, jitter s, rate_offset_ppm, loss (probability that a sample is lost), and of one "
        "sensor rate Hz, latency, window s, as in --clock jitter=1e-4,loss=0.01,mag.rate=50",
    )
    group.add_argument(
        "--temperature",
        metavar="DEGC|FILE",
        help="of the sensors, deg C, or the name of a csv with columns t [s] and temperature [degC] (default 25)",
    )
    group.add_argument(
        "--effect",
        action="append",
        metavar="SENSOR:KIND:KEY=VALUE",
        help="one more error of gyro, accel or mag (docs/effects.md, SI units), as in "
        "--effect gyro:scale_factor:error=0.01; before=NAME or after=NAME for another place than the physical one; may "
        "be given several times",
    )


def sensor_recipe(args: Namespace) -> ImuRecipe:
    """What the options say of every IMU. ValueError for what is not KEY=VALUE."""
    from kreisel.study.scenario import ImuRecipe

    return ImuRecipe(
        datasheet=dict(_pairs("--set", args.set or ())),
        clock=_nested(_pairs("--clock", args.clock or ())),
        temperature=None if args.temperature is None else _value(args.temperature),
        effects=tuple(_effect(text) for text in args.effect or ()),
    )


def made(recipe: ImuRecipe, mount: Mount, environment: Environment) -> Imu:
    """The IMU of a recipe; complaints name the option, and are about what was typed unless a file had a part in it."""
    from contextlib import nullcontext

    from kreisel.study.imus import make_imu
    from kreisel.study.signature import Place

    def at(key: str, *steps: int | str) -> Place:
        if key == "effects":
            effect = recipe.effects[int(steps[0])]
            return Place(f"--effect {effect.sensor}:{effect.kind}")
        return Place(_OPTIONS[key], steps)

    of_files = isinstance(recipe.temperature, str) or Path(recipe.sensor or "").suffix
    with nullcontext() if of_files else as_typed():
        return make_imu(recipe, mount, environment, Path(), at)


def sensor_called(recipe: ImuRecipe) -> str:
    """What to call the sensor of a recipe in a summary."""
    return recipe.sensor or ("a sensor of its own" if recipe.datasheet or recipe.effects else "ideal sensor")


def describe_sensor(recipe: ImuRecipe, prefix: str = "  ") -> list[str]:
    """What is said of the sensor beside its name, in lines that begin with `prefix`; none where nothing is."""
    lines = []
    if recipe.datasheet:
        told = (f"{name} = {_shown(value)}" for name, value in recipe.datasheet.items())
        lines.append(f"datasheet: {', '.join(told)}")
    if recipe.clock:
        lines.append(f"clock: {', '.join(_told(recipe.clock))}")
    if recipe.temperature is not None:
        lines.append(f"temperature: {_warmth(recipe.temperature)}")
    if recipe.effects:
        lines.append(f"effects: {', '.join(map(_added, recipe.effects))}")
    return [
        part
        for line in lines
        for part in wrap(prefix + line, 118, subsequent_indent="    ", break_long_words=False)
    ]


def _added(effect: EffectRecipe) -> str:
    place = [f"{key} {name}" for key in ("before", "after") if (name := getattr(effect, key))]
    return f"{effect.kind} of the {effect.sensor} ({', '.join([*_told(effect.parameters), *place])})"


def _warmth(temperature: Any) -> str:
    if isinstance(temperature, tuple):
        (first, begins), (last, ends) = temperature[0], temperature[-1]
        return f"{begins:g} deg C at {first:g} s to {ends:g} deg C at {last:g} s"
    return f"from {temperature}" if isinstance(temperature, str) else f"{temperature:g} deg C"


def _told(table: Any, prefix: str = "") -> Iterator[str]:
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _told(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name} = {_shown(value)}"


def _shown(value: Any) -> str:
    return json.dumps(value)


def _pairs(option: str, texts: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """KEY and value of "KEY=VALUE,KEY=VALUE" in each text."""
    seen = set()
    for part in (part for text in texts for part in _parts(text)):
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not (key and equals and value):
            raise ValueError(f"{option} takes KEY=VALUE, with commas between several; got {part!r}.")
        if key in seen:
            raise ValueError(f"{option} has {key} twice; give it once.")
        seen.add(key)
        try:
            yield key, _value(value)
        except ValueError:
            raise ValueError(f"{option} {key} takes a list written as [1, 2, 3]; got {value!r}.") from None


def _parts(text: str) -> list[str]:
    """What stands between the commas that no bracket is open around."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter == "[") - (letter == "]")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def _value(text: str) -> Any:
    """A number, numbers parted by /, a list in brackets, or else the text as it is."""
    if text.startswith("["):
        return json.loads(text)
    try:
        numbers = [float(part) for part in text.split("/")]
    except ValueError:
        return text
    return numbers[0] if len(numbers) == 1 else numbers


def _nested(pairs: Iterator[tuple[str, Any]]) -> dict[str, Any]:
    """{"gyro": {"rate": 100}} from "gyro.rate"."""
    table: dict[str, Any] = {}
    for key, value in pairs:
        *way, last = key.split(".")
        inner = table
        for step in way:
            inner = inner.setdefault(step, {})
            if not isinstance(inner, dict):
                raise ValueError(f"--clock has both {step}=... and {key}=...; give one of them.")
        inner[last] = value
    return table


def _effect(text: str) -> EffectRecipe:
    from kreisel.study.scenario import EffectRecipe

    sensor, _, rest = text.partition(":")
    kind, _, pairs = rest.partition(":")
    if not kind:
        raise ValueError(
            f"--effect takes SENSOR:KIND:KEY=VALUE,..., such as gyro:scale_factor:error=0.01; got {text!r}."
        )
    parameters = dict(_pairs("--effect", [pairs] if pairs else ()))
    place = {key: parameters.pop(key) for key in ("before", "after") if key in parameters}
    try:
        return EffectRecipe(sensor, kind, parameters, **place)  # type: ignore[arg-type]
    except ValueError as error:
        raise ValueError(f"--effect {text}: {error}") from None
