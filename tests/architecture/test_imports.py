"""What may import what, and what an import may cost."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from importlinter.cli import lint_imports

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
HEAVY = {"pydantic", "matplotlib", "scipy", "numba", "bokeh", "PIL", "pandas", "rosbags", "dask"}
HEAVY |= {"xarray", "h5py", "h5netcdf", "pyarrow", "rerun", "mcap", "mcap_ros2"}


def module_names() -> list[str]:
    """Dotted names of every module of the package."""
    parts = (path.relative_to(SOURCE).with_suffix("").parts for path in SOURCE.rglob("*.py"))
    names = (".".join(part for part in module if part != "__init__") for module in parts)
    return sorted(name for name in names if not name.endswith("__main__"))


def fresh_python(program: str, *arguments: str) -> str:
    """Standard output of `program` in an interpreter of its own."""
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


# One interpreter for all modules, because numba alone takes half a second to load. The third-party
# packages stay, ours are forgotten before every import: a cycle or a missing import still shows.
IMPORT_EACH_ALONE = """
import importlib, sys, traceback
for name in sys.argv[1:]:
    for loaded in [m for m in sys.modules if m.split(".")[0] == "kreisel"]:
        del sys.modules[loaded]
    try:
        importlib.import_module(name)
    except Exception:
        print(name, traceback.format_exc())
"""

IMPORT_AND_LIST = """
import importlib, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
print(*{module.split(".")[0] for module in sys.modules})
"""


def test_import_contracts_hold(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.syspath_prepend(str(SOURCE))
    exit_code = lint_imports(no_cache=True)
    assert exit_code == 0, capsys.readouterr().out


def test_each_module_imports_alone() -> None:
    assert fresh_python(IMPORT_EACH_ALONE, *module_names()) == ""


def test_importing_the_package_loads_nothing_heavy() -> None:
    loaded = set(fresh_python(IMPORT_AND_LIST, "kreisel").split())
    assert loaded & HEAVY == set()


def test_only_show_loads_plotting() -> None:
    drawing = ("kreisel.show", "kreisel.cli")
    names = [name for name in module_names() if not name.startswith(drawing)]
    loaded = set(fresh_python(IMPORT_AND_LIST, *names).split())
    assert loaded & {"matplotlib", "bokeh", "PIL"} == set()
