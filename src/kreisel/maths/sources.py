"""Turns a module's source file into a stamp of all of our sources that it is made of."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_IMPORT = re.compile(r"^from (kreisel[\w.]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)


def stamp(file: Path) -> tuple[float, int]:
    """Time of the latest change and size in sum, of `file` and every module of ours it imports, near or far.

    Imports inside of functions are not looked at: kernels cannot have them.
    """
    found = {file}
    waiting = [file]
    while waiting:
        new = _imported(waiting.pop()) - found
        found |= new
        waiting += new
    stats = [path.stat() for path in found]
    return max(s.st_mtime for s in stats), sum(s.st_size for s in stats)


@cache
def _imported(file: Path) -> frozenset[Path]:
    text = file.read_text(encoding="utf-8")
    modules = set()
    for module, names in _IMPORT.findall(text):
        modules |= {module, *(f"{module}.{name}" for name in re.findall(r"\w+", names))}
    places = [_PACKAGE.joinpath(*module.split(".")[1:]) for module in modules]
    files = [path for place in places for path in (place.with_suffix(".py"), place / "__init__.py")]
    return frozenset(path for path in files if path.is_file())
