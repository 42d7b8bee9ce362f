"""Turns the versions at a scheduler and its workers into an error, where they are not those of this process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from kreisel.study.engine.versions import differences, versions

_MISSING = "missing"

_DASK = ("dask", "distributed")


def refuse_other_versions(client: Any) -> None:
    """ValueError that names both versions of Python, Dask, kreisel or what its numbers depend on, and where."""
    found = client.get_versions()
    here = _of_dask(found["client"])
    places = {"the scheduler": found["scheduler"]}
    places |= {f"the worker {address}": node for address, node in found["workers"].items()}
    for place, node in places.items():
        _compare(place, _of_dask(node), here)
    # Only now, with the same Python and Dask, may code be sent there.
    ask = _question()
    _compare("the scheduler", client.run_on_scheduler(ask), versions())
    for address, there in client.run(ask).items():
        _compare(f"the worker {address}", there, versions())


def _compare(place: str, there: Mapping[str, str], here: Mapping[str, str]) -> None:
    if there.get("kreisel") == _MISSING:
        raise ValueError(f"kreisel is missing at {place}: pip install 'kreisel[cluster]' there.")
    # What was never asked for, or an older version could not say, is told by the version of kreisel.
    asked = {name: version for name, version in here.items() if name in there}
    if told := differences(there, asked):
        raise ValueError(f"{place} has other versions: {told}. Install the same on both.")


def _of_dask(node: Mapping[str, Any] | None) -> dict[str, str]:
    """Python and Dask of one node, as Dask tells them; patch levels of Python do not matter."""
    if not node:
        return {}
    python = ".".join(str(node["host"]["python"]).split(".")[:2])
    return {"python": python} | {name: str(node["packages"].get(name)) for name in _DASK}


def _question() -> Callable[[], dict[str, str]]:
    """A function that travels whole, because no module has it by name: it runs where kreisel may be missing."""

    def answer() -> dict[str, str]:
        from importlib import import_module

        try:
            package = import_module("kreisel")
        except ImportError:
            return {"kreisel": "missing"}
        try:
            from kreisel.study.engine.versions import versions
        except ImportError:
            return {"kreisel": str(package.__version__)}
        return versions()

    return answer
