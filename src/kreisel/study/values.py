"""Turns what a user put into a recipe into plain values: numbers, texts, tuples and tables of them."""

from __future__ import annotations

import datetime
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from typing import Any, Protocol, TypeVar

import numpy as np

from kreisel.data.checks import finite_number

Vector = tuple[float, float, float]


class Named(Protocol):
    """Anything with a name."""

    @property
    def name(self) -> str:
        """What it is called in reports and file names."""
        ...


Part = TypeVar("Part", bound=Named)


def plain(name: str, value: Any) -> Any:
    """`value` with arrays and lists as tuples and NumPy's numbers as Python's; ValueError for anything but values."""
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value)
    if isinstance(value, Mapping):
        return {str(key): plain(f"{name}.{key}", item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, Sequence):
        return tuple(plain(f"{name}[{k}]", item) for k, item in enumerate(value))
    raise ValueError(
        f"{name} must hold plain values (numbers, texts, lists, tables); got {type(value).__name__}. "
        'Functions of time can be written as text: kind "expressions".'
    )


def vector(name: str, value: Any) -> Vector:
    """`value` as three finite floats, or a ValueError that names it."""
    parts = value.tolist() if isinstance(value, np.ndarray) else value
    if isinstance(parts, str) or not isinstance(parts, Sequence) or len(parts) != 3:
        raise ValueError(f"{name} must be three numbers; got {value!r}.")
    x, y, z = (finite_number(f"{name}[{k}]", part) for k, part in enumerate(parts))
    return x, y, z


def calendar_day(name: str, value: Any) -> datetime.date:
    """`value`, a date or its text "2026-05-01", as a date, or a ValueError that names it."""
    if isinstance(value, str):
        try:
            return datetime.date.fromisoformat(value)
        except ValueError:
            pass
    if not isinstance(value, datetime.date) or isinstance(value, datetime.datetime):
        raise ValueError(f"{name} must be a date, such as 2026-05-01; got {str(value)!r:.40}.")
    return value


def unlike(what: str, parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """`parts` themselves, or a ValueError where two of them share a name."""
    names = [part.name for part in parts]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"two {what}s are called {twice!r}. Give each a name of its own.")
    return parts
