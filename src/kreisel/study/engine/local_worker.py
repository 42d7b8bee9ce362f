"""Turns a starting Dask worker into one that leaves Ctrl-C to the process that started it."""

from __future__ import annotations

import signal


def dask_setup(worker: object) -> None:
    """Called by Dask, by this name, in the main thread of each worker before its first task.

    A terminal sends Ctrl-C to every process: the workers would die with the blocks that they have finished.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
