"""Turns tables with a header of names and units into any noun, and any noun into such a table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Mask, Reference
from kreisel.data.checks import Array, radians
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import INCREMENTS, at_ends
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import chosen_kind
from kreisel.files.columns import GROUPS, Column, bind
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.signs import Signs
from kreisel.files.stamps import seconds_text, to_nanoseconds
from kreisel.files.text import (
    Before,
    TextFile,
    checked_clock,
    checked_finite,
    checked_quaternions,
    first_rows,
    is_number,
    load,
    read_text,
    split_row,
    write_rows,
)
from kreisel.files.text_blocks import text_blocks
from kreisel.files.units import UNITS
from kreisel.maths.rotations import (
    matrix_from_euler,
    matrix_from_quat_wxyz,
    quat_wxyz_from_matrix,
    rotation_defect,
)

SUFFIX = ".csv"
HOLDS = (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
OPTIONS = frozenset({"columns", "rate_hz"})
KEEPS = "every bit of every number, epoch stamps to the nanosecond; attitude as a quaternion, to 1e-15"

_DIGITS = {"s": 9, "ms": 6, "us": 3, "ns": 0}
_MOTION = ("p", "v", "a", "omega", "alpha")
_MOTION_SIGMAS = ("theta_sigma", "a_sigma", "omega_sigma", "alpha_sigma")
_IMU_SIGMAS = ("gyro_sigma", "accel_sigma")
_FLAGS = ("rest", "disturbed", "held", "counts")
# What makes a kind, in the order of preference, and what lacks where half of one is there.
_NEEDED = {"poses": {"p"}, "imu": {"gyro", "accel"}, "increments": {"dtheta", "dv"}}
_PARTNERS = (("gyro", "accel"), ("accel", "gyro"), ("dtheta", "dv"), ("dv", "dtheta"))
_GROUPS_OF = {
    "imu": ("gyro", "accel", "mag", *_IMU_SIGMAS),
    "increments": INCREMENTS,
    "poses": ("p", "q", "phi", "v"),
    "motion": ("p", "q", "phi", "v", "a", "omega", "alpha", *_MOTION_SIGMAS),
    "attitude": ("q", "phi", "gyro_bias", "a", "sigma", "rest", "disturbed", "held"),
    "reference": ("q", "phi", "counts"),
}


def sniff(head: bytes) -> bool:
    """A header of names above rows that start with a number."""
    _, rows = first_rows(head)
    if not rows:
        return False
    delimiter = _delimiter(rows)
    header = _fields(rows[0], delimiter)
    return len(header) > 1 and not any(map(is_number, header))


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun whose columns the table has; `options.kind` decides where it has several."""
    file, table = _opened(read_text(path), options)
    return table.noun(file)[0]


def blocks(path: Path, options: ReadOptions) -> Iterator[Noun]:
    """The same, block by block."""
    table, end, rows = None, None, 0
    for file in text_blocks(path):
        if table is None:
            file, table = _opened(file, options)
            if table.kind == "increments":  # their stamps are one more than their rows
                yield read(path, options)
                return
        noun, end = table.noun(file, end, rows)
        rows += len(noun)
        yield noun


@dataclass(frozen=True, slots=True)
class _Table:
    """What the header of a table says of all its rows."""

    delimiter: str | None
    headers: list[str]
    found: dict[str, Column]
    kind: str
    groups: list[str]
    rate_hz: float | None

    def noun(self, file: TextFile, before: Before | None = None, rows: int = 0) -> tuple[Noun, Before | None]:
        """What the rows of `file` hold, and its end; it follows so many `rows`, the last of them `before`."""
        use = [self.found[name] for g in self.groups for name in GROUPS[g][0]]
        stamp = self.found.get("t")
        columns = [column.index for column in use]
        stamps, values = load(file, self.delimiter, self.headers, stamp.index if stamp else None, columns)
        end = before
        if stamps is None or stamp is None:
            t = _even_times(file.path, rows, len(values), self.rate_hz)
        else:
            digits = _digits(file, stamp, stamps[0] if before is None else before.stamp)
            t, end = checked_clock(file, stamps, digits, stamp.header, before)
        known = np.where(np.isnan(values) & _may_lack(self.kind, self.groups, values), 0.0, values)
        checked_finite(file, known, [column.header for column in use])
        named = _scaled(values, self.groups, self.found)
        return _noun(self.kind, file, t, 0 if end is None else end.t0_ns, named), end


