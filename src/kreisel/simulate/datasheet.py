"""Turns the numbers of a datasheet, in the units datasheets use, into the errors of a simulated sensor in SI units.

docs/datasheets.md explains each conversion.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from kreisel.data.checks import LARGEST, Array, choice, per_axis
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.noise import ALLAN_FLOOR, NoiseModel
from kreisel.data.temperature import HOTTEST_DEGC, ZERO_KELVIN_DEGC
from kreisel.simulate.effects.misalignment import LARGEST_ANGLE
from kreisel.simulate.triad import Triad

_DEG = float(np.pi / 180.0)
_G = STANDARD_GRAVITY
_H = 3600.0
_ONE_SIDED = float(1.0 / np.sqrt(2.0))
_UT = 100.0
"""Microtesla in a gauss."""
_FLATTEST = 1.0 / 12.0
"""Largest non-linearity: with it a cubic characteristic no longer rises at one end of its range."""
_PEAK_TO_PEAK = 6.6
"""Peak to peak over RMS of Gaussian noise: 99.9 % of the time it stays inside."""

SENSORS = ("gyro", "accel", "mag")


class Parameter(NamedTuple):
    """One number of a datasheet."""

    settles: str  # the quantity of a triad that it gives
    factor: float  # SI unit over datasheet unit
    unit: str
    meaning: str
    # times; per: factor over value; band: needs a noise bandwidth; bits and bend: need a range
    form: str = "times"


def _noise(unit: float, name: str, shown: str) -> dict[str, Parameter]:
    """Noise of a reading in `unit`, called `name` in parameters, over a band."""
    rms = "RMS noise in the band noise_bandwidth_hz"
    return {
        f"noise_rms_{name}": Parameter("white_noise", unit, shown, rms, "band"),
        f"noise_peak_to_peak_{name}": Parameter(
            "white_noise", unit / _PEAK_TO_PEAK, shown, rms.replace("RMS", "peak-to-peak"), "band"
        ),
        "noise_bandwidth_hz": Parameter("noise_bandwidth", 1.0, "Hz", "equivalent noise bandwidth"),
    }


def _or_fixed(*table: tuple[str, Parameter]) -> dict[str, Parameter]:
    """Tolerances, of which every run draws a sensor; and the same by a name with fixed_ as values of one sensor."""
    fixed = {
        f"fixed_{name}".replace("turn_on_", ""): parameter._replace(
            settles=f"fixed_{parameter.settles}".replace("turn_on_", ""),
            meaning=parameter.meaning.replace("one sigma", "the same in every run"),
        )
        for name, parameter in table
    }
    return {**dict(table), **fixed}


_THERMAL_SCALE = "temperature coefficient of the sensitivity, one sigma"
_THERMAL_BIAS = "temperature coefficient of the offset, one sigma"
_CURVED = "non-linearity, largest distance from the best straight line"

_BOTH = {
    **_or_fixed(
        ("scale_error_percent", Parameter("scale", 1e-2, "%", "sensitivity tolerance, one sigma")),
        ("scale_error_ppm", Parameter("scale", 1e-6, "ppm", "scale factor error, one sigma")),
        ("temperature_scale_percent_per_K", Parameter("temperature_scale", 1e-2, "%/K", _THERMAL_SCALE)),
        ("temperature_scale_ppm_per_K", Parameter("temperature_scale", 1e-6, "ppm/K", _THERMAL_SCALE)),
    ),
    "reference_degC": Parameter(
        "reference_degC", 1.0, "deg C", "temperature without error of offset or scale"
    ),
    "nonlinearity_percent": Parameter("cubic", 1e-2, "% of full scale", _CURVED, "bend"),
    "nonlinearity_ppm": Parameter("cubic", 1e-6, "ppm of full scale", _CURVED, "bend"),
    "misalignment_percent": Parameter("misalignment", 1e-2, "%", "cross-axis sensitivity, one sigma"),
    "misalignment_deg": Parameter("misalignment", _DEG, "deg", "axis misalignment, one sigma"),
    "bandwidth_hz": Parameter("bandwidth", 1.0, "Hz", "-3 dB bandwidth"),
    "bits": Parameter("step", 2.0, "bit", "word length over the whole range, both signs", "bits"),
}
_FEELS = "linear acceleration effect on bias, one sigma"
_GYRO = {
    "noise_deg_per_s_rthz": Parameter(
        "white_noise", _DEG * _ONE_SIDED, "deg/s/sqrt(Hz)", "noise density, one-sided"
    ),
    "arw_deg_per_rth": Parameter("white_noise", _DEG / np.sqrt(_H), "deg/sqrt(h)", "angle random walk"),
    **_noise(_DEG, "deg_per_s", "deg/s"),
    "bias_instability_deg_per_h": Parameter(
        "bias_instability",
        _DEG / _H / ALLAN_FLOOR,
        "deg/h",
        "in-run bias stability, floor of the Allan deviation",
    ),
    "bias_random_walk_deg_per_s_rts": Parameter(
        "bias_random_walk", _DEG, "deg/s/sqrt(s)", "random walk of the bias"
    ),
    "rrw_deg_per_h_rth": Parameter("bias_random_walk", _DEG / _H**1.5, "deg/h/sqrt(h)", "rate random walk"),
    **_or_fixed(
        ("turn_on_bias_deg_per_s", Parameter("turn_on_bias", _DEG, "deg/s", "zero-rate offset, one sigma")),
        (
            "turn_on_bias_deg_per_h",
            Parameter("turn_on_bias", _DEG / _H, "deg/h", "bias repeatability, one sigma"),
        ),
        ("temperature_bias_deg_per_s_per_K", Parameter("temperature_bias", _DEG, "deg/s/K", _THERMAL_BIAS)),
        (
            "temperature_bias_deg_per_h_per_K",
            Parameter("temperature_bias", _DEG / _H, "deg/h/K", _THERMAL_BIAS),
        ),
        ("g_sensitivity_deg_per_s_per_g", Parameter("g_sensitivity", _DEG / _G, "deg/s/g", _FEELS)),
        ("g_sensitivity_deg_per_h_per_g", Parameter("g_sensitivity", _DEG / _H / _G, "deg/h/g", _FEELS)),
    ),
    "range_deg_per_s": Parameter("limit", _DEG, "deg/s", "end of the range"),
    "resolution_deg_per_s": Parameter("step", _DEG, "deg/s", "least significant bit"),
    "lsb_per_deg_per_s": Parameter("step", _DEG, "LSB/(deg/s)", "sensitivity", "per"),
    **_BOTH,
}
_ACCEL = {
    "noise_ug_rthz": Parameter(
        "white_noise", 1e-6 * _G * _ONE_SIDED, "ug/sqrt(Hz)", "noise density, one-sided"
    ),
    "vrw_m_per_s_rth": Parameter("white_noise", 1.0 / np.sqrt(_H), "m/s/sqrt(h)", "velocity random walk"),
    **_noise(1e-3 * _G, "mg", "mg"),
    "bias_instability_ug": Parameter(
        "bias_instability",
        1e-6 * _G / ALLAN_FLOOR,
        "ug",
        "in-run bias stability, floor of the Allan deviation",
    ),
    "bias_random_walk_ug_rts": Parameter(
        "bias_random_walk", 1e-6 * _G, "ug/sqrt(s)", "random walk of the bias"
    ),
    **_or_fixed(
        ("turn_on_bias_mg", Parameter("turn_on_bias", 1e-3 * _G, "mg", "zero-g offset, one sigma")),
        ("temperature_bias_mg_per_K", Parameter("temperature_bias", 1e-3 * _G, "mg/K", _THERMAL_BIAS)),
        ("temperature_bias_ug_per_K", Parameter("temperature_bias", 1e-6 * _G, "ug/K", _THERMAL_BIAS)),
    ),
    "range_g": Parameter("limit", _G, "g", "end of the range"),
    "resolution_mg": Parameter("step", 1e-3 * _G, "mg", "least significant bit"),
    "lsb_per_g": Parameter("step", _G, "LSB/g", "sensitivity", "per"),
    **_BOTH,
}

_MAG = {
    "noise_uT_rthz": Parameter("white_noise", _ONE_SIDED, "uT/sqrt(Hz)", "noise density, one-sided"),
    "noise_ugauss_rthz": Parameter(
        "white_noise", 1e-6 * _UT * _ONE_SIDED, "ugauss/sqrt(Hz)", "noise density, one-sided"
    ),
    **_noise(1.0, "uT", "uT"),
    **_noise(1e-3 * _UT, "mgauss", "mgauss"),
    **_or_fixed(
        ("turn_on_bias_uT", Parameter("turn_on_bias", 1.0, "uT", "zero-field offset, one sigma")),
        (
            "turn_on_bias_mgauss",
            Parameter("turn_on_bias", 1e-3 * _UT, "mgauss", "zero-field offset, one sigma"),
        ),
        ("temperature_bias_uT_per_K", Parameter("temperature_bias", 1.0, "uT/K", _THERMAL_BIAS)),
        (
            "temperature_bias_mgauss_per_K",
            Parameter("temperature_bias", 1e-3 * _UT, "mgauss/K", _THERMAL_BIAS),
        ),
    ),
    "range_uT": Parameter("limit", 1.0, "uT", "end of the range"),
    "range_gauss": Parameter("limit", _UT, "gauss", "end of the range"),
    "resolution_uT": Parameter("step", 1.0, "uT", "least significant bit"),
    "resolution_mgauss": Parameter("step", 1e-3 * _UT, "mgauss", "least significant bit"),
    **_BOTH,
}

PARAMETERS = {
    f"{sensor}_{name}": parameter
    for sensor, table in (("gyro", _GYRO), ("accel", _ACCEL), ("mag", _MAG))
    for name, parameter in table.items()
}
"""Every number of a datasheet that can be given, by the name that wears its unit."""

# As datasheets write what PARAMETERS spell out.
_SHORT = (
    (r"(?<![a-z])dps(?![a-z])", "deg_per_s"),
    (r"(?<![a-z])dph(?![a-z])", "deg_per_h"),
    (r"per_degC", "per_K"),
)

_RANGES = {"gyro": "deg_per_s", "accel": "g", "mag": "uT"}
_OF_NOISE = ("white_noise", "bias_instability", "bias_random_walk", "turn_on_bias")


class Triads(NamedTuple):
    """The sensors of one part, in SI units; the magnetometer in microtesla."""

    gyro: Triad
    accel: Triad
    mag: Triad


def spelled_out(name: str) -> str:
    """The name in PARAMETERS of "gyro_temperature_bias_dps_per_degC" and the like; any other name as it is."""
    for short, full in _SHORT:
        name = re.sub(short, full, name)
    return name


def triads(values: Mapping[str, Any]) -> Triads:
    """The sensors of a part from datasheet numbers by name, each one number or one per axis.

    dps, dph and per_degC in a name are deg_per_s, deg_per_h and per_K.
    Raises ValueError for a name that is not in PARAMETERS, for two that say the same, for a number that needs
    another one, and for values that cannot be.
    """
    _check_names(values)
    return Triads(*(_triad(sensor, values) for sensor in SENSORS))


def completed(base: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """`base`, the numbers of a datasheet, with `values` beside them or, where both say the same, in their place.

    Raises ValueError for a name that is not in PARAMETERS.
    """
    _check_names(values)
    settled = {_settled(name): _parameter(name) for name in values}
    kept = {name: value for name, value in base.items() if _settled(name) not in settled}
    for sensor in SENSORS:
        noise = settled.get((sensor, "white_noise"))
        if noise is not None and noise.form != "band":
            kept.pop(f"{sensor}_noise_bandwidth_hz", None)
    return {**kept, **values}


def _check_names(values: Mapping[str, Any]) -> None:
    for name in values:
        choice("a datasheet parameter", spelled_out(name), tuple(PARAMETERS))


def _settled(name: str) -> tuple[str, str]:
    """Sensor and quantity that a parameter gives."""
    return name.split("_")[0], _parameter(name).settles


def _triad(sensor: str, values: Mapping[str, Any]) -> Triad:
    given = _by_quantity({name: values[name] for name in values if name.startswith(f"{sensor}_")})
    settled: dict[str, Any] = {}
    # In this order: bits and bends need the range, noise in a band the band.
    for quantity in sorted(given, key=lambda q: q not in ("limit", "noise_bandwidth")):
        settled[quantity] = _in_si(given[quantity], values[given[quantity]], settled)
    band = settled.pop("noise_bandwidth", None)
    if band is not None and _parameter(given.get("white_noise", "gyro_arw_deg_per_rth")).form != "band":
        raise ValueError(f"{sensor}_noise_bandwidth_hz belongs to RMS or peak-to-peak noise; none was given.")
    for quantity in {"bandwidth", "reference_degC"} & settled.keys():
        settled[quantity] = _same_on_all(given[quantity], settled[quantity])
    noise = {quantity: settled.pop(quantity) for quantity in _OF_NOISE if quantity in settled}
    return Triad(NoiseModel(**noise), **settled)


def _parameter(name: str) -> Parameter:
    return PARAMETERS[spelled_out(name)]


def _by_quantity(values: Mapping[str, Any]) -> dict[str, str]:
    """Quantity -> the name of the parameter that gives it; ValueError where two do."""
    given: dict[str, str] = {}
    for name in values:
        quantity = _parameter(name).settles
        if quantity in given:
            raise ValueError(f"{given[quantity]} and {name} say the same; give one of them.")
        given[quantity] = name
    return given


def _in_si(name: str, value: Any, settled: Mapping[str, Array]) -> Array:
    parameter = _parameter(name)
    sensor = name.split("_")[0]
    x = per_axis(name, value, parameter.unit, *_bounds(parameter))
    if parameter.form in ("bits", "bend") and "limit" not in settled:
        raise ValueError(f"{name} needs the range, {sensor}_range_{_RANGES[sensor]}.")
    if parameter.form == "band" and "noise_bandwidth" not in settled:
        raise ValueError(f"{name} needs the band it was measured in, {sensor}_noise_bandwidth_hz.")
    if parameter.form == "per":
        return parameter.factor / x
    if parameter.form == "bits":
        return parameter.factor * settled["limit"] / 2.0**x
    if parameter.form == "bend":
        # Of c x^3 the best straight line up to L, 3/4 c L^2 x, leaves c L^3 / 4 at most (Chebyshev's T3).
        return 4.0 * parameter.factor * x / settled["limit"] ** 2
    if parameter.form == "band":
        return parameter.factor * x / np.sqrt(2.0 * settled["noise_bandwidth"])
    return parameter.factor * x


def _bounds(parameter: Parameter) -> tuple[float, float]:
    """What a value may be: noise and errors of zero are perfect sensors, ranges and scales of zero are none."""
    if parameter.form == "bits":
        return 1.0, 64.0
    if parameter.form == "bend":
        return -_FLATTEST / parameter.factor, _FLATTEST / parameter.factor
    if parameter.settles == "misalignment":
        return 0.0, LARGEST_ANGLE / parameter.factor
    if parameter.settles == "reference_degC":
        return ZERO_KELVIN_DEGC, HOTTEST_DEGC
    if parameter.settles.startswith("fixed_"):
        # A sensor whose scale is 100 % short reads nothing at all.
        return -0.999 / parameter.factor if parameter.settles == "fixed_scale" else -LARGEST, LARGEST
    of_size = parameter.form == "per" or parameter.settles in ("limit", "noise_bandwidth", "bandwidth")
    return (1e-9 if of_size else 0.0), LARGEST


def _same_on_all(name: str, value: Array) -> float:
    if np.ptp(value):
        unit = _parameter(name).unit
        raise ValueError(f"{name} must be one number, {unit}, for all axes; got {value}.")
    return float(value[0])
