"""Turns the name of an optional library into the library, or into an error with the command that installs it."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def library(module: str, extra: str, what: str) -> Any:
    """The module `module`, of the extra `extra`; ValueError where it is not installed: `what` is what needs it."""
    try:
        return import_module(module)
    except ImportError:
        name = module.partition(".")[0]
        raise ValueError(f"{what} needs {name}: pip install 'kreisel[{extra}]'.") from None
