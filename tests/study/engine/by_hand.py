"""Turns the README's commands that start a scheduler and two workers into these processes, and ends them."""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]


def commands() -> list[str]:
    """The block of commands, scheduler first, as people read it."""
    found = re.search(r"```\n(dask scheduler[^`]*)```", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert found is not None, "the README shows no commands that start a scheduler"
    return found[1].splitlines()


@contextlib.contextmanager
def started(extra_path: Path | None = None, workers: int = 2) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """Once all are there, the address of the scheduler and the processes: it and its workers.

    The port is one that is free here, so that tests can run side by side: all else is what the README has.
    extra_path : looked into for packages first, by the workers alone.
    """
    from distributed import Client

    port = str(free_port())
    scheduler, *of_workers = (shlex.split(line.replace("8786", port)) for line in commands())
    address = of_workers[0][2]
    processes: list[subprocess.Popen] = []
    try:
        processes.append(_started(scheduler, None))
        processes += [_started(command, extra_path) for command in of_workers[:workers]]
        with Client(address, timeout=60, set_as_default=False) as client:
            if workers:
                client.wait_for_workers(workers, timeout=60)
        yield address, processes
    finally:
        for process in processes:
            kill(process)


def kill(process: subprocess.Popen) -> None:
    """SIGKILL for a process and all that it started, which leaves them no time for a farewell."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


def python(command: list, extra_path: Path | None = None, **settings: Any) -> subprocess.Popen:
    """A process that finds this checkout and the programs beside this Python, in a process group of its own."""
    places = [*([extra_path] if extra_path else []), ROOT / "src", ROOT]
    environment = {
        **os.environ,
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
        "PYTHONPATH": os.pathsep.join(map(str, places)),
    }
    return subprocess.Popen(command, env=environment, start_new_session=True, **settings)


def _started(command: list[str], extra_path: Path | None) -> subprocess.Popen:
    return python(command, extra_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
