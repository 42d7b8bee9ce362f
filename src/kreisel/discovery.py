"""Turns a plug-in folder into the list of its plug-ins, and a name into its module; one file, one plug-in."""

from __future__ import annotations

import difflib
from importlib import import_module
from pathlib import Path
from types import ModuleType


def names(package: str) -> list[str]:
    """Plug-ins of `package` (such as "kreisel.files.formats") by file name, without importing them."""
    folder = Path(__file__).parent.joinpath(*package.split(".")[1:])
    found = {p.stem for p in folder.glob("*.py")} | {p.parent.name for p in folder.glob("*/__init__.py")}
    return sorted(name for name in found if not name.startswith("_"))


def load(package: str, name: str) -> ModuleType:
    """The plug-in `name` of `package`; ValueError with the nearest name where there is none."""
    known = names(package)
    if name not in known:
        near = difflib.get_close_matches(name, known, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ValueError(
            f"unknown {package.rsplit('.', 1)[1]} plug-in {name!r}.{hint} There are: {', '.join(known)}."
        )
    return import_module(f"{package}.{name}")
