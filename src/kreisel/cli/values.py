"""Turns the text of an option into its value, or into the one mistake that has exit code 2: a `UsageError`.

What is read here is what somebody typed; a value inside a file that they named is data, and another matter.
"""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

Value = TypeVar("Value")


# argparse lets a type's ArgumentTypeError speak for itself, and puts the option before it.
class UsageError(ArgumentTypeError, ValueError):
    """What was typed cannot be, whatever the files hold: one sentence, exit code 2."""


@contextmanager
def as_typed() -> Iterator[None]:
    """Inside, a ValueError or TypeError is about what was typed: a UsageError with the same sentence."""
    try:
        yield
    except (ValueError, TypeError) as error:
        raise UsageError(str(error)) from None


def typed(parse: Callable[[str], Value]) -> Callable[[str], Value]:
    """`parse` as a type for argparse, whose sentences about what cannot be name the option."""

    def read(text: str) -> Value:
        with as_typed():
            return parse(text)

    return read


def one_of(options: Sequence[str] | Callable[[], Sequence[str]]) -> Callable[[str], str]:
    """A type for argparse: a word of `options`, or of what they return; else the nearest is named."""

    def read(text: str) -> str:
        from kreisel.data.checks import choice

        with as_typed():
            return choice("", text, tuple(options() if callable(options) else options))

    return read


def number(
    unit: str = "", *, above: float | None = None, lowest: float = -math.inf, highest: float = math.inf
) -> Callable[[str], float]:
    """A type for argparse: a finite number within bounds, of which `above` itself is none."""
    wanted = f"must be a number{' of ' if unit else ''}{unit}"
    if above is not None:
        wanted += f" above {above:g}"
    elif highest < math.inf:
        wanted += f" from {lowest:g} to {highest:g}"
    elif lowest > -math.inf:
        wanted += f", {lowest:g} or more"

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and lowest <= value <= highest and (above is None or value > above)):
            raise UsageError(f"{wanted}; got {text!r}.")
        return value

    return read


def whole(lowest: int = 0) -> Callable[[str], int]:
    """A type for argparse: a whole number, `lowest` or more."""

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = lowest - 1
        if value < lowest:
            raise UsageError(f"must be a whole number, {lowest} or more; got {text!r}.")
        return value

    return read


def sensor_name(text: str) -> str:
    """A type for argparse: a preset that comes along, or the name of a file with a sensor in it."""
    from pathlib import Path

    from kreisel.simulate.presets import is_preset, names

    if is_preset(text) or Path(text).suffix in (".toml", ".yaml", ".yml"):
        return text
    return one_of(names)(text)
