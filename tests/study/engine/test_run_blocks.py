"""Every block once, with the same bits however many threads there are, and ends that come early."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from kreisel import run_blocks
from tests.study.engine.noisy import Noisy, alike

ROOT = Path(__file__).resolve().parents[3]

LONG_STUDY = """
import sys
from pathlib import Path
from kreisel import run_blocks
from tests.study.engine.noisy import Noisy
for done, _ in enumerate(run_blocks(Noisy(pause=0.02), 400, threads=2, folder=sys.argv[1]), start=1):
    print(done, flush=True)
"""


def number(block: int) -> dict[str, np.ndarray]:
    return {"number": np.array([block])}


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_threads_change_no_bit(threads: int) -> None:
    work = Noisy()
    assert alike(dict(run_blocks(work, 40, threads=threads)), {block: work(block) for block in range(40)})


def test_no_blocks_at_all() -> None:
    assert list(run_blocks(number, 0)) == []


def test_progress_counts_what_was_given_out(tmp_path: Path) -> None:
    """Blocks read back are among them."""
    list(run_blocks(number, 4, folder=tmp_path))
    seen: list[int] = []
    assert len(list(run_blocks(number, 9, folder=tmp_path, resume=True, on_done=seen.append))) == 9
    assert seen == list(range(1, 10))


def test_few_blocks_are_held_at_a_time() -> None:
    """A consumer that is slow holds the threads up, before they fill the memory."""
    begun = []

    def counted(block: int) -> dict[str, np.ndarray]:
        begun.append(block)
        return number(block)

    results = run_blocks(counted, 1000, threads=2)
    next(results)
    time.sleep(0.1)
    assert len(begun) <= 8  # two per thread out, and as many in again for those that were done
    results.close()


def test_an_error_names_its_block_and_begins_no_other() -> None:
    begun = []

    def fails(block: int) -> dict[str, np.ndarray]:
        begun.append(block)
        if block == 3:
            raise ZeroDivisionError("no")
        return number(block)

    with pytest.raises(ZeroDivisionError) as caught:
        list(run_blocks(fails, 1000, threads=2))
    assert caught.value.__notes__ == ["In block 3."]
    assert len(begun) < 20


def test_stopping_early_keeps_what_was_running(tmp_path: Path) -> None:
    """The iterator is closed while a block runs: that one is finished and written too."""
    running, go_on = threading.Event(), threading.Event()

    def waits(block: int) -> dict[str, np.ndarray]:
        if block == 1:
            running.set()
            go_on.wait()
        return number(block)

    results = run_blocks(waits, 9, threads=1, folder=tmp_path)
    assert next(results)[0] == 0
    running.wait()
    threading.Timer(0.05, go_on.set).start()
    results.close()
    assert threading.active_count() < 5
    computed: list[int] = []
    study = dict(run_blocks(lambda k: computed.append(k) or number(k), 9, folder=tmp_path, resume=True))
    assert sorted(study) == list(range(9)) and sorted(computed) == list(range(2, 9))


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_a_study_that_was_ended_goes_on_with_the_same_bits(end: signal.Signals, tmp_path: Path) -> None:
    """Ctrl-C and SIGKILL for a process of its own, in the middle: nothing it gave out is computed again."""
    given_out, code = ended_after(15, end, tmp_path)
    assert code == -end
    computed: list[int] = []
    work = Noisy()

    def counted(block: int) -> dict[str, np.ndarray]:
        computed.append(block)
        return work(block)

    study = dict(run_blocks(counted, 400, fingerprint="", folder=tmp_path, resume=True))
    assert alike(study, dict(run_blocks(work, 400)))
    assert len(computed) <= 400 - given_out


def ended_after(count: int, end: signal.Signals, folder: Path) -> tuple[int, int]:
    """How many blocks the long study had given out before `end` came, after `count`, and its exit code."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT)])}
    process = subprocess.Popen(
        [sys.executable, "-c", LONG_STUDY, str(folder)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    for line in process.stdout:
        if int(line) == count:
            break
    process.send_signal(end)
    start = time.monotonic()
    lines = process.communicate(timeout=30)[0].split()
    assert time.monotonic() - start < 10, "a block takes 20 ms: the rest is patience"
    return int(([str(count), *lines])[-1]), process.returncode


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"backend": "threads"}, "backend must be None, 'dask' or the address .* got 'threads'"),
        ({"backend": "tcp://127.0.0.1:1", "threads": 2}, "threads are those of the workers"),
        ({"threads": 0}, "threads must be 1 or more; got 0"),
        ({"resume": True}, "resume needs the folder"),
    ],
)
def test_settings_that_cannot_be_are_refused_at_once(settings: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        run_blocks(number, 3, **settings)
    with pytest.raises(ValueError, match="blocks must be 0 or more"):
        run_blocks(number, -1)


def test_a_missing_extra_is_named_with_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        ValueError, match=r"backend 'dask' needs distributed: pip install 'kreisel\[cluster\]'"
    ):
        next(run_blocks(number, 3, backend="dask"))
