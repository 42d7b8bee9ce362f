"""Turns a table with a header of names and units into rows of values by name; empty cells are left out."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from kreisel.files.columns import split_unit
from kreisel.files.text import TextFile, is_number, read_text, split_row
from kreisel.files.units import Scale, scale

Row = dict[str, float | str]


class Known(NamedTuple):
    """A column that a table may have."""

    quantity: str  # of kreisel.files.units; "" for a word
    unit: str = ""  # in which its values are delivered
    others: tuple[str, ...] = ()  # names that others give it
    unit_needed: bool = False  # where a wrong guess would pass unseen


def named_rows(path: Path, known: Mapping[str, Known]) -> tuple[TextFile, list[Row]]:
    """The rows of a table whose header names columns of `known`; the file, for complaints about its rows.

    Raises ValueError with file, line and column for anything else in it, OSError where there is no file.
    """
    file = _text(path)
    delimiter = _delimiter(file.rows[0])
    columns = [_column(path, header, known) for header in split_row(file.rows[0], delimiter)]
    names = [name for name, _ in columns]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"{path} has two columns for {twice}.")
    line = file.lines.index(file.rows[0])
    below = TextFile(path, [*file.lines[:line], "", *file.lines[line + 1 :]], file.rows[1:], file.comments)
    if not below.rows:
        raise ValueError(f"{path} has a header but no rows below it.")
    return below, [_row(below, k, split_row(row, delimiter), columns) for k, row in enumerate(below.rows)]


def header_of(path: Path) -> list[str]:
    """The bare names in the first row of a table, in lower case."""
    file = _text(path)
    return [split_unit(field)[0].lower() for field in split_row(file.rows[0], _delimiter(file.rows[0]))]


def _text(path: Path) -> TextFile:
    try:
        return read_text(path)
    except OSError as error:
        raise type(error)(f"cannot read {path}: {error.strerror}.") from None


def _delimiter(header: str) -> str:
    return max((",", ";", "\t"), key=header.count)


def _column(path: Path, header: str, known: Mapping[str, Known]) -> tuple[str, Scale | None]:
    """Name and scale of a column; None for words."""
    bare, unit = split_unit(header)
    lowered = bare.lower().replace(" ", "_")
    name = next((n for n, k in known.items() if lowered == n or lowered in k.others), None)
    if name is None:
        near = difflib.get_close_matches(
            lowered, [*known, *(o for k in known.values() for o in k.others)], n=1
        )
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ValueError(f"{path}: no use for a column {bare!r}.{hint} Known are {', '.join(known)}.")
    kind = known[name]
    if not kind.quantity:
        return name, None
    if unit is None and kind.unit_needed:
        raise ValueError(f"{path}: column {bare!r} has no unit. Write it as {bare} [{kind.unit}], say.")
    try:
        ours = scale(kind.unit, kind.quantity)
        given = ours if unit is None else scale(unit, kind.quantity)
    except ValueError as error:
        raise ValueError(f"{path}: column {bare!r}: {error}") from None
    return name, Scale() if given == ours else Scale(given.times * ours.over, given.over * ours.times)


def _row(file: TextFile, k: int, fields: Sequence[str], columns: Sequence[tuple[str, Scale | None]]) -> Row:
    if len(fields) > len(columns) and not any(fields[len(columns) :]):
        fields = fields[: len(columns)]
    if len(fields) > len(columns):
        raise file.error(
            k, f"{len(fields)} fields where {len(columns)} are expected. Repair or remove that line."
        )
    out: Row = {}
    for (name, factor), field in zip(columns, fields, strict=False):
        if not field:
            continue
        if factor is None:
            out[name] = field
        elif is_number(field):
            out[name] = float(field) * factor.times / factor.over
        else:
            raise file.error(k, f"{field!r} is not a number. Repair it, or leave the cell empty.", name)
    return out
