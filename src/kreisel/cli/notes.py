"""Turns remarks beside a result into lines on stderr, or with --quiet into nothing."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from contextvars import ContextVar

_quiet: ContextVar[bool] = ContextVar("quiet", default=False)


def is_quiet() -> bool:
    """Whether nothing but errors and asked-for data is to be said."""
    return _quiet.get()


def note(text: str) -> None:
    """Say something that is no error in one line on stderr."""
    if not is_quiet():
        sys.stderr.write("kreisel: note: " + " ".join(text.split()) + "\n")


def complain(text: str) -> None:
    """Say what went wrong in one line on stderr, however quiet it is to be."""
    sys.stderr.write("kreisel: " + " ".join(text.split()) + "\n")


def sentence(error: Exception) -> str:
    """What an error says, with the file that the system could not open."""
    if isinstance(error, OSError) and error.filename and error.strerror:
        return f"{error.filename}: {error.strerror}"
    return str(error)


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
