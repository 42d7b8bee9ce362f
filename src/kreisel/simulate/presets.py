"""Turns the file of a sensor preset into the numbers of its datasheet, each with the place where it is stated."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.data.checks import choice
from kreisel.data.noise import NoiseModel
from kreisel.simulate.datasheet import PARAMETERS, Triads, spelled_out, triads

_FOLDER = Path(__file__).parent / "sensors"
_TEXTS = ("part", "maker", "grade", "datasheet")
GRADES = ("consumer", "industrial", "tactical", "navigation", "measured")
"""From the worst to the best; "measured" are those read back from a recording."""


@dataclass(frozen=True, slots=True)
class Preset:
    """A sensor as its datasheet has it."""

    name: str
    part: str
    maker: str
    grade: str  # one of GRADES
    datasheet: str  # document, revision, date
    values: Mapping[str, Any]  # by the names of PARAMETERS
    sources: Mapping[str, str]  # by the same names: table, page, and what was read into it
    notes: str = ""  # what the numbers say of each other, and what was left out

    def triads(self) -> Triads:
        """The sensors in SI units, the magnetometer in microtesla."""
        return triads(self.values)

    @property
    def has_magnetometer(self) -> bool:
        """Whether the datasheet says anything of one."""
        return any(name.startswith("mag_") for name in self.values)


def names() -> list[str]:
    """Presets that come along."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def is_preset(name: str) -> bool:
    """Whether `name` is that of a preset that comes along, with or without its hyphens and capitals."""
    return _key(name) in {_key(known) for known in names()}


def load(name: str | Path) -> Preset:
    """The preset called `name`, or the one in a file whose name ends in .toml.

    Raises ValueError with the nearest name where there is none, or with the key where a file is not sound.
    """
    path = Path(name)
    if path.suffix != ".toml":
        by_key = {_key(known): known for known in names()}
        known = by_key.get(_key(str(name)), str(name))
        path = _FOLDER / f"{choice('sensor', known, names())}.toml"
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise type(error)(f"cannot read {path}: {error.strerror}.") from None
    except ValueError as error:
        raise ValueError(f"{path} is no preset: {error}.") from None
    try:
        return _preset(path.stem, table)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None


def text_of(
    gyro: NoiseModel, accel: NoiseModel, part: str, source: str, mag: NoiseModel | None = None
) -> str:
    """The text of a preset file with the noise of a gyroscope (rad/s) and an accelerometer (m/s^2).

    mag: of a magnetometer (uT), of which presets have white noise alone.
    part: what the sensor is called. source: where the numbers come from, such as the name of a recording.
    """
    import tomli_w

    values = {name: {"value": value, "source": source} for name, value in values_of(gyro, accel, mag).items()}
    table = {"part": part, "maker": "", "grade": "measured", "datasheet": source, "values": values}
    return tomli_w.dumps(table)


def values_of(gyro: NoiseModel, accel: NoiseModel, mag: NoiseModel | None = None) -> dict[str, list[float]]:
    """Datasheet numbers, by their names there, of the noise of a gyroscope (rad/s) and an accelerometer (m/s^2).

    mag: of a magnetometer (uT), of which datasheets have white noise alone.
    """
    values = {}
    models = (
        ("gyro", gyro, _GYRO_NOISE),
        ("accel", accel, _ACCEL_NOISE),
        ("mag", mag or NoiseModel(), _MAG_NOISE),
    )
    for sensor, model, parameters in models:
        for quantity, name in parameters.items():
            value = getattr(model, quantity) / PARAMETERS[f"{sensor}_{name}"].factor
            if value.any():
                values[f"{sensor}_{name}"] = value.tolist()
    return values


_GYRO_NOISE = {
    "white_noise": "arw_deg_per_rth",
    "bias_instability": "bias_instability_deg_per_h",
    "bias_random_walk": "bias_random_walk_deg_per_s_rts",
    "turn_on_bias": "turn_on_bias_deg_per_s",
}
_ACCEL_NOISE = {
    "white_noise": "vrw_m_per_s_rth",
    "bias_instability": "bias_instability_ug",
    "bias_random_walk": "bias_random_walk_ug_rts",
    "turn_on_bias": "turn_on_bias_mg",
}

_MAG_NOISE = {"white_noise": "noise_uT_rthz"}


def _key(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())


def _preset(name: str, table: dict[str, Any]) -> Preset:
    for key in table:
        choice("a key", key, (*_TEXTS, "notes", "values"))
    texts = {"notes": table.get("notes", ""), **{key: table.get(key) for key in _TEXTS}}
    for key, text in texts.items():
        if not isinstance(text, str):
            raise ValueError(f"{key} must be text in quotes; got {text!r:.60}.")
    choice("grade", table["grade"], GRADES)
    entries = table.get("values")
    if not isinstance(entries, dict):
        raise ValueError("the table [values] is missing.")
    entries = {spelled_out(key): entry for key, entry in entries.items()}
    for key, entry in entries.items():
        if not isinstance(entry, dict) or set(entry) != {"value", "source"} or not entry["source"]:
            raise ValueError(f"values.{key} must be {{ value = ..., source = '...' }}; got {entry!r:.60}.")
    values = {key: _plain(entry["value"]) for key, entry in entries.items()}
    preset = Preset(
        name=name,
        **texts,
        values=values,
        sources={key: str(entry["source"]) for key, entry in entries.items()},
    )
    preset.triads()
    return preset


def _plain(value: Any) -> Any:
    """A list as the tuple it stands for; a list of one number thrice as that number."""
    if not isinstance(value, list):
        return value
    return value[0] if len(value) == 3 and np.unique(np.asarray(value)).size == 1 else tuple(value)