def _opened(file: TextFile, options: ReadOptions) -> tuple[TextFile, _Table]:
    """(file without its header row, what the header says)."""
    delimiter = _delimiter(file.rows)
    file, headers = _headers(file, delimiter)
    found = bind(str(file.path), headers, options.columns)
    kind = _kind(file.path, found, headers, options.kind)
    groups = [g for g in _GROUPS_OF[kind] if GROUPS[g][0][0] in found]
    if "q" in groups and "phi" in groups:
        groups.remove("phi")
    return file, _Table(delimiter, headers, found, kind, groups, options.rate_hz)


def write(data: Noun, out: BinaryIO) -> None:
    """Columns with their unit in brackets; epoch stamps as integer nanoseconds, others in seconds."""
    write_blocks([data], out)


def write_blocks(blocks: Iterable[Noun], out: BinaryIO) -> None:
    """The same of what comes block by block; ValueError where one has other columns than the first."""
    signs, above = Signs(), ""
    for block in blocks:
        groups = _contents(block)
        if "q" in groups:
            groups["q"] = signs.continued(np.asarray(groups["q"], dtype=np.float64))
        stamps = to_nanoseconds(block.t, block.t0_ns).tolist() if block.t0_ns else None
        names = ["t [s]" if stamps is None else "t [ns]"]
        names += [_with_unit(name, GROUPS[g][2]) for g in groups for name in GROUPS[g][0]]
        header = ",".join(names)
        if above not in ("", header):
            raise ValueError(f"blocks must have the same columns; got {header} after {above}.")
        columns = [column for array in groups.values() for column in array.reshape(len(array), -1).T]
        times = seconds_text(block.t, 0) if stamps is None else list(map(str, stamps))
        write_rows(out, "" if above else header, [times, *map(_printable, columns)], ",")
        above = header


def _printable(column: Array | Mask) -> Array | list[str]:
    if column.dtype == np.bool_:
        return ["1" if flag else "0" for flag in column]
    return np.asarray(column, dtype=np.float64)


