"""Turns this installation into a report for whoever has to help with it: `kreisel doctor`."""

from __future__ import annotations

import importlib
import os
import platform
import re
import sys
from argparse import ArgumentParser, Namespace
from importlib import metadata
from pathlib import Path
from typing import Any

from kreisel import __version__
from kreisel.cli.reports import add_report_arguments, print_json

HELP = "versions, processor, compiled code and extras of this installation"

SCHEMA = "kreisel.doctor/1"

_PACKAGE = Path(__file__).resolve().parents[2]

# Variables that change how fast, or where, things run.
_VARIABLES = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_CACHE_DIR", "NUMBA_DISABLE_JIT", "MPLBACKEND")

# Where the name to import is not that of the package.
_IMPORTED_AS = {"pillow": "PIL", "pyyaml": "yaml", "import-linter": "importlinter"}

_Requirements = dict[str, list[str]]


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_report_arguments(parser)


def run(args: Namespace) -> int:
    """Examine and report; 1 where a dependency is missing or does not load."""
    report = _examined()
    if args.json:
        print_json({"schema": SCHEMA, **report})
    else:
        print("\n".join(_told(report)))
    sound = all(found["error"] is None for found in report["dependencies"].values())
    return 0 if sound and report["cache"]["error"] is None else 1


def _examined() -> dict[str, Any]:
    required = _requirements()
    core = {name: _loaded(name) for name in required.pop("", [])}
    return {
        "kreisel": {"version": __version__, "folder": str(_PACKAGE)},
        "python": {"version": platform.python_version(), "executable": sys.executable},
        "system": platform.platform(),
        "processor": _processor(),
        "variables": {name: os.environ.get(name) for name in _VARIABLES},
        "dependencies": core,
        "cache": _cache(),
        "extras": {extra: _extra(extra, names) for extra, names in sorted(required.items())},
    }


def _requirements() -> _Requirements:
    """Extra -> names of the packages it asks for; "" -> those that are always needed."""
    try:
        lines = metadata.requires("kreisel") or []
    except metadata.PackageNotFoundError:
        lines = _of_checkout(_PACKAGE.parents[1] / "pyproject.toml")
    found: _Requirements = {"": []}
    for line in lines:
        name, extra = re.match(r"[\w.-]+", line), re.search(r"""extra\s*==\s*['"]([\w.-]+)['"]""", line)
        names = found.setdefault(extra[1] if extra else "", [])
        inner = re.match(r"kreisel\[([\w,.-]+)\]", line)
        names += [f"[{e}]" for e in inner[1].split(",")] if inner else [name[0].lower()] if name else []
    return {extra: _resolved(extra, found) for extra in found}


def _of_checkout(file: Path) -> list[str]:
    """Requirements in the manner of an installed package, of sources that are not installed."""
    import tomllib

    if not file.is_file():
        return []
    project = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
    optional = project.get("optional-dependencies", {})
    return project["dependencies"] + [f"{n}; extra == '{e}'" for e, names in optional.items() for n in names]


def _resolved(extra: str, found: _Requirements) -> list[str]:
    """The packages of an extra, with those of the extras it stands on."""
    names: list[str] = []
    for name in found.get(extra, []):
        names += _resolved(name.strip("[]"), found) if name.startswith("[") else [name]
    return list(dict.fromkeys(names))


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _loaded(name: str) -> dict[str, str | None]:
    """Version of a package, and why it cannot be imported."""
    error = None
    try:
        importlib.import_module(_IMPORTED_AS.get(name, name.replace("-", "_")))
    except Exception as problem:  # whatever a broken installation comes up with
        error = f"{type(problem).__name__}: {problem}".splitlines()[0]
    return {"version": _version(name), "error": error}


def _extra(extra: str, names: list[str]) -> dict[str, Any]:
    found = {name: _version(name) for name in names}
    missing = [name for name, version in found.items() if version is None]
    return {"packages": found, "missing": missing, "install": _install(extra) if missing else None}


