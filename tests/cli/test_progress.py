"""Bars appear where somebody waits and looks on, nowhere else."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kreisel.cli import progress as module
from kreisel.cli.notes import quiet
from kreisel.cli.progress import Progress

SOURCE = Path(__file__).resolve().parents[2] / "src"


class Terminal(io.StringIO):
    """A terminal that keeps what was written to it."""

    def isatty(self) -> bool:
        return True


def terminal_of(monkeypatch) -> Terminal:
    """A terminal in place of stderr; not a fixture, for pytest changes stderr between setup and test."""
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(module, "_PATIENCE", 0.01)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    return screen


def work(steps: int, total: int | None, pause: float = 0.1) -> None:
    with Progress(total, "smoothing") as progress:
        for _ in range(steps):
            time.sleep(pause)
            progress.advance()
        progress.reach(steps, "writing")
        time.sleep(pause)


def test_long_work_shows_what_is_done_how_much_and_for_how_long(monkeypatch) -> None:
    terminal = terminal_of(monkeypatch)
    work(3, 4)
    shown = terminal.getvalue()
    assert "smoothing" in shown and "writing" in shown and "3/4" in shown and "0:00:0" in shown


def test_work_of_unknown_length_shows_how_long_it_has_taken(monkeypatch) -> None:
    terminal = terminal_of(monkeypatch)
    work(2, None)
    assert "smoothing" in terminal.getvalue() and "0:00:0" in terminal.getvalue()


def test_short_work_shows_nothing(monkeypatch) -> None:
    terminal = terminal_of(monkeypatch)
    monkeypatch.setattr(module, "_PATIENCE", 10.0)
    work(2, 2, pause=0.0)
    assert terminal.getvalue() == ""


def test_nothing_is_shown_to_files_and_when_quiet(monkeypatch) -> None:
    terminal = terminal_of(monkeypatch)
    with quiet(data_on_stdout=True):
        work(1, 1)
    assert terminal.getvalue() == ""
    log = io.StringIO()
    monkeypatch.setattr(sys, "stderr", log)
    work(1, 1)
    assert log.getvalue() == ""


def test_a_mistake_inside_leaves_no_bar_behind(monkeypatch) -> None:
    terminal = terminal_of(monkeypatch)
    with pytest.raises(ValueError, match="no"), Progress(2, "smoothing"):
        time.sleep(0.2)
        raise ValueError("no")
    before = terminal.getvalue()
    time.sleep(0.2)
    assert terminal.getvalue() == before


def test_where_nobody_looks_rich_is_not_loaded() -> None:
    program = (
        "import sys, time\nfrom kreisel.cli.progress import Progress\n"
        "with Progress(1, 'smoothing') as p:\n    time.sleep(0.7)\n    p.advance()\n"
        "print('rich' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        capture_output=True,
        text=True,
    )
    assert (done.stdout, done.stderr) == ("False\n", "")
