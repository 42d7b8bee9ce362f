"""Numbers are mixed from equal versions alone, and both versions are named where they are not."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest

from kreisel.study.engine.same_versions import refuse_other_versions
from kreisel.study.engine.task import computed
from kreisel.study.engine.versions import differences, versions

NODE = {"host": {"python": "3.11.7.final.0"}, "packages": {"dask": "2026.8.0", "distributed": "2026.8.0"}}


class Cluster:
    """What a client says of a scheduler and two workers, one of which may differ."""

    def __init__(self, place: str = "", key: str = "", value: str = "") -> None:
        names = ("client", "scheduler", "tcp://1", "tcp://2")
        self.nodes: dict[str, Any] = {name: deepcopy(NODE) for name in names}
        self.answers = {name: dict(versions()) for name in names}
        if key == "python":
            self.nodes[place]["host"]["python"] = value
        elif key in NODE["packages"]:
            self.nodes[place]["packages"][key] = value
        elif key:
            self.answers[place][key] = value

    def get_versions(self) -> dict[str, Any]:
        workers = {name: self.nodes[name] for name in ("tcp://1", "tcp://2")}
        return {"client": self.nodes["client"], "scheduler": self.nodes["scheduler"], "workers": workers}

    def run_on_scheduler(self, ask: Any) -> dict[str, str]:
        assert ask() == versions()
        return self.answers["scheduler"]

    def run(self, ask: Any) -> dict[str, dict[str, str]]:
        return {name: self.answers[name] for name in ("tcp://1", "tcp://2")}


def test_equal_versions_pass() -> None:
    refuse_other_versions(Cluster())
    refuse_other_versions(Cluster("tcp://1", "python", "3.11.9.final.0"))


@pytest.mark.parametrize(
    ("place", "key", "value", "message"),
    [
        ("scheduler", "python", "3.13.1.final.0", 'the scheduler .* python is "3.13" there and "3.11" here'),
        ("tcp://2", "dask", "2024.1.0", 'the worker tcp://2 .* dask is "2024.1.0" there and "2026.8.0" here'),
        ("scheduler", "kreisel", "0.0.1", 'the scheduler .* kreisel is "0.0.1" there and ".*" here'),
        ("tcp://1", "numpy", "1.9", 'the worker tcp://1 .* numpy is "1.9" there and ".*" here'),
        (
            "tcp://1",
            "kreisel sources",
            "0",
            'the worker tcp://1 .* kreisel sources is "0" there and ".*" here',
        ),
        ("tcp://2", "kreisel", "missing", "kreisel is missing at the worker tcp://2: pip install"),
    ],
)
def test_what_differs_is_named_with_its_place(place: str, key: str, value: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        refuse_other_versions(Cluster(place, key, value))


def test_a_worker_that_joins_late_looks_for_itself() -> None:
    with pytest.raises(ValueError, match=r'a worker has other versions: numpy is ".*" there and "9.9" here'):
        computed(b"never unpacked", {**versions(), "numpy": "9.9"}, [0])


def test_many_differences_are_counted() -> None:
    there = {f"key {k}": k for k in range(9)}
    assert differences(there, there) == ""
    assert differences(there, {}).startswith("key 0 is 0 there and missing here; ")
    assert differences(there, {}).endswith("; and 5 more")