def _install(extra: str) -> str:
    """The command that brings an extra to this Python: of this checkout, or of the package installed."""
    checkout = _PACKAGE.parents[1]
    what = str(checkout) if (checkout / "pyproject.toml").is_file() else "kreisel"
    edit = "-e " if what != "kreisel" else ""
    return f"{sys.executable} -m pip install {edit}'{what}[{extra}]'"


def _processor() -> dict[str, Any]:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {"name": _processor_name(), "cores": os.cpu_count(), "usable": usable}


def _processor_name() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    named = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return named[1] if named else platform.processor() or platform.machine()


def _cache() -> dict[str, Any]:
    """Where compiled code is kept, and how much of it there is of this package, Python and version of numba."""
    nothing = {"folder": None, "writable": False, "kernels": 0, "bytes": 0}
    try:
        from kreisel.maths import kernels
    except Exception as problem:
        return {**nothing, "error": f"{type(problem).__name__}: {problem}".splitlines()[0]}
    known: Any = kernels.row_of_axes
    # Plain Python where compilation is switched off; nothing where no folder can be written.
    folder = getattr(getattr(known, "stats", None), "cache_path", None)
    if folder is None:
        return {**nothing, "error": "not cached: NUMBA_DISABLE_JIT is set, or no folder can be written"}
    folders = _cache_folders(Path(folder), known)
    files = [file for place in folders for file in place.glob("*.nb[ic]")]
    # Beside the sources every package has a folder of its own; elsewhere one holds them all.
    shown = _PACKAGE if Path(folder).is_relative_to(_PACKAGE) else Path(folder).parent
    return {
        "folder": str(shown),
        "writable": os.access(folder if Path(folder).exists() else shown, os.W_OK),
        "kernels": sum(file.suffix == ".nbi" for file in files),
        "bytes": sum(file.stat().st_size for file in files),
        "error": None,
    }


def _cache_folders(folder: Path, known: Any) -> list[Path]:
    """The folders that hold compiled code of this package, of which `folder` is that of a kernel `known`."""
    sources = {file.parent for file in _PACKAGE.rglob("*.py")}
    if folder.is_relative_to(_PACKAGE):
        return [source / "__pycache__" for source in sorted(sources)]
    # numba names them after the sources' folder; not of its public face, so that it may be elsewhere one day.
    implementation = getattr(getattr(known, "_cache", None), "_impl", None)
    named = getattr(getattr(implementation, "locator", None), "get_suitable_cache_subpath", None)
    if named is None:
        return [folder]
    return [folder.parent / named(str(source / "__init__.py")) for source in sorted(sources)]


def _told(report: dict[str, Any]) -> list[str]:
    processor, python = report["processor"], report["python"]
    rows = [
        ("kreisel", f"{report['kreisel']['version']} in {report['kreisel']['folder']}"),
        ("Python", f"{python['version']}, {python['executable']}"),
        ("system", report["system"]),
        ("processor", f"{processor['name']}, {processor['usable']} of {processor['cores']} cores usable"),
        *((name, value) for name, value in report["variables"].items() if value is not None),
        ("", ""),
        *((name, _dependency(found)) for name, found in report["dependencies"].items()),
        ("", ""),
        ("compiled code", _cached(report["cache"])),
        ("", ""),
        *((f"[{extra}]", _told_extra(found)) for extra, found in report["extras"].items()),
    ]
    width = max(len(name) for name, _ in rows)
    return [f"{name:<{width}}  {text}".rstrip() for name, text in rows]


def _dependency(found: dict[str, Any]) -> str:
    if found["version"] is None:
        return "MISSING"
    return (
        found["version"] if found["error"] is None else f"{found['version']}, DOES NOT LOAD: {found['error']}"
    )


def _cached(cache: dict[str, Any]) -> str:
    if cache["error"] is not None:
        return str(cache["error"])
    kept = f"{cache['kernels']} kernels, {cache['bytes'] / 1e6:.1f} MB, in {cache['folder']}"
    return kept + ("" if cache["writable"] else ", NOT WRITABLE: what is missing is compiled at every start")


def _told_extra(found: dict[str, Any]) -> str:
    if not found["missing"]:
        return ", ".join(f"{name} {version}" for name, version in found["packages"].items())
    return f"without {', '.join(found['missing'])}: {found['install']}"
