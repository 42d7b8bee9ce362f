"""Turns blocks into results on Dask: workers started here for as long as it takes, or those of a scheduler."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import queue
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from kreisel.files.extras import library
from kreisel.study.engine.groups import Groups
from kreisel.study.engine.same_versions import refuse_other_versions
from kreisel.study.engine.task import computed, delivered
from kreisel.study.engine.versions import versions

CONNECT_SECONDS = 8
"""How long a scheduler has to answer."""

AHEAD = 2
"""Groups handed in per worker thread: one that runs, and one for when it is done."""

_WORKER_SETUP = "kreisel.study.engine.local_worker"

_LEAN = {
    # What Dask observes for its dashboard, a hundred times a second: a tenth of the time of a busy machine.
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    # Dask has memory given back to the system at once. Blocks ask for as much again: that would take a fifth longer.
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 1 << 26,
    "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": 1 << 25,
}
"""Settings of Dask for workers that do nothing but our blocks."""

_WORKER_SECONDS = 8
_LOOK_SECONDS = 5.0
_FETCH_SECONDS = 60.0


def on_dask(
    work: Callable[[int], Any],
    blocks: Sequence[int],
    *,
    address: str | None,
    workers: int,
    keep: Callable[[int, Any], None],
) -> Iterator[tuple[int, Any]]:
    """(block, work(block)) as they finish, each handed to `keep` first, in this thread.

    address : of a running scheduler, or None to start one with `workers` processes here.
    Blocks go out in groups of about 0.4 s, by what those before took. Those of a worker that dies are done again.
    An error or Ctrl-C keeps what workers have finished, and calls back the rest.
    Raises ValueError without Dask, with other versions there, and for work that cannot be pickled; ConnectionError
    where no scheduler or worker answers; ChildProcessError where workers die of the same blocks again and again.
    """
    library("distributed", "cluster", "backend" + (" 'dask'" if address is None else f" {address}"))
    if not blocks:
        return
    pickled = _pickled(work)
    with _client(address, workers) as client:
        refuse_other_versions(client)
        stream = _Stream(client, pickled, blocks, keep)
        try:
            yield from stream.results()
        finally:
            stream.close()


class _Stream:
    """Groups of blocks on their way to the workers of a client, and back."""

    def __init__(
        self, client: Any, pickled: bytes, blocks: Sequence[int], keep: Callable[[int, Any], None]
    ) -> None:
        self._client, self._keep, self._address = client, keep, client.scheduler.address
        self._groups, self._pending = Groups(blocks), dict[Any, Sequence[int]]()
        self._finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        with warnings.catch_warnings():
            # Dask warns of large arguments: this one travels once, and is made again where its holder dies.
            warnings.simplefilter("ignore", UserWarning)
            self._work = client.submit(delivered, pickled, pure=False)

    def results(self) -> Iterator[tuple[int, Any]]:
        self._send()
        while self._pending:
            future = self._next()
            made = self._fetched(future)
            self._send()
            yield from made

    def close(self) -> None:
        """Keep what is finished, call back what is not."""
        for future in [future for future in self._pending if future.status == "finished"]:
            # Whatever ended the study is what the user shall see.
            with contextlib.suppress(Exception):
                self._fetched(future)
        with contextlib.suppress(Exception):
            self._client.cancel([*self._pending, self._work], force=True)

    def _send(self) -> None:
        slots = _slots(self._client) or 1
        while len(self._pending) < AHEAD * slots and (group := self._groups.deal(slots)):
            future = self._client.submit(computed, self._work, versions(), tuple(group), pure=False)
            self._pending[future] = group
            future.add_done_callback(self._finished.put)

    def _next(self) -> Any:
        told = False
        while True:
            try:
                return self._finished.get(timeout=_LOOK_SECONDS)
            except queue.Empty:
                if not told and _slots(self._client) == 0:
                    told = True
                    warnings.warn(
                        f"no worker is left; waiting for one: dask worker {self._address}", stacklevel=2
                    )

    def _fetched(self, future: Any) -> list[tuple[int, Any]]:
        """The results of a group, kept."""
        group = self._pending[future]
        made, seconds, size = _result(future, group)
        self._groups.took(len(group), seconds, size)
        for block, result in made:
            self._keep(block, result)
        # Not before: Ctrl-C may come in between, and `close` fetches what is still pending.
        del self._pending[future]
        return made


def _result(future: Any, group: Sequence[int]) -> tuple[list[tuple[int, Any]], float, float]:
    from concurrent.futures import CancelledError

    from distributed import KilledWorker

    try:
        result: tuple[list[tuple[int, Any]], float, float] = future.result(timeout=_FETCH_SECONDS)
    except KilledWorker as error:
        raise ChildProcessError(
            f"every worker that took up {_named(group)} died of it, the last at {error.last_worker.address}: out of "
            "memory? Give the workers more (dask worker --memory-limit), or let fewer of them share a machine."
        ) from None
    except (CancelledError, TimeoutError, OSError):
        if future.status == "error":  # the work's own
            raise
        raise ConnectionError(
            "the Dask scheduler has gone; blocks that were not finished are lost with it. "
            "Start it again, then go on by resume where there is a folder of finished blocks."
        ) from None
    return result


def _named(group: Sequence[int]) -> str:
    return f"block {group[0]}" if len(group) == 1 else f"blocks {group[0]} to {group[-1]}"


def _slots(client: Any) -> int | None:
    """Threads of all workers; None where the scheduler does not answer."""
    try:
        return sum(client.nthreads().values())
    except Exception:
        return None


def _pickled(work: Callable[[int], Any]) -> bytes:
    from distributed.protocol.pickle import dumps

    try:
        pickled: bytes = dumps(work)
    except Exception as error:
        raise ValueError(
            f"this study cannot be sent to other processes: {error}. Run it in this one, without a backend."
        ) from None
    return pickled


@contextlib.contextmanager
def _client(address: str | None, workers: int) -> Iterator[Any]:
    """A client of the scheduler at `address`, or of one of our own, which ends with the block."""
    with contextlib.ExitStack() as stack:
        stack.enter_context(_quiet())
        client = stack.enter_context(_elsewhere(address) if address else _here(workers))
        try:
            client.wait_for_workers(1, timeout=_WORKER_SECONDS)
        except TimeoutError:
            raise ConnectionError(
                f"the scheduler at {address} has no worker. Start one: dask worker {address}"
            ) from None
        yield client


@contextlib.contextmanager
def _elsewhere(address: str) -> Iterator[Any]:
    from distributed import Client

    # A client waits for ever where something answers that is no scheduler, or one that is stopped.
    with ThreadPoolExecutor(1) as apart:
        try:
            apart.submit(asyncio.run, asyncio.wait_for(_greeting(address), CONNECT_SECONDS)).result()
        except OSError as error:
            raise ConnectionError(
                f"no Dask scheduler answers at {address} (waited {CONNECT_SECONDS} s). Start one: dask scheduler"
            ) from error
    with Client(address, timeout=CONNECT_SECONDS, set_as_default=False) as client:
        yield client


async def _greeting(address: str) -> None:
    from distributed.core import rpc
    from distributed.security import Security

    async with rpc(address, connection_args=Security().get_connection_args("client")) as scheduler:
        await scheduler.identity()


@contextlib.contextmanager
def _here(workers: int) -> Iterator[Any]:
    import dask
    from distributed import Client, LocalCluster

    before = set(os.environ)
    try:
        with dask.config.set(_LEAN):
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                preload=[_WORKER_SETUP],
                silence_logs=logging.CRITICAL,
            )
    except RuntimeError as error:
        # Every worker begins by importing the script, and would come here again.
        raise ChildProcessError(
            "Dask could not start its workers. In a script, whatever uses this backend has to stand under "
            'if __name__ == "__main__":'
        ) from error
    finally:
        # What Dask sets for its workers is not meant for this process; a worker started again has it from its keeper.
        for name in set(os.environ) - before:
            del os.environ[name]
    with cluster, Client(cluster, set_as_default=False) as client:
        yield client


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Without Dask's own words about connections that fail and versions that differ: ours say it."""
    from distributed.versions import VersionMismatchWarning

    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    before = {logger: logger.level for logger in map(logging.getLogger, names)}
    for logger in before:
        logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", VersionMismatchWarning)
            yield
    finally:
        for logger, level in before.items():
            logger.setLevel(level)
