"""Turns the path of a value, "imu.wrist.p_BS[0]", into the steps that lead to it in a scenario's table."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

Way = tuple[str | int, ...]

_TOKEN = re.compile(r'\.?(?:"([^"]+)"|([^.\[\]"]+))|\[(\d+)\]')
_TOP = ("trajectory", "imu", "environment", "filter")

# What stands for a run, not for what it is a run of.
_NOT_VARIED = ("seed", "run", "name", "vary")

Default = Callable[[Way], Any]


def steps(path: str) -> Way:
    """The parts of a path: names between dots, in quotes where they hold dots, and numbers in brackets."""
    found: list[str | int] = []
    at = 0
    while at < len(path):
        match = _TOKEN.match(path, at)
        if match is None or (path[at] in ".[") != (at > 0):
            raise ValueError(f'{path!r} is no path; write it like "imu.imu.p_BS[0]" or "trajectory.period".')
        quoted, name, index = match.groups()
        found.append(int(index) if index is not None else (quoted or name))
        at = match.end()
    return tuple(found)


def resolve(table: Mapping[str, Any], path: str, default: Default) -> Way:
    """Keys and indices that lead from `table`, a whole scenario, to the value of `path`, there or yet to be.

    An IMU or filter goes by its name or its number, and needs neither where it is the only one. `default` says what
    stands where nothing was given, None where it does not know. Raises ValueError with the nearest name.
    """
    found = steps(path)
    if not found:
        raise ValueError("a path must not be empty.")
    if found[0] in _NOT_VARIED:
        raise ValueError(f"{path}: {found[0]} cannot be varied; it tells runs apart.")
    if found[0] not in (*_TOP, "duration", "rate_hz", "start"):
        _nearest(path, found[0], [*_TOP, "duration", "rate_hz", "start"])
    way: Way = ()
    here: Any = table
    for k, step in enumerate(found):
        way, here = _stepped(path, way, here, step)
        if here is None and k + 1 < len(found):
            here = default(way)
            if here is None and isinstance(found[k + 1], int):
                raise ValueError(
                    f"{path}: the scenario has no {found[k]}; give it a value, then vary its parts."
                )
            here = {} if here is None else here
    if isinstance(here, Mapping) or (isinstance(here, Sequence) and _tables(here)):
        raise ValueError(f"{path} is a table; vary one of its values: {', '.join(_names(here)) or 'none'}.")
    return way


def _stepped(path: str, way: Way, here: Any, step: str | int) -> tuple[Way, Any]:
    """One step further in, and what is there; None where nothing is yet."""
    if _tables(here):
        k = _member(path, here, step)
        if k is not None:
            return (*way, k), here[k]
        way, here = (*way, 0), here[0]
    if isinstance(here, Mapping) and isinstance(step, str):
        return (*way, step), here.get(step)
    if isinstance(here, Sequence) and not isinstance(here, str) and isinstance(step, int):
        if not step < len(here):
            raise ValueError(f"{path}: [{step}] is beyond the end; there are {len(here)}, counted from 0.")
        return (*way, step), here[step]
    what = "a list, whose parts go by number" if isinstance(here, list | tuple) else f"{here!r:.40}"
    raise ValueError(f"{path}: nothing goes by {step!r} in {what}.")


def _tables(here: Any) -> bool:
    return isinstance(here, list | tuple) and bool(here) and all(isinstance(t, Mapping) for t in here)


def _member(path: str, tables: Sequence[Mapping[str, Any]], step: str | int) -> int | None:
    """The number of the table that `step` names; None where there is one only, which need not be named."""
    if isinstance(step, int):
        if not step < len(tables):
            raise ValueError(f"{path}: [{step}] is beyond the end; there are {len(tables)}, counted from 0.")
        return step
    names = _names(tables)
    if step in names:
        return names.index(step)
    if len(tables) > 1:
        _nearest(path, step, names)
    return None


def _names(here: Any) -> list[str]:
    if isinstance(here, Mapping):
        return list(here)
    return [str(t.get("name", t.get("kind", k))) for k, t in enumerate(here)]


def _nearest(path: str, step: str | int, known: list[str]) -> NoReturn:
    import difflib

    near = difflib.get_close_matches(str(step), known, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}."
    raise ValueError(f"{path}: {step} is unknown; {hint}")


def put(table: dict[str, Any], way: Way, value: Any, default: Default) -> None:
    """Set the value at the end of `way`, with tables and defaults on the way where there are none."""
    here: Any = table
    for k, step in enumerate(way[:-1]):
        there = here[step] if isinstance(step, int) else here.get(step)
        if there is None:
            found = default(way[: k + 1])
            there = {} if found is None else copy.deepcopy(found)
        here[step] = list(there) if isinstance(there, tuple) else there
        here = here[step]
    here[way[-1]] = value


def written(table: Mapping[str, Any], way: Way) -> str:
    """The one way to write a path, by names where there are any, under which its values are drawn."""
    text = ""
    here: Any = table
    for step in way:
        here_named = isinstance(step, int) and _tables(here) and ("name" in here[step])
        label = str(here[step]["name"]) if here_named else step
        if isinstance(label, int):
            text += f"[{label}]"
        else:
            text += ("." if text else "") + (f'"{label}"' if re.search(r"[.\[\]]", label) else label)
        here = _inner(here, step)
    return text


def _inner(here: Any, step: str | int) -> Any:
    if isinstance(here, Mapping):
        return here.get(str(step))
    return (
        here[step] if isinstance(here, list | tuple) and isinstance(step, int) and step < len(here) else None
    )
