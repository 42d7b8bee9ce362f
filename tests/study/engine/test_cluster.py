"""Dask gives the bits that threads give, whatever dies on the way."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from kreisel import run_blocks
from kreisel.study.engine.checkpoints import Checkpoints
from tests.study.engine import by_hand
from tests.study.engine.noisy import Deadly, Noisy, alike

pytest.importorskip("distributed", reason="distributed is not installed: pip install kreisel[cluster]")

SLOW = Noisy(pause=0.1)  # long enough that something can happen in the middle


@pytest.fixture(scope="module")
def cluster() -> Iterator[tuple[str, list[subprocess.Popen]]]:
    with by_hand.started() as started:
        yield started


@pytest.fixture
def scheduler(cluster: tuple[str, list[subprocess.Popen]]) -> str:
    return cluster[0]


def test_workers_of_our_own(tmp_path: Path) -> None:
    """One of them is killed by a block at its first try, in the middle of a group."""
    work = Deadly(tmp_path / "died", deadly=60)
    study = dict(run_blocks(work, 100, backend="dask", threads=2))
    assert work.mark.exists()
    assert alike(study, dict(run_blocks(Noisy(), 100)))


def test_a_block_that_kills_again_and_again_is_named(tmp_path: Path) -> None:
    """Dask gives up after four deaths; here after the first, for the time that a new worker takes."""
    import dask

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        pytest.raises(
            ChildProcessError, match=r"every worker that took up block 0 died of it.*out of memory"
        ),
    ):
        list(run_blocks(Deadly(tmp_path / "no" / "mark", deadly=0), 1, backend="dask", threads=1))


def test_small_blocks_share_a_task(scheduler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed import Client

    tasks, submit = [], Client.submit
    monkeypatch.setattr(Client, "submit", lambda *args, **kw: tasks.append(args[-1]) or submit(*args, **kw))
    study = dict(run_blocks(Noisy(), 400, backend=scheduler))
    groups = tasks[1:]  # the first carries the work
    assert sorted(block for group in groups for block in group) == list(range(400))
    assert len(groups) < 100, "blocks of 3 ms went out almost one by one"
    assert alike(study, dict(run_blocks(Noisy(), 400)))


def test_what_a_block_raises_is_raised_here(scheduler: str) -> None:
    with pytest.raises(ZeroDivisionError) as caught:
        list(run_blocks(_third_fails, 10, backend=scheduler))
    assert "In block 3." in caught.value.__notes__


def _third_fails(block: int) -> dict[str, np.ndarray]:
    return {"x": np.array([1 // (block - 3)])}


def test_stopping_early_leaves_the_scheduler_free(scheduler: str) -> None:
    results = run_blocks(SLOW, 1000, backend=scheduler)
    next(results)
    results.close()
    start = time.monotonic()
    assert len(dict(run_blocks(Noisy(), 2, backend=scheduler))) == 2
    assert time.monotonic() - start < 20, "the blocks of the first study were not called back"


def test_work_that_cannot_be_sent_is_refused() -> None:
    lock = threading.Lock()
    with pytest.raises(ValueError, match=r"cannot be sent to other processes: .*lock"):
        next(run_blocks(lambda block: {"x": np.array([lock.locked()])}, 1, backend="dask"))


def test_a_worker_killed_from_outside_costs_its_blocks_alone(
    cluster: tuple[str, list[subprocess.Popen]],
) -> None:
    """SIGKILL for one of the README's two workers and its keeper: the machine is gone. The other does it all."""
    address, (_, first, _) = cluster
    study = {}
    for block, arrays in run_blocks(SLOW, 40, backend=address):
        study[block] = arrays
        if len(study) == 10:
            by_hand.kill(first)
    assert alike(study, dict(run_blocks(Noisy(), 40)))


def test_a_scheduler_that_dies_leaves_what_was_finished(tmp_path: Path) -> None:
    """... and the study goes on elsewhere: here in threads, with the same bits."""
    with by_hand.started(workers=1) as (address, (scheduler, _)):
        study = {}
        with pytest.raises(ConnectionError, match="has gone"):
            for block, arrays in run_blocks(SLOW, 60, backend=address, folder=tmp_path):
                study[block] = arrays
                if len(study) == 10:
                    by_hand.kill(scheduler)
    assert 10 <= len(study) < 60
    resumed = dict(run_blocks(SLOW, 60, folder=tmp_path, resume=True))
    assert alike(resumed, dict(run_blocks(Noisy(), 60)))


def test_another_version_there_is_refused(tmp_path: Path) -> None:
    """A worker whose kreisel is of another day: both versions are named."""
    (tmp_path / "kreisel").mkdir()
    (tmp_path / "kreisel" / "__init__.py").write_text('__version__ = "0.0.9"\n')
    told = r'the worker tcp://.* kreisel is "0\.0\.9" there and "\d.*" here'
    with (
        by_hand.started(extra_path=tmp_path, workers=1) as (address, _),
        pytest.raises(ValueError, match=told),
    ):
        next(run_blocks(Noisy(), 1, backend=address))


@pytest.mark.parametrize("listens", [False, True], ids=["nobody", "somebody who never answers"])
def test_a_scheduler_that_is_not_there(listens: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kreisel.study.engine.cluster.CONNECT_SECONDS", 1)
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        if listens:
            place.listen()
        address = f"tcp://127.0.0.1:{place.getsockname()[1]}"
        told = f"no Dask scheduler answers at {address} .*Start one: dask scheduler"
        start = time.monotonic()
        with pytest.raises(ConnectionError, match=told):
            next(run_blocks(Noisy(), 1, backend=address))
        assert time.monotonic() - start < 6


def test_a_scheduler_without_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    with by_hand.started(workers=0) as (address, _):
        monkeypatch.setattr("kreisel.study.engine.cluster._WORKER_SECONDS", 1)
        with pytest.raises(ConnectionError, match=f"has no worker. Start one: dask worker {address}"):
            next(run_blocks(Noisy(), 1, backend=address))


CTRL_C = """
import sys
from kreisel import run_blocks
from tests.study.engine.noisy import Noisy
if __name__ == "__main__":
    for block, _ in run_blocks(Noisy(pause=0.05), 2000, backend="dask", threads=1, folder=sys.argv[1]):
        print(block, flush=True)
"""


def test_ctrl_c_keeps_what_workers_have_finished(tmp_path: Path) -> None:
    """A terminal sends it to the workers too: they leave the farewell to the process that started them."""
    (tmp_path / "script.py").write_text(CTRL_C)
    command = [sys.executable, tmp_path / "script.py", tmp_path / "study"]
    process = by_hand.python(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        given_out = [int(process.stdout.readline()) for _ in range(20)]
        os.killpg(process.pid, signal.SIGINT)
        out, errors = process.communicate(timeout=30)
    finally:
        by_hand.kill(process)
    assert process.returncode == -signal.SIGINT
    assert errors.count("Traceback") == 1 and errors.rstrip().endswith("KeyboardInterrupt"), errors
    given_out += map(int, out.split())
    finished = {block for block, _ in Checkpoints(tmp_path / "study").finished(2000)}
    assert finished >= set(given_out) and len(finished) < 2000
