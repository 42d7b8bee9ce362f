"""`kreisel doctor`: what is installed, what is missing and how to get it, and where compiled code lies."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

import kreisel
from kreisel.cli.commands import doctor
from kreisel.cli.main import main

ROOT = Path(__file__).resolve().parents[2]


def test_the_report_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["schema"] == "kreisel.doctor/1"
    assert report["kreisel"]["version"] == kreisel.__version__
    for name in ("numpy", "numba", "scipy"):
        assert report["dependencies"][name] == {"version": metadata.version(name), "error": None}
    assert 1 <= report["processor"]["usable"] <= report["processor"]["cores"]
    # The command itself loads kernels that some test or run has compiled.
    assert report["cache"]["error"] is None and Path(report["cache"]["folder"]).is_dir()
    assert {"test", "data", "oracle", "compare"} <= set(report["extras"])
    assert "h5py" in report["extras"]["oracle"]["packages"], "oracle stands on data"


def test_the_report_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor"]) == 0
    text = capsys.readouterr().out
    for word in ("kreisel", "Python", "cores usable", "numba", "compiled code", "kernels", "[data]"):
        assert word in text


def test_what_is_missing_is_named_with_the_cure(monkeypatch, capsys) -> None:
    there = doctor._version
    monkeypatch.setattr(doctor, "_version", lambda name: None if name == "h5py" else there(name))
    assert main(["doctor"]) == 0, "an extra is no illness"
    text = capsys.readouterr().out
    assert "without h5py: " in text and "-m pip install" in text and "[data]'" in text


def test_a_dependency_that_does_not_load_is_an_illness(monkeypatch, capsys) -> None:
    # None in their place makes Python refuse the import.
    monkeypatch.setitem(sys.modules, "pygeomag", None)
    assert main(["doctor"]) == 1
    assert "DOES NOT LOAD: ModuleNotFoundError" in capsys.readouterr().out


def test_compiled_code_is_counted_where_it_is_told_to_lie(tmp_path: Path) -> None:
    program = (
        "from kreisel.maths.rotations import rotation_defect; import numpy as np; rotation_defect(np.eye(3)[None])\n"
        "from kreisel.cli.main import main; raise SystemExit(main(['doctor', '--json']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(ROOT / "src"), "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    cache = json.loads(done.stdout)["cache"]
    assert cache["folder"] == str(tmp_path) and cache["writable"]
    assert cache["kernels"] == len(list(tmp_path.rglob("*.nbi"))) == 1
    assert cache["bytes"] == sum(file.stat().st_size for file in tmp_path.rglob("*.nb?"))


def test_a_checkout_that_is_not_installed_knows_its_requirements() -> None:
    lines = doctor._of_checkout(ROOT / "pyproject.toml")
    assert any(line.startswith("numpy") for line in lines)
    assert "h5py>=3.10; extra == 'data'" in lines
    assert doctor._of_checkout(ROOT / "none.toml") == []
