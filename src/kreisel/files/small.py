"""Turns the name of a file that people write by hand into its bytes."""

from __future__ import annotations

from pathlib import Path

_MOST = 1_000_000  # bytes; anything larger is some other file


def read_small(path: Path, what: str) -> bytes:
    """All of a file that people write themselves, such as "scenario"; ValueError where it is too large for one."""
    try:
        with path.open("rb") as stream:
            data = stream.read(_MOST + 1)
    except OSError as error:
        raise type(error)(f"cannot read {path}: {error.strerror}.") from None
    if len(data) > _MOST:
        raise ValueError(f"{path} is no {what}: it is larger than {_MOST // 1000} kB.")
    return data
