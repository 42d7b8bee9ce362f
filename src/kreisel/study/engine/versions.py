"""Turns this installation into the versions that its numbers depend on, and two such tables into what differs."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from hashlib import blake2b
from importlib import metadata
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parents[2]

_NO_NUMBERS = {"cli", "show", "__pycache__"}
"""Parts of the package that compute nothing."""

_SHOWN = 4
"""Differences that an error names; of more, how many."""


@cache
def versions() -> dict[str, str]:
    """Versions of what decides the bits of a result, with a digest of the sources: a checkout may have changed."""
    return {
        "kreisel": str(sys.modules["kreisel"].__version__),
        "kreisel sources": _digest_of_sources(),
        "numpy": metadata.version("numpy"),
        "numba": metadata.version("numba"),
    }


def _digest_of_sources() -> str:
    digest = blake2b(digest_size=6)
    for file in sorted(path for path in _PACKAGE.rglob("*.*") if path.is_file()):
        place = file.relative_to(_PACKAGE)
        if _NO_NUMBERS.isdisjoint(place.parts):
            digest.update(place.as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """ "seed is 1 there and 2 here; ..." for keys, dotted where they are nested, with other values; "" for none."""
    left, right = dict(_leaves(there)), dict(_leaves(here))
    keys = [key for key in {**left, **right} if left.get(key) != right.get(key)]
    told = [f"{key} is {left.get(key, 'missing')} there and {right.get(key, 'missing')} here" for key in keys]
    more = f"; and {len(told) - _SHOWN} more" if len(told) > _SHOWN else ""
    return "; ".join(told[:_SHOWN]) + more


def _leaves(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Dotted keys and values as JSON, in which NaN equals NaN and no digit of a number is lost."""
    for name, value in table.items():
        key = f"{above}{name}"
        if isinstance(value, list):
            value = {str(k): item for k, item in enumerate(value)} or "[]"
        if isinstance(value, Mapping):
            yield from _leaves(value, key + ".")
        else:
            yield key, json.dumps(value)
