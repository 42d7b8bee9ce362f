"""Turns remarks beside a result into lines on stderr, or with --quiet into nothing."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from contextvars import ContextVar
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parents[1]

_quiet: ContextVar[bool] = ContextVar("quiet", default=False)
_kept: ContextVar[list[str] | None] = ContextVar("kept", default=None)


def is_quiet() -> bool:
    """Whether nothing but errors and asked-for data is to be said."""
    return _quiet.get()


def note(text: str) -> None:
    """Say something that is no error in one line on stderr."""
    kept = _kept.get()
    if kept is not None:
        kept.append(text)
    elif not is_quiet():
        sys.stderr.write("kreisel: note: " + " ".join(text.split()) + "\n")


def complain(text: str) -> None:
    """Say what went wrong in one line on stderr, however quiet it is to be."""
    sys.stderr.write("kreisel: " + " ".join(text.split()) + "\n")


def sentence(error: Exception) -> str:
    """What an error says, with the file that the system could not open."""
    if isinstance(error, OSError) and error.filename and error.strerror:
        return f"{error.filename}: {error.strerror}"
    return str(error)


def warnings_as_notes(usual: Callable[..., None]) -> Callable[..., None]:
    """A `warnings.showwarning` that makes notes of what kreisel warns of, and leaves the rest to the `usual` one."""

    def show(message: Warning | str, category: type[Warning], filename: str, lineno: int, *to: Any) -> None:
        if Path(filename).is_relative_to(_PACKAGE):
            note(str(message))
        elif not is_quiet():
            usual(message, category, filename, lineno, *to)

    return show


@contextmanager
def kept_notes() -> Iterator[list[str]]:
    """Inside, and in this thread, notes are not said but added to a list: for somebody to say them in order."""
    kept: list[str] = []
    token = _kept.set(kept)
    try:
        yield kept
    finally:
        _kept.reset(token)


@contextmanager
def quiet(data_on_stdout: bool) -> Iterator[None]:
    """Inside, no notes and no progress; and nothing on stdout unless that is where data was asked for."""
    token = _quiet.set(True)
    try:
        if data_on_stdout:
            yield
        else:
            with redirect_stdout(io.StringIO()):
                yield
    finally:
        _quiet.reset(token)
