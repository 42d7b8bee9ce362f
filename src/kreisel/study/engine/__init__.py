"""Turns a function of a block number into the arrays of all blocks: in threads, on Dask, with checkpoints."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.study.engine.checkpoints import Checkpoints
from kreisel.study.engine.threads import in_threads, usable_cores

if TYPE_CHECKING:
    import numpy as np

LOCAL = "dask"
"""The backend that starts Dask workers on this machine, and ends them."""


def run_blocks(
    work: Callable[[int], dict[str, np.ndarray]],
    blocks: int,
    *,
    fingerprint: Mapping[str, Any] | str = "",
    backend: str | None = None,
    threads: int | None = None,
    folder: Path | str | None = None,
    resume: bool = False,
    on_done: Callable[[int], None] | None = None,
) -> Generator[tuple[int, dict[str, np.ndarray]], None, None]:
    """(block, work(block)) for each block 0, 1, ... blocks - 1, in the order in which they finish.

    work : pure function of the block number, safe in threads; with a backend it has to be picklable as well.
    fingerprint : plain values that decide what the blocks hold: seed, scenario, the number of runs where the last
        block depends on it. How often and where it ran does not belong there.
    backend : None for threads of this process, "dask" for workers started on this machine and ended afterwards,
        "tcp://host:port" for a scheduler that runs already. The bits are the same.
    threads : how many blocks at once, on this machine; None for all cores.
    folder : every finished block is written there before it is given out; `resume` reads them back first.
    on_done : called with the number of blocks given out so far, those read back among them.

    Few blocks are held in memory at a time. Whoever stops early closes the iterator (`contextlib.closing`): blocks
    that run are finished and written, no other is begun.
    Raises, at once, ValueError for a folder with another study in it, or with finished blocks and no `resume`; later
    OSError where the disk is full, no scheduler answers or workers die again and again; and whatever `work` raises.
    """
    if blocks < 0:
        raise ValueError(f"blocks must be 0 or more; got {blocks}.")
    if resume and folder is None:
        raise ValueError("resume needs the folder that the finished blocks are in.")
    spread = _spreader(backend, threads)
    kept = None if folder is None else Checkpoints.opened(Path(folder), fingerprint, resume=resume)
    return _counted(_given_out(work, blocks, spread, kept), on_done)


def spread_out(
    work: Callable[[int], Any], items: int, *, backend: str | None = None, threads: int | None = None
) -> Iterator[tuple[int, Any]]:
    """(k, work(k)) for k = 0, 1, ... items - 1 as `run_blocks` does it, without a folder, of any result."""
    return _spreader(backend, threads)(work, range(items), keep=_forgotten)


def _spreader(backend: str | None, threads: int | None) -> Callable[..., Any]:
    """The backend as a function of work, blocks and what to do with each finished one."""
    if threads is not None and threads < 1:
        raise ValueError(f"threads must be 1 or more; got {threads}.")
    if backend is None:
        return partial(in_threads, threads=threads or usable_cores())
    from kreisel.study.engine.cluster import on_dask

    if backend == LOCAL:
        return partial(on_dask, address=None, workers=threads or usable_cores())
    if "://" not in backend:
        raise ValueError(
            f"backend must be None, {LOCAL!r} or the address of a scheduler such as tcp://127.0.0.1:8786; "
            f"got {backend!r}."
        )
    if threads is not None:
        raise ValueError(
            "threads are those of the workers at a scheduler: dask worker --nthreads. Leave it out."
        )
    return partial(on_dask, address=backend, workers=0)


def _given_out(
    work: Callable[[int], Any], blocks: int, spread: Callable[..., Any], kept: Checkpoints | None
) -> Iterator[tuple[int, Any]]:
    left: Sequence[int] = range(blocks)
    with nullcontext() if kept is None else closing(kept):
        if kept is not None:
            found = set()
            for block, arrays in kept.finished(blocks):
                found.add(block)
                yield block, arrays
            left = [block for block in left if block not in found]
        keep = _forgotten if kept is None else kept.keep
        with closing(spread(work, left, keep=keep)) as results:
            yield from results


def _counted(
    results: Iterator[tuple[int, Any]], on_done: Callable[[int], None] | None
) -> Generator[tuple[int, Any], None, None]:
    for done, result in enumerate(results, start=1):
        if on_done is not None:
            on_done(done)
        yield result


def _forgotten(block: int, made: Any) -> None:
    """What becomes of a finished block where there is no folder for it."""
