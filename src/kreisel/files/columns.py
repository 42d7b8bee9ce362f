"""Turns the headers of a foreign table into our column names, with the unit each one is in."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kreisel.files.units import Scale, scale

GROUPS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "t": (("t",), "time", "s"),
    "p": (("p_x", "p_y", "p_z"), "length", "m"),
    "q": (("q_w", "q_x", "q_y", "q_z"), "number", ""),
    "phi": (("phi_x", "phi_y", "phi_z"), "angle", "rad"),
    "v": (("v_x", "v_y", "v_z"), "speed", "m/s"),
    "a": (("a_x", "a_y", "a_z"), "acceleration", "m/s^2"),
    "omega": (("omega_x", "omega_y", "omega_z"), "rate", "rad/s"),
    "alpha": (("alpha_x", "alpha_y", "alpha_z"), "angular acceleration", "rad/s^2"),
    "gyro": (("gyro_x", "gyro_y", "gyro_z"), "rate", "rad/s"),
    "accel": (("accel_x", "accel_y", "accel_z"), "acceleration", "m/s^2"),
    "dtheta": (("dtheta_x", "dtheta_y", "dtheta_z"), "angle", "rad"),
    "dv": (("dv_x", "dv_y", "dv_z"), "speed", "m/s"),
    "dp": (("dp_x", "dp_y", "dp_z"), "length", "m"),
    "mag": (("mag_x", "mag_y", "mag_z"), "field", "uT"),
    "gyro_bias": (("gyro_bias_x", "gyro_bias_y", "gyro_bias_z"), "rate", "rad/s"),
    # Not plain sigma_x: elsewhere that is the uncertainty of a position.
    "sigma": (("sigma_dtheta_x", "sigma_dtheta_y", "sigma_dtheta_z"), "angle", "rad"),
    "gyro_sigma": (("gyro_sigma_x", "gyro_sigma_y", "gyro_sigma_z"), "rate", "rad/s"),
    "accel_sigma": (("accel_sigma_x", "accel_sigma_y", "accel_sigma_z"), "acceleration", "m/s^2"),
    "theta_sigma": (("theta_sigma_x", "theta_sigma_y", "theta_sigma_z"), "angle", "rad"),
    "a_sigma": (("a_sigma_x", "a_sigma_y", "a_sigma_z"), "acceleration", "m/s^2"),
    "omega_sigma": (("omega_sigma_x", "omega_sigma_y", "omega_sigma_z"), "rate", "rad/s"),
    "alpha_sigma": (("alpha_sigma_x", "alpha_sigma_y", "alpha_sigma_z"), "angular acceleration", "rad/s^2"),
    "rest": (("rest",), "number", ""),
    "disturbed": (("disturbed",), "number", ""),
    "held": (("held",), "number", ""),
    "counts": (("counts",), "number", ""),
}
"""Group -> its columns, what they measure, and the unit they have where none is given."""

GROUP_OF = {column: group for group, (columns, _, _) in GROUPS.items() for column in columns}
KNOWN = tuple(GROUP_OF)

# Stems others write for ours; the axis follows with or without an underscore.
_STEMS = {
    "p": ("", "p", "pos", "position", "t", "p_rs_r"),
    "q": ("q", "quat", "quaternion", "q_rs"),
    "v": ("v", "vel", "velocity", "v_rs_r"),
    "gyro": ("g", "w", "gyr", "gyro", "gyroscope", "angular_velocity", "w_rs_s"),
    "accel": ("acc", "accel", "accelerometer", "a_rs_s"),
    "mag": ("m", "mag", "magnetometer"),
    "dtheta": ("delta_theta", "delta_angle"),
    "dv": ("delta_v", "delta_velocity"),
}


def _foreign_names() -> dict[str, str]:
    names = dict.fromkeys(("time", "timestamp", "stamp"), "t")
    names |= {"roll": "phi_x", "pitch": "phi_y", "yaw": "phi_z"}
    for group, stems in _STEMS.items():
        for column in GROUPS[group][0]:
            axis = column[-1]
            names |= {stem + joint + axis: column for stem in stems for joint in ("_", "")}
    # A bare "ax" is what accelerometers are logged as; "a_x" is ours for the acceleration of the body.
    names |= {f"a{axis}": f"accel_{axis}" for axis in "xyz"}
    return {name: column for name, column in names.items() if name not in KNOWN}


FOREIGN = _foreign_names()

# Degrees and radians are both common for these, and a wrong guess would pass unseen.
_UNIT_REQUIRED = ("roll", "pitch", "yaw")


@dataclass(frozen=True, slots=True)
class Column:
    """One of our columns, found in a table."""

    name: str  # ours
    index: int  # in the table
    header: str  # theirs, without unit
    unit: str | None  # as written, None where none is
    scale: Scale


def split_unit(header: str) -> tuple[str, str | None]:
    """("gyro_x", "rad/s") from "gyro_x [rad/s]" or "gyro_x (rad/s)"; the unit is None where there is none."""
    match = re.fullmatch(r"\s*(.*?)\s*[\[(]([^\[\]()]*)[\])]\s*", header)
    return (match[1], match[2].strip()) if match and match[1] else (header.strip(), None)


def bind(where: str, headers: Sequence[str], mapping: Mapping[str, str] | None) -> dict[str, Column]:
    """Our column name -> where it is in the table. What `mapping` names comes first, known names follow.

    where : the file, for complaints.
    Raises ValueError for names that are not ours or not theirs, incomplete triples and unknown units.
    """
    found: dict[str, Column] = {}
    for asked, wanted in (mapping or {}).items():
        found[asked] = _mapped(where, headers, asked, wanted)
    taken = {column.index for column in found.values()}
    for index, header in enumerate(headers):
        bare, unit = split_unit(header)
        name = _ours(bare)
        if name is None or index in taken or name in (mapping or {}):
            continue
        if name not in found or bare.lower() == name:
            found[name] = _column(where, name, index, bare, unit)
        elif found[name].header.lower() != name:
            raise ValueError(
                f"{where}: both {found[name].header!r} and {bare!r} could be {name}. "
                f"Say which: {name}={bare!r} (--column {name}={bare})."
            )
    _check_groups(where, headers, found)
    return found


def _ours(bare: str) -> str | None:
    lowered = bare.lower().lstrip("#").strip().replace(" ", "_").replace(".", "_")
    return lowered if lowered in KNOWN else FOREIGN.get(lowered)


def _column(where: str, name: str, index: int, bare: str, unit: str | None) -> Column:
    _, quantity, ours = GROUPS[GROUP_OF[name]]
    if unit is None and bare.lower() in _UNIT_REQUIRED:
        raise ValueError(
            f"{where}: column {bare!r} has no unit. Say which: "
            f"--column {name}='{bare} [deg]' or '{bare} [rad]'."
        )
    try:
        return Column(name, index, bare, unit, scale(ours if unit is None else unit, quantity))
    except ValueError as error:
        raise ValueError(f"{where}: column {bare!r}: {error}") from None


def _mapped(where: str, headers: Sequence[str], name: str, wanted: str) -> Column:
    """The column a user named, as the whole header, the header without its unit, or "#3", the third."""
    if name not in KNOWN:
        near = difflib.get_close_matches(name, KNOWN, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ValueError(f"{name!r} is not one of our columns.{hint} There are: {', '.join(KNOWN)}.")
    bares = [split_unit(header)[0] for header in headers]
    asked, unit = split_unit(wanted)
    for names, key in ((headers, wanted.strip()), (bares, wanted.strip()), (bares, asked)):
        matches = [i for i, candidate in enumerate(names) if candidate.strip() == key]
        if matches:
            given = split_unit(headers[matches[0]])[1] if unit is None else unit
            return _column(where, name, matches[0], bares[matches[0]], given)
    number = re.fullmatch(r"#(\d+)", asked)
    if number and 1 <= int(number[1]) <= len(headers):
        return _column(where, name, int(number[1]) - 1, asked, unit)
    raise ValueError(f"{where}: no column {asked!r} for {name}.{_nearest(asked, bares)}")


def _nearest(asked: str, bares: Sequence[str]) -> str:
    near = difflib.get_close_matches(asked, bares, n=2, cutoff=0.5)
    hint = f" Did you mean {' or '.join(map(repr, near))}?" if near else ""
    return f"{hint} The file has: {', '.join(bares)}."


def _check_groups(where: str, headers: Sequence[str], found: Mapping[str, Column]) -> None:
    bares = [split_unit(header)[0] for header in headers]
    for columns, _, _ in GROUPS.values():
        missing = [column for column in columns if column not in found]
        if missing and len(missing) < len(columns):
            raise ValueError(
                f"{where}: has {', '.join(c for c in columns if c in found)} but no column {missing[0]}."
                f"{_nearest(missing[0], bares)} Name it with --column {missing[0]}=HEADER."
            )
