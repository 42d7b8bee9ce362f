"""Turns a noun into the small HTML table that a notebook shows for it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import Any, NamedTuple

import numpy as np

_LONGEST = 96
"""Characters of a value in a table; what is longer is told in brief."""

# Of no colour of its own but for the grey of what is said beside the numbers: it has to suit dark notebooks too.
_TABLE = "border-collapse:collapse;font-variant-numeric:tabular-nums"
_CELL = "text-align:left;padding:2px 12px 2px 0"
_ASIDE = "opacity:0.65"


class Card(NamedTuple):
    """What a notebook shows of a noun."""

    title: str
    header: Sequence[str]
    rows: Iterable[Sequence[str]]
    asides: Sequence[str] = ()  # sentences below the table

    def html(self) -> str:
        """A heading and a table, without scripts, styles of others, or anything to load."""
        head = "".join(f'<th style="{_CELL};{_ASIDE}">{escape(name)}</th>' for name in self.header)
        rows = "".join(f"<tr>{_cells(row)}</tr>" for row in self.rows)
        asides = "".join(f'<div style="{_ASIDE}">{escape(text)}</div>' for text in self.asides)
        return (
            f"<div><strong>{escape(self.title)}</strong>"
            f'<table style="{_TABLE}"><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{asides}</div>'
        )


class Shown:
    """A frozen dataclass that a notebook shows as a table: its fields, unless it knows better."""

    __slots__ = ()

    def card(self) -> Card:
        """Heading, rows and asides of the table."""
        return Card(type(self).__name__, ("", "value"), field_rows(self))

    def _repr_html_(self) -> str:
        return self.card().html()


def field_rows(noun: Any) -> Iterator[tuple[str, str]]:
    """Name and value of every field that holds something and is shown; the parts of a list one below the other."""
    for field in dataclasses.fields(noun):
        value = getattr(noun, field.name)
        parts = value if isinstance(value, tuple) and _has_nouns(value) else (value,)
        if not field.repr or value is None or (isinstance(value, tuple | str) and not value):
            continue
        yield from ((field.name if k == 0 else "", brief(part)) for k, part in enumerate(parts))


def brief(value: Any) -> str:
    """`value` in one line: long arrays by shape and span, other nouns by what in them is not as usual."""
    text = _told(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} ..."


def _told(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, tuple | list):
        return f"[{', '.join(_told(item) for item in value)}]"
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {_told(item)}" for name, item in value.items())
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        set_fields = (f.name for f in dataclasses.fields(value) if f.repr and not _as_usual(value, f))
        held = ", ".join(f"{name} = {_told(getattr(value, name))}" for name in set_fields)
        return f"{type(value).__name__}({held})"
    return str(value)


def _as_usual(noun: Any, field: dataclasses.Field[Any]) -> bool:
    """Whether a field has its default; arrays that hold nothing but zeros count, too."""
    value = getattr(noun, field.name)
    if isinstance(value, np.ndarray):
        return not value.any()
    if isinstance(field.default_factory, type(dataclasses.MISSING)):
        return bool(value is field.default or value == field.default)
    return isinstance(value, tuple | Mapping) and not value


def _has_nouns(values: tuple[Any, ...]) -> bool:
    return any(dataclasses.is_dataclass(value) for value in values)


def span(array: Any) -> str:
    """The least and the largest number in `array`; how often it holds, for yes and no."""
    if array.dtype == np.bool_:
        return f"{100.0 * array.mean():.3g} %" if array.size else "-"
    finite = array[np.isfinite(array)]
    if not finite.size:
        return "-"
    missing = "" if finite.size == array.size else f", {array.size - finite.size} NaN"
    return f"{finite.min():.4g} to {finite.max():.4g}{missing}"


def course(noun: Any, stamps: Any) -> str:
    """Heading of a noun with `stamps` (n,) s: what it is, its name, how long and how fast it was sampled."""
    name = f" {noun.name!r}" if getattr(noun, "name", "") else ""
    heading = f"{type(noun).__name__}{name}: {len(stamps)} samples"
    if len(stamps) < 2:
        return heading
    rate = 1.0 / float(np.median(np.diff(stamps)))
    return f"{heading}, {float(stamps[-1] - stamps[0]):.6g} s at {rate:.4g} Hz"


def _array(array: Any) -> str:
    if array.size > 9:
        shape = " x ".join(str(length) for length in array.shape)
        return f"{shape}, {span(array)}"
    # Not NumPy's own text, whose form depends on the reader's print options.
    rows = ("  ".join(f"{x:.6g}" for x in row) for row in np.atleast_2d(array))
    return f"[{'; '.join(rows)}]"


def _cells(row: Sequence[str]) -> str:
    return "".join(f'<td style="{_CELL}">{escape(text)}</td>' for text in row)
