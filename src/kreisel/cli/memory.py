"""Turns the size of a file into whether memory has room for it and for what is made of it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

# Measured: at its peak `estimate` holds 5 to 9 times the bytes of a csv file or plain archive; one that is compressed
# unfolds by 2 before. What is read in blocks is the same, and not slower by much: rather too soon than too late.
_TIMES = 16

_CGROUPS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))

_share: ContextVar[float | None] = ContextVar("share", default=None)


def is_long(path: Path) -> bool:
    """Whether a file is to be read in blocks."""
    share = _share.get()
    return path.is_file() and _TIMES * path.stat().st_size > (available() if share is None else share)


@contextmanager
def share_of_memory(size: float) -> Iterator[None]:
    """Inside, and in this thread, what is longer than `size` bytes have room for is long: others take the rest."""
    token = _share.set(size)
    try:
        yield
    finally:
        _share.reset(token)


def available() -> float:
    """Bytes of memory that this process may use: those of the machine, or fewer where the system was told so."""
    limits = [float("inf")]
    with suppress(ValueError, OSError, AttributeError):
        limits.append(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    with suppress(ImportError):
        import resource

        asked = (resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA))
        limits += [limit for limit in asked if limit != resource.RLIM_INFINITY]
    for place in _CGROUPS:
        with suppress(OSError, ValueError):
            limits.append(int(place.read_text()))
    return min(limits)
