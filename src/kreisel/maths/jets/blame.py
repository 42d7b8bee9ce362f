"""Turns the error that a user's function ended in into one that names what it gave the time to, and where.

Functions that are not made of NumPy's elementary ones take a jet for an array and fail deep inside, each with
words of its own.
"""

from __future__ import annotations

import linecache
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from kreisel.maths.jets import refusals

_KREISEL = Path(__file__).resolve().parents[2]
_INSTALLED = Path(np.__file__).resolve().parents[1]


def explained(error: Exception, on_numbers: Callable[[], Any]) -> TypeError | None:
    """The error to raise in place of `error`, or None where that says what is wrong.

    on_numbers : the same call with plain times: what fails on those is a mistake of another kind.
    """
    caller, line, callee = _where(error)
    raised_by_us = _is_within(_frames(error)[-1][0], _KREISEL)
    if raised_by_us and str(error) != str(refusals.taken_as_plain_array()):
        return None
    # np.array([t, 0, 0]) fails on numbers as well, but the cure is the same.
    if not raised_by_us and "inhomogeneous" not in str(error) and not _works(on_numbers):
        return None
    place = "" if caller is None else f" ({_spelled(caller, line)})"
    if callee is None:
        return refusals.taken_as_plain_array(place)
    return refusals.loses_derivatives(
        f"{_name(callee)} takes t for a plain array and",
        f"write a formula of NumPy's elementary functions{place}",
    )


def _works(call: Callable[[], Any]) -> bool:
    try:
        call()
    except Exception:
        return False
    return True


def _frames(error: Exception) -> list[tuple[FrameType, int]]:
    found, trace = [], error.__traceback__
    while trace is not None:
        found.append((trace.tb_frame, trace.tb_lineno))
        trace = trace.tb_next
    return found


def _where(error: Exception) -> tuple[FrameType | None, int, FrameType | None]:
    """The user's innermost frame, its line, and the frame of the library that it called, if any."""
    frames = _frames(error)
    users = [
        k
        for k, (frame, _) in enumerate(frames)
        if not (_is_within(frame, _KREISEL) or _is_within(frame, _INSTALLED))
    ]
    if not users:
        return None, 0, None
    frame, line = frames[users[-1]]
    after = frames[users[-1] + 1 :]
    # An operator, which NumPy writes in Python for classes like ours, is nothing that was called.
    callee = next((f for f, _ in after[:1] if not (_is_within(f, _KREISEL) or _is_operator(f))), None)
    return frame, line, callee


def _is_within(frame: FrameType, folder: Path) -> bool:
    return Path(frame.f_code.co_filename).is_relative_to(folder)


def _is_operator(frame: FrameType) -> bool:
    return frame.f_globals.get("__name__") == np.lib.mixins.__name__


def _spelled(frame: FrameType, line: int) -> str:
    file = frame.f_code.co_filename
    source = linecache.getline(file, line).strip()
    return f"{Path(file).name}, line {line}" + (f": {source:.120}" if source else "")


def _name(frame: FrameType) -> str:
    """The name a user knows the called function or object by, without the private modules it lives in."""
    owner = frame.f_locals.get("self")
    if owner is not None and frame.f_code.co_name == "__call__":
        module, name = type(owner).__module__, type(owner).__qualname__
    else:
        module, name = str(frame.f_globals.get("__name__", "")), frame.f_code.co_qualname
    if getattr(np, name, None) is not None and module.startswith("numpy"):
        return f"np.{name}"
    public = []
    for part in module.split("."):
        if part.startswith("_"):
            break
        public.append(part)
    return ".".join([*public, name])
