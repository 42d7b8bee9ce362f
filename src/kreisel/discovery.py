"""Turns a plug-in folder into the list of its plug-ins, and a name into its module; one file, one plug-in."""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path
from types import ModuleType


def names(package: str) -> list[str]:
    """Plug-ins of `package` (such as "kreisel.files.formats") by file name, without importing them."""
    folder = _folder(package)
    found = {p.stem for p in folder.glob("*.py")} | {p.parent.name for p in folder.glob("*/__init__.py")}
    return sorted(name for name in found if not name.startswith("_"))


def constant(package: str, name: str, assigned: str) -> str:
    """The text that the file of plug-in `name` assigns to `assigned`, read without importing the plug-in."""
    file = _folder(package) / f"{name}.py"
    source = file if file.exists() else file.with_suffix("") / "__init__.py"
    for node in ast.parse(source.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == assigned:
            return str(ast.literal_eval(node.value))
    raise ValueError(f"{source} has no line {assigned} = '...'.")


def _folder(package: str) -> Path:
    return Path(__file__).parent.joinpath(*package.split(".")[1:])


def load(package: str, name: str) -> ModuleType:
    """The plug-in `name` of `package`; ValueError with the nearest name where there is none."""
    known = names(package)
    if name not in known:
        import difflib

        near = difflib.get_close_matches(name, known, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ValueError(
            f"unknown {package.rsplit('.', 1)[1]} plug-in {name!r}.{hint} There are: {', '.join(known)}."
        )
    return import_module(f"{package}.{name}")
