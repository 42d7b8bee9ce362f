"""Turns blocks into results in threads of this process: kernels let go of the interpreter's lock while they work."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from typing import Any

AHEAD = 2
"""Blocks handed in per thread: one that runs, and one for when it is done."""


def usable_cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_threads(
    work: Callable[[int], Any], blocks: Sequence[int], *, threads: int, keep: Callable[[int, Any], None]
) -> Iterator[tuple[int, Any]]:
    """(block, work(block)) as they finish, each handed to `keep` first, in the thread that made it.

    An error or Ctrl-C waits for the blocks that run, which are kept too, and begins no other.
    """

    def done(block: int) -> tuple[int, Any]:
        try:
            made = work(block)
        except Exception as error:
            error.add_note(f"In block {block}.")
            raise
        keep(block, made)
        return block, made

    waiting, pool = iter(blocks), ThreadPoolExecutor(threads, thread_name_prefix="kreisel-block")

    def submitted(count: int) -> set[Future[tuple[int, Any]]]:
        return {pool.submit(done, block) for block in islice(waiting, count)}

    try:
        pending = submitted(AHEAD * threads)
        while pending:
            finished, pending = wait(pending, return_when=FIRST_COMPLETED)
            pending |= submitted(len(finished))
            while finished:
                yield finished.pop().result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
