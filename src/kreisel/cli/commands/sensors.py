"""Turns sensor presets into a table, and one of them into its numbers with their sources: `kreisel sensors`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from dataclasses import replace
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.cli.reports import add_report_arguments, print_json
from kreisel.cli.tables import plain, print_table
from kreisel.cli.values import UsageError, number, sensor_name
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.noise import ALLAN_FLOOR, NoiseModel

if TYPE_CHECKING:
    from kreisel.simulate.presets import Preset

HELP = "sensors to simulate, from their datasheets; one with its numbers and where they are stated"

SCHEMA = "kreisel.sensors/1"

_EXAMPLES = """\
examples:
  kreisel sensors                        all presets
  kreisel sensors bmi088                 one, each value with its source
  kreisel sensors --keys                 every number of a datasheet that can be given, with its unit
  kreisel sensors imu.yaml               what the numbers of a kalibr file mean
  kreisel sensors mine.toml --kalibr imu.yaml --rate 200
  kreisel sensors bmi088 --kalibr imu.yaml --rate 200 --gyro-walk 2e-5 --accel-walk 3e-4

docs/datasheets.md says how a datasheet becomes a noise model.
"""

# Of both sensors: what is shown, its unit, and that unit over the SI one.
_DEG = 180.0 / np.pi
_SHOWN = {
    "gyro": (
        ("white_noise", "angle random walk N", "deg/sqrt(h)", _DEG * 60.0),
        ("bias_instability", "bias instability, floor", "deg/h", _DEG * 3600.0 * ALLAN_FLOOR),
        ("bias_random_walk", "bias random walk K", "deg/s/sqrt(s)", _DEG),
        ("turn_on_bias", "turn-on bias, one sigma", "deg/s", _DEG),
    ),
    "accel": (
        ("white_noise", "velocity random walk N", "m/s/sqrt(h)", 60.0),
        ("bias_instability", "bias instability, floor", "ug", 1e6 / STANDARD_GRAVITY * ALLAN_FLOOR),
        ("bias_random_walk", "bias random walk K", "ug/sqrt(s)", 1e6 / STANDARD_GRAVITY),
        ("turn_on_bias", "turn-on bias, one sigma", "mg", 1e3 / STANDARD_GRAVITY),
    ),
    "mag": (
        ("white_noise", "white noise N", "uT/sqrt(Hz)", 1.0),
        ("turn_on_bias", "turn-on bias, one sigma", "uT", 1.0),
    ),
}
_WALKS = {"gyro": "rad/s^2/sqrt(Hz)", "accel": "m/s^3/sqrt(Hz)"}
_RANGES = {"gyro": "gyro_range_deg_per_s", "accel": "accel_range_g"}
_UNITS = {"gyro": "rad/s", "accel": "m/s^2", "mag": "uT"}
# The same of what is no noise: its SI unit.
_ERRORS = {
    "g_sensitivity": "rad/s per m/s^2",
    "temperature_bias": "{}/K",
    "temperature_scale": "1/K",
    "cubic": "1/({})^2, of x^3",
    "fixed_bias": "{}",
    "fixed_scale": "relative",
    "fixed_g_sensitivity": "rad/s per m/s^2",
    "fixed_temperature_bias": "{}/K",
    "fixed_temperature_scale": "1/K",
}
_SI = {
    "white_noise": "{}/sqrt(Hz)",
    "bias_instability": "{}",
    "bias_random_walk": "{}/sqrt(s)",
    "turn_on_bias": "{}",
}


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "sensor",
        nargs="?",
        type=sensor_name,
        metavar="SENSOR",
        help="a preset, a .toml file, or kalibr's .yaml",
    )
    add_report_arguments(parser)
    parser.add_argument(
        "--keys",
        action="store_true",
        help="the names by which numbers of a datasheet are given, with unit and meaning",
    )
    parser.add_argument("--kalibr", metavar="FILE", help="also write the sensor's noise as kalibr's imu.yaml")
    for name, unit in _WALKS.items():
        parser.add_argument(
            f"--{name}-walk", type=number(unit, lowest=0.0), metavar="K",
            help=f"random walk of its bias to write there, {unit}, in place of the sensor's own: few datasheets state "
            "any, and kalibr needs one",
        )  # fmt: skip
    parser.add_argument(
        "--rate",
        type=number("hertz", above=0.0),
        default=200.0,
        metavar="HZ",
        help="rate to write there (default 200)",
    )
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """List all, or show one."""
    from kreisel.simulate.presets import GRADES, load, names

    if args.keys:
        _list_keys(args.json)
        return 0
    if args.sensor is None:
        if args.kalibr:
            raise UsageError("--kalibr writes one sensor; name it: kreisel sensors SENSOR --kalibr FILE.")
        presets = sorted(map(load, names()), key=lambda preset: GRADES.index(preset.grade))
        _list(presets, args.json)
        return 0
    if Path(args.sensor).suffix in (".yaml", ".yml"):
        from kreisel.files.kalibr import read_kalibr

        found = read_kalibr(args.sensor)
        models, preset = {"gyro": found.gyro, "accel": found.accel}, None
    else:
        preset = load(args.sensor)
        models = _models(preset)
    if args.kalibr:
        from kreisel.files.kalibr import KalibrImu, write_kalibr

        gyro, accel = (_walking(models[name], getattr(args, f"{name}_walk")) for name in _WALKS)
        write_kalibr(args.kalibr, KalibrImu(gyro, accel, args.rate))
    if args.json:
        told = _preset_json(preset) if preset else {"name": args.sensor, "noise": _noise_json(models)}
        print_json({"schema": SCHEMA, "sensors": [told]})
    else:
        print("\n".join([*(_stated(preset) if preset else [args.sensor]), *_meaning(models, preset)]))
        if args.kalibr:
            print(f"\n{args.kalibr}  written for kalibr")
    return 0


def _walking(model: NoiseModel, walk: float | None) -> NoiseModel:
    return model if walk is None else replace(model, bias_random_walk=walk)


def _list(presets: list[Preset], as_json: bool) -> None:
    if as_json:
        told = [_preset_json(preset) for preset in presets]
        print_json({"schema": SCHEMA, "sensors": told})
        return
    header = (
        "sensor",
        "grade",
        "gyro deg/sqrt(h)",
        "deg/h",
        "range",
        "accel m/s/sqrt(h)",
        "ug",
        "range",
        "mag",
    )
    print_table(header, [_row(preset) for preset in presets])
    print(
        "\nrandom walk N, bias instability (floor of the Allan deviation), range in deg/s and g, magnetometer; "
        "- is not stated. kreisel sensors SENSOR shows more."
    )


def _list_keys(as_json: bool) -> None:
    from kreisel.simulate.datasheet import PARAMETERS

    if as_json:
        told = {name: {"unit": p.unit, "meaning": p.meaning} for name, p in PARAMETERS.items()}
        print_json({"schema": SCHEMA, "keys": told})
        return
    width, units = max(map(len, PARAMETERS)), max(len(p.unit) for p in PARAMETERS.values())
    for name, p in PARAMETERS.items():
        print(f"{name:<{width}}  {p.unit:<{units}}  {p.meaning}")
    print(
        "\none number, or one per axis; one sigma is drawn in every run. dps, dph and per_degC stand for deg_per_s, "
        "deg_per_h and per_K.\ndocs/datasheets.md says how each becomes a model."
    )


def _row(preset: Preset) -> tuple[str, ...]:
    cells, models = [preset.name, preset.grade], _models(preset)
    for sensor, size in _RANGES.items():
        model = models[sensor]
        cells += [_cell(getattr(model, quantity) * factor) for quantity, _, _, factor in _SHOWN[sensor][:2]]
        cells.append(_cell(preset.values.get(size, 0)))
    return (*cells, "yes" if preset.has_magnetometer else "-")


def _models(preset: Preset) -> dict[str, NoiseModel]:
    """Noise by sensor, in SI units and microtesla; of a magnetometer where there is one."""
    gyro, accel, mag = preset.triads()
    models = {"gyro": gyro.noise, "accel": accel.noise}
    return {**models, "mag": mag.noise} if preset.has_magnetometer else models


def _cell(value: Any) -> str:
    """The largest of the axes, to four digits."""
    worst = float(np.max(value))
    return f"{worst:.4g}" if worst else "-"


def _stated(preset: Preset) -> list[str]:
    from kreisel.simulate.datasheet import PARAMETERS

    lines = [f"{preset.part}, {preset.maker}, {preset.grade}".replace(", ,", ","), preset.datasheet, ""]
    for name, value in preset.values.items():
        axes = " ".join(f"{x:g}" for x in np.atleast_1d(value))
        lines.append(f"  {name} = {axes} {PARAMETERS[name].unit}: {PARAMETERS[name].meaning}")
        lines.append(f"      {preset.sources[name]}")
    if preset.notes:
        lines += ["", *fill(preset.notes, 110, initial_indent="  ", subsequent_indent="  ").splitlines()]
    return lines


def _meaning(models: dict[str, NoiseModel], preset: Preset | None = None) -> list[str]:
    """What noise and other errors are in customary and in SI units; of axes that differ the largest."""
    rows = []
    for sensor, model in models.items():
        unit = _UNITS[sensor]
        for quantity, meaning, customary, factor in _SHOWN[sensor]:
            value = float(np.max(getattr(model, quantity)))
            if value:
                si = _SI[quantity].format(unit)
                # Both columns say the same: of flicker the floor, which is 0.664 B.
                shown = value * (ALLAN_FLOOR if quantity == "bias_instability" else 1.0)
                rows.append(
                    (f"  {sensor} {meaning}", f"{value * factor:.4g} {customary}", f"{shown:.4g} {si}")
                )
    rows += _meant(preset) if preset else []
    return ["", *plain(("which means, simulated", "", "in SI units"), rows)] if rows else []


def _meant(preset: Preset) -> list[tuple[str, str, str]]:
    """Rows of `_meaning` for what is no noise."""
    from kreisel.simulate.datasheet import PARAMETERS

    rows, triads = [], preset.triads()._asdict()
    for name, value in preset.values.items():
        sensor, p = name.split("_")[0], PARAMETERS[name]
        if p.settles in _ERRORS and np.any(value):
            k = int(np.argmax(np.abs(value)))
            stated, si = np.ravel(value)[k], np.broadcast_to(getattr(triads[sensor], p.settles), 3)[k]
            unit = _ERRORS[p.settles].format(_UNITS[sensor])
            rows.append(
                (
                    f"  {sensor} {p.meaning.split(', largest')[0]}",
                    f"{stated:.4g} {p.unit}",
                    f"{si:.4g} {unit}",
                )
            )
    return rows


def _noise_json(models: dict[str, NoiseModel]) -> dict[str, Any]:
    """SI units and microtesla, per axis."""
    return {
        sensor: {quantity: getattr(model, quantity).tolist() for quantity in _SI}
        for sensor, model in models.items()
    }


def _preset_json(preset: Preset) -> dict[str, Any]:
    return {
        "name": preset.name,
        "part": preset.part,
        "maker": preset.maker,
        "grade": preset.grade,
        "datasheet": preset.datasheet,
        "notes": preset.notes,
        "values": {
            name: {"value": value, "source": preset.sources[name]} for name, value in preset.values.items()
        },
        "noise": _noise_json(_models(preset)),
    }