def _with_unit(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _contents(data: Noun) -> dict[str, Array | Mask]:
    """The groups of columns that `data` has, in the order they are written in."""
    found: dict[str, Array | Mask | None]
    if isinstance(data, ImuRecording):
        found = {"gyro": data.gyro, "accel": data.accel, "mag": data.mag_uT}
        found |= {group: getattr(data, group) for group in _IMU_SIGMAS}
    elif isinstance(data, ImuIncrements):
        known = {name: getattr(data, name) for name in INCREMENTS}
        found = {name: None if x is None else at_ends(name, x) for name, x in known.items()}
    elif isinstance(data, Reference):
        found = {"q": _quat_where_known(data), "counts": data.counts}
    elif isinstance(data, AttitudeHistory):
        found = {"q": data.quat_wxyz, "gyro_bias": data.gyro_bias, "a": data.a_N, "sigma": data.sigma}
        found |= {"rest": data.rest, "disturbed": data.disturbed, "held": data.held}
    else:
        quat = None if data.R_NB is None else quat_wxyz_from_matrix(data.R_NB)
        found = {"p": data.p_NB, "q": quat, "v": data.v_NB}
    if isinstance(data, Motion):
        found |= {"a": data.a_NB, "omega": data.omega_NB_B, "alpha": data.alpha_NB_B}
        found |= {group: getattr(data, group) for group in _MOTION_SIGMAS}
    return {group: array for group, array in found.items() if array is not None}


def _quat_where_known(data: Reference) -> Array:
    """Quaternions (n, 4), NaN where the rows that do not count hold no rotation."""
    quat = np.full((len(data), 4), np.nan)
    known = np.asarray(np.isfinite(data.R_NS).all(axis=(1, 2)))
    known[known] = rotation_defect(data.R_NS[known]) < 1e-6
    quat[known] = quat_wxyz_from_matrix(data.R_NS[known])
    return quat


def _delimiter(rows: list[str]) -> str | None:
    """The one of comma, semicolon and tab that header and first row share most of; None for spaces."""
    first, second = rows[0], rows[min(1, len(rows) - 1)]
    counts = {d: min(first.count(d), second.count(d)) for d in (";", "\t", ",")}
    best = max(counts, key=lambda d: counts[d])
    return best if counts[best] else next((d for d in (";", "\t", ",") if d in first), None)


def _fields(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return re.sub(r"\s+([\[(])", r"\1", line).split()
    return split_row(line, delimiter)


def _headers(file: TextFile, delimiter: str | None) -> tuple[TextFile, list[str]]:
    """(file without its header row, headers): the first row, the comment above it, or "#1", "#2" ..."""
    first = _fields(file.rows[0], delimiter)
    if not any(is_number(field) for field in first):
        if len(file.rows) == 1:
            raise ValueError(f"{file.path} has a header but no rows below it.")
        line = file.lines.index(file.rows[0])
        # A blank in its place keeps the line numbers of complaints right.
        lines = [*file.lines[:line], "", *file.lines[line + 1 :]]
        return replace(file, lines=lines, rows=file.rows[1:]), first
    above = _fields(file.comments[-1], delimiter) if file.comments else []
    if len(above) == len(first) and len(above) > 1:
        return file, above
    return file, [f"#{k}" for k in range(1, len(first) + 1)]


def _kind(path: Path, found: Mapping[str, Column], headers: list[str], asked: str | None) -> str:
    groups = {g for g, (names, _, _) in GROUPS.items() if names[0] in found}
    kinds = [kind for kind, needed in _NEEDED.items() if needed <= groups]
    turned = "q" in groups or "phi" in groups
    if turned and (asked in ("attitude", "reference") or not kinds):
        return "reference" if "counts" in groups and asked != "attitude" else "attitude"
    if kinds:
        try:
            kind = chosen_kind(kinds, asked)
        except ValueError as error:
            raise ValueError(f"{path} {error}") from None
        return "motion" if kind == "poses" and {*_MOTION} <= groups and turned else kind
    partner = next((f"{other}_x" for one, other in _PARTNERS if one in groups), None)
    lacking = partner or "gyro_x"
    raise ValueError(
        f"{path}: no column {partner or 'by a name that is needed'}. "
        "Needed are positions (p_x ...), attitude (q_w ...), an IMU "
        "(gyro_x ..., accel_x ...) or increments (dtheta_x ..., dv_x ...). "
        f"The file has: {', '.join(headers)}. Name foreign columns with --column {lacking}='HEADER [UNIT]'."
    )


def _even_times(path: Path, rows: int, n: int, rate_hz: float | None) -> Array:
    if rate_hz is None:
        raise ValueError(
            f"{path} has no time column. Name it with --column t='HEADER [UNIT]', or give rate_hz."
        )
    return np.arange(rows, rows + n) / rate_hz


def _digits(file: TextFile, column: Column, first: bytes) -> int:
    """Decimal exponent from the stamps' unit to nanoseconds; refuses seconds that cannot be."""
    unit = next(u for u in _DIGITS if column.scale == UNITS["time"][u])
    # 1e11 s is the year 5138: such numbers are finer units without their name.
    if column.unit is None and abs(float(first)) > 1e11:
        likely = "ms" if abs(float(first)) < 1e14 else "us" if abs(float(first)) < 1e17 else "ns"
        raise file.error(
            0,
            f"{first.decode()} cannot be seconds, it looks like {likely}. "
            f"Say so: --column t='{column.header} [{likely}]'.",
            column.header,
        )
    return _DIGITS[unit]


def _may_lack(kind: str, groups: list[str], values: Array) -> Mask:
    """Where (n, m) NaN has a meaning: no sample, a bias not known, a reference that lost sight."""
    owners = np.array([group for group in groups for _ in GROUPS[group][0]])
    if kind in ("poses", "motion"):
        return np.broadcast_to(np.isin(owners, _MOTION_SIGMAS), values.shape)
    if kind == "reference":
        return (values[:, owners == "counts"] == 0.0) & np.isin(owners, ("q", "phi"))
    return np.broadcast_to(~np.isin(owners, ("q", "phi", *_FLAGS)), values.shape)


def _scaled(values: Array, groups: list[str], found: Mapping[str, Column]) -> dict[str, Array]:
    columns, at = {}, 0
    for group in groups:
        names = GROUPS[group][0]
        columns[group] = np.column_stack(
            [found[name].scale(values[:, at + k]) for k, name in enumerate(names)]
        )
        at += len(names)
    return columns


def _noun(kind: str, file: TextFile, t: Array, t0_ns: int, columns: dict[str, Array]) -> Noun:
    name = file.path.stem
    if kind == "imu":
        sigmas = {group: columns.get(group) for group in _IMU_SIGMAS}
        return ImuRecording(t, columns["gyro"], columns["accel"], columns.get("mag"), t0_ns, name, **sigmas)
    if kind == "increments":
        return _increments(file, t, t0_ns, columns)
    R = _attitude(file, columns)
    if R is None or kind == "poses":
        return Poses(t, columns["p"], R, columns.get("v"), t0_ns, name)
    if kind == "motion":
        p, v, a, omega, alpha = (columns[group] for group in _MOTION)
        known = [columns.get(group) for group in _MOTION_SIGMAS]
        return Motion(t, p, v, a, R, omega, alpha, t0_ns, name, (), *known)
    flags = {group: _flags(file, columns[group], group) for group in _FLAGS if group in columns}
    if kind == "reference":
        return Reference(t, R, flags["counts"], t0_ns, name)
    bias, a_N, sigma = (columns.get(group) for group in ("gyro_bias", "a", "sigma"))
    rest, disturbed, held = (flags.get(group) for group in ("rest", "disturbed", "held"))
    return AttitudeHistory(t, R, bias, a_N, sigma, rest, disturbed, held, t0_ns, name)


def _increments(file: TextFile, t: Array, t0_ns: int, columns: Mapping[str, Array]) -> ImuIncrements:
    """Every row holds what was gained since the row before; the first has only its stamp."""
    if any(np.isfinite(rows[0]).any() for rows in columns.values()):
        raise file.error(
            0,
            "the first row is where the first interval begins, and has no increments yet: put a row with that stamp "
            "and empty fields before yours.",
            "dtheta_x",
        )
    rows = {name: values[1:] for name, values in columns.items()}
    return ImuIncrements(t, rows["dtheta"], rows["dv"], rows.get("dp"), t0_ns, file.path.stem)


def _attitude(file: TextFile, columns: Mapping[str, Array]) -> Array | None:
    if "q" in columns:
        return matrix_from_quat_wxyz(checked_quaternions(file, columns["q"], "q_w ... q_z"))
    if "phi" not in columns:
        return None
    return matrix_from_euler(radians(f"{file.path}, columns phi_x ... phi_z", columns["phi"]))


def _flags(file: TextFile, values: Array, column: str) -> Mask:
    flags = values.ravel()
    odd = np.flatnonzero(~np.isin(flags, (0.0, 1.0)))
    if odd.size:
        raise file.error(int(odd[0]), f"{flags[odd[0]]:g} is neither 0 nor 1.", column)
    return flags == 1.0
