"""Turns a group of block numbers into their results: what runs inside of a worker."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from time import perf_counter
from typing import Any

from kreisel.study.engine.versions import differences, versions


def delivered(pickled: bytes) -> bytes:
    """The work as it is sent once to all workers, still packed: unpacking is for those with the right versions."""
    return pickled


def computed(
    pickled: bytes, expected: Mapping[str, str], blocks: Sequence[int]
) -> tuple[list[tuple[int, Any]], float, float]:
    """(block, work(block)) of each of `blocks`; how long they took (s), and how many bytes they hold.

    Raises ValueError where this worker, which may have joined late, has other versions than `expected`.
    """
    if told := differences(versions(), expected):
        raise ValueError(f"a worker has other versions: {told}. Install the same on both.")
    from dask.sizeof import sizeof

    start = perf_counter()
    work = _unpacked(pickled)
    made = [(block, _made(work, block)) for block in blocks]
    return made, perf_counter() - start, float(sum(sizeof(result) for _, result in made))


def share_of_worker(size: float) -> float:
    """Bytes for each thread of the worker that this runs in, of `size` that its machine has."""
    from distributed import get_worker

    worker = get_worker()
    return min(size, worker.memory_manager.memory_limit or size) / worker.state.nthreads


def _made(work: Callable[[int], Any], block: int) -> Any:
    try:
        return work(block)
    except Exception as error:
        error.add_note(f"In block {block}.")
        raise


@lru_cache(maxsize=2)
def _unpacked(pickled: bytes) -> Callable[[int], Any]:
    work: Callable[[int], Any] = pickle.loads(pickled)
    return work
