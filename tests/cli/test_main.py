"""The frame around all commands: what help costs, how notes and mistakes look."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kreisel import discovery
from kreisel.cli.main import COMMANDS, main

SOURCE = Path(__file__).resolve().parents[2] / "src"


def test_help_lists_every_command_and_loads_no_number_cruncher() -> None:
    program = "import sys; sys.argv = ['kreisel', '--help']\n" + (
        "from kreisel.cli.main import main\n"
        "try:\n    main()\nfinally:\n    print(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    for name in discovery.names(COMMANDS):
        assert f"    {name}" in done.stdout
    # numpy alone is a third of the budget of 0.35 s, numba all of it.
    loaded = {module.split(".")[0] for module in done.stderr.split()}
    assert loaded & {"numpy", "numba", "scipy", "matplotlib", "rich", "pydantic"} == set()


@pytest.mark.filterwarnings("default")
def test_a_note_is_one_line_on_stderr(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cut = tmp_path / "cut.csv"
    cut.write_text("t,x,y,z\n0,1000,2000,3000\n1,1000,2000,3000\n2,1000,2000,3")
    assert main(["info", str(cut)]) == 0
    streams = capsys.readouterr()
    assert streams.err.startswith(f"kreisel: note: {cut}, line 4: the last line has no line end")
    assert streams.err.count("\n") == 1
    assert "line end" not in streams.out


def test_an_option_before_the_command_is_one_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["--frobnicate", "info"])
    assert stop.value.code == 2
    assert capsys.readouterr().err.count("\n") == 2


@pytest.mark.parametrize("module", ["kreisel.cli.main", "argparse", "numpy", "numba", "kreisel.files.doors"])
def test_ctrl_c_while_loading_is_one_line_and_130(module: str) -> None:
    program = f"""
import sys
class Interrupted:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupted())
sys.argv = ["kreisel", "info", "x.csv"]
from kreisel.__main__ import main
sys.exit(main())
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 130
    assert done.stderr == "kreisel: interrupted; nothing half-written was left behind\n"
