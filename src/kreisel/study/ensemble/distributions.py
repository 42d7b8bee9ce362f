"""Turns a distribution, as a table or as text, into values drawn from a stream of random numbers."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from kreisel.data.checks import choice, finite_number
from kreisel.maths.random import Stream
from kreisel.study.values import plain

KINDS = {
    "normal": "normal(mean, deviation)",
    "uniform": "uniform(lowest, highest)",
    "loguniform": "loguniform(lowest, highest)",
    "choice": "choice(a, b, ...)",
}

_CALL = re.compile(r"\s*(\w+)\s*\((.*)\)\s*", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Distribution:
    """What one value of a scenario is drawn from, once per run.

    kind and values: "normal" (mean, deviation), "uniform" or "loguniform" (lowest, highest), "choice" (any values,
    equally likely). Raises ValueError for anything else.
    """

    kind: str
    values: tuple[Any, ...]

    def __post_init__(self) -> None:
        choice("distribution", self.kind, list(KINDS))
        object.__setattr__(self, "values", plain("values", self.values))
        if self.kind == "choice":
            if not self.values:
                raise ValueError("choice needs at least one value to choose from; got none.")
            return
        if len(self.values) != 2:
            raise ValueError(f"{KINDS[self.kind]} takes two numbers; got {len(self.values)}.")
        low, high = (finite_number(f"{self.kind}[{k}]", value) for k, value in enumerate(self.values))
        object.__setattr__(self, "values", (low, high))
        self._check_order(low, high)

    def _check_order(self, low: float, high: float) -> None:
        if self.kind == "normal" and high < 0.0:
            raise ValueError(f"{KINDS['normal']}: a deviation must not be negative; got {high:g}.")
        if self.kind != "normal" and not high >= low:
            raise ValueError(f"{KINDS[self.kind]}: lowest comes first; got {low:g}, {high:g}.")
        if self.kind == "loguniform" and not low > 0.0:
            raise ValueError(f"{KINDS['loguniform']} needs positive numbers; got {low:g}.")

    @classmethod
    def of(cls, given: Any) -> Distribution:
        """The distribution in a table of one entry, {"normal": (0, 1)}, or in a text, "normal(0, 1)"."""
        if isinstance(given, Distribution):
            return given
        if isinstance(given, str):
            return cls._parsed(given)
        if not isinstance(given, Mapping) or len(given) != 1:
            raise ValueError(f"must be a table such as {{ normal = [0, 1] }}; got {given!r:.60}.")
        (kind, values) = next(iter(given.items()))
        if isinstance(values, str) or not isinstance(values, Sequence):
            raise ValueError(f"{kind} must have a list of values; got {values!r:.60}.")
        return cls(str(kind), tuple(values))

    @classmethod
    def _parsed(cls, text: str) -> Distribution:
        found = _CALL.fullmatch(text)
        if found is None:
            raise ValueError(f"must read like {KINDS['normal']}; got {text!r:.60}.")
        try:
            values = tomllib.loads(f"values = [{found[2]}]")["values"]
        except (ValueError, RecursionError):
            raise ValueError(
                f'{text!r:.60} is not made of numbers or texts in quotes, "like this".'
            ) from None
        return cls(found[1], tuple(values))

    def table(self) -> dict[str, tuple[Any, ...]]:
        """What `of` makes this distribution of again."""
        return {self.kind: self.values}

    def draw(self, stream: Stream) -> Any:
        """One value; the same for the same stream."""
        if self.kind == "choice":
            return self.values[int(stream.uniforms(0, 1, 1)[0, 0] * len(self.values))]
        a, b = self.values
        if self.kind == "normal":
            return a + b * float(stream.normals(0, 1, 1)[0, 0])
        share = float(stream.uniforms(0, 1, 1)[0, 0])
        return a + (b - a) * share if self.kind == "uniform" else a * math.exp(math.log(b / a) * share)

    def __str__(self) -> str:
        return f"{self.kind}({', '.join(f'{v:g}' if isinstance(v, float) else repr(v) for v in self.values)})"


def distributions(vary: Mapping[str, Any]) -> dict[str, dict[str, tuple[Any, ...]]]:
    """`vary` with every distribution as its table; ValueError with the path of one that is none.

    A table in a table stands for a path of several steps, as `trajectory.period = { uniform = [6, 10] }` in TOML.
    """
    found: dict[str, dict[str, tuple[Any, ...]]] = {}
    for path, given in vary.items():
        if isinstance(given, Mapping) and given and not set(given) & set(KINDS) and _all_tables(given):
            found |= {f"{path}.{rest}": table for rest, table in distributions(given).items()}
            continue
        try:
            found[str(path)] = Distribution.of(given).table()
        except ValueError as error:
            raise ValueError(f"vary {path}: {error}") from None
    return found


def _all_tables(table: Mapping[str, Any]) -> bool:
    return all(isinstance(value, Mapping) for value in table.values())
