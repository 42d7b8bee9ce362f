"""Turns a table and the function that takes it into a call, or into a sentence about the key that is wrong."""

from __future__ import annotations

import difflib
import inspect
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar, get_args, get_type_hints

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic_core import ErrorDetails

Made = TypeVar("Made")

_WANTED = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text in quotes",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a table",
    "dataclass_type": "a table",
    "finite_number": "a finite number",
    "none_required": "",
}


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a file: "figure.toml: imu[0].p_BS"."""

    file: str
    way: tuple[int | str, ...] = ()

    def at(self, *steps: int | str) -> Place:
        """The place some steps further in."""
        return Place(self.file, (*self.way, *steps))

    def __str__(self) -> str:
        path = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in self.way)
        return f"{self.file}: {path[1:]}" if path else self.file


def call(
    make: Callable[..., Made],
    table: Mapping[str, Any],
    where: Place,
    *,
    ready: Mapping[str, Any] | None = None,
) -> Made:
    """`make(**table, **ready)`, once every key and value of `table` fits the signature and annotations of `make`.

    where : place of the table in its file, which every sentence begins with.
    ready : arguments that were checked before; keys of the same name in `table` are unknown ones.
    Raises ValueError, one sentence, for keys that are unknown or missing, for values of the wrong type, and for
    whatever `make` itself refuses.
    """
    from pydantic import ValidationError

    done = dict(ready or {})
    parameters = {name: parameter for name, parameter in _parameters(make).items() if name not in done}
    try:
        # As JSON, because there a list may stand for a tuple and yet text never for a number.
        checked = _model(make, tuple(parameters)).model_validate_json(json.dumps(table, default=_named))
    except ValidationError as error:
        _refuse(error.errors(include_url=False), table, parameters, where)
    given = {name: getattr(checked, name) for name in table}
    try:
        return make(**given, **done)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{where}: {error}") from None
    except ArithmeticError as error:
        raise ValueError(f"{where}: its numbers cannot be calculated with ({error}).") from None


# These and models take milliseconds to make, and an ensemble asks for the same few in each of a thousand runs.
@lru_cache(maxsize=256)
def _parameters(make: Callable[..., Any]) -> Mapping[str, inspect.Parameter]:
    if not is_dataclass(make):
        return inspect.signature(make, eval_str=True).parameters
    # Fields that were inherited are annotated in the words of another module.
    hints = get_type_hints(make)
    found = inspect.signature(make).parameters
    return {name: parameter.replace(annotation=hints[name]) for name, parameter in found.items()}


def _named(value: Any) -> dict[str, str]:
    """A date, which TOML knows and JSON does not, as something that nobody takes for a text."""
    return {type(value).__name__: str(value)}


@lru_cache(maxsize=256)
def _model(make: Callable[..., Any], names: tuple[str, ...]) -> type[BaseModel]:
    """What checks those arguments of `make`."""
    from pydantic import ConfigDict, create_model

    parameters = {name: _parameters(make)[name] for name in names}
    fields: dict[str, Any] = {
        name: (parameter.annotation, ... if parameter.default is parameter.empty else None)
        for name, parameter in parameters.items()
    }
    strict = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, protected_namespaces=())
    return create_model(make.__name__, __config__=strict, **fields)


def unknown(where: Place, key: str, known: Sequence[str]) -> NoReturn:
    """Refuse a key that nobody knows, with the nearest one that somebody does."""
    folded = {name.casefold(): name for name in known}
    near = difflib.get_close_matches(key.casefold(), folded, n=1)
    hint = f"did you mean {folded[near[0]]!r}?" if near else f"known are {', '.join(known) or 'none'}."
    raise ValueError(f"{where.at(key)} is unknown; {hint}") from None


def unknown_kind(where: Place, kind: str, known: Sequence[str]) -> NoReturn:
    """Refuse a kind that is none, with the nearest one that is."""
    near = difflib.get_close_matches(kind, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(known) or 'none'}."
    raise ValueError(f"{where.at('kind')} {kind!r} is unknown; {hint}")


def _refuse(
    errors: Sequence[ErrorDetails], table: Any, parameters: Mapping[str, inspect.Parameter], where: Place
) -> NoReturn:
    """One sentence about the first key that is wrong, in the words of all errors about it."""
    # A key that is mistyped is also missing: the first says more.
    errors = sorted(errors, key=lambda error: error["type"] != "extra_forbidden")
    ways = [_way(error["loc"], table) for error in errors]
    # Of a value that may be one thing or another, the reading that got furthest is the one that was meant.
    first = max((way for way in ways if way[:1] == ways[0][:1]), key=len)
    about = [error for error, way in zip(errors, ways, strict=True) if way == first]
    kind = about[0]["type"]
    if kind in ("extra_forbidden", "unexpected_keyword_argument"):
        unknown(where.at(*first[:-1]), str(first[-1]), _known(parameters, first[:-1]))
    if kind in ("missing", "missing_argument"):
        raise ValueError(f"{where.at(*first, about[0]['loc'][-1])} is missing.") from None
    wanted = list(dict.fromkeys(filter(None, map(_wanted, about))))
    got = repr(about[0]["input"])
    shown = got if len(got) < 60 else got[:57] + "..."
    raise ValueError(f"{where.at(*first)} must be {' or '.join(wanted)}; got {shown}.") from None


def _way(loc: tuple[int | str, ...], table: Any) -> tuple[int | str, ...]:
    """Those steps of `loc` that lead through the table; the others name members of a union."""
    way = []
    for step in loc:
        inside = (isinstance(table, Mapping) and step in table) or (
            isinstance(table, list | tuple) and isinstance(step, int) and step < len(table)
        )
        if inside:
            way.append(step)
            table = table[step]
    return tuple(way)


def _wanted(error: ErrorDetails) -> str:
    if error["type"] == "literal_error":
        return str(error["ctx"]["expected"])
    if error["type"] in ("too_short", "too_long"):
        count = error["ctx"].get("min_length", error["ctx"].get("max_length"))
        return f"a list of {count}"
    return _WANTED.get(error["type"], error["msg"].removeprefix("Input should be "))


def _known(parameters: Mapping[str, inspect.Parameter], way: Sequence[int | str]) -> list[str]:
    """The keys known at the end of `way`: those of the signature, or of the dataclass that stands there."""
    known = parameters
    # A number leads into a list, whose members are what its annotation says.
    for step in (step for step in way if isinstance(step, str)):
        annotation = known[step].annotation if step in known else None
        inner = next(
            (a for a in (annotation, *get_args(annotation)) if isinstance(a, type) and is_dataclass(a)), None
        )
        known = _parameters(inner) if inner else {}
    return list(known)
