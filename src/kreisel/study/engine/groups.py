"""Turns block numbers into groups that take long enough to be worth a message, by how long those before took."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from statistics import median

GROUP_SECONDS = 0.4
"""A task costs its scheduler milliseconds; a worker lost costs what it had begun."""

GROUP_BYTES = 16e6
"""Results of a group travel and wait as one."""

GROWTH = 4
"""A group is at most so many times as large as one that was measured."""

_REMEMBERED = 9


class Groups:
    """Deals out each block once, at first one by one."""

    def __init__(self, blocks: Sequence[int]) -> None:
        self._blocks, self._dealt, self._size = blocks, 0, 1
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)
        self._bytes: deque[float] = deque(maxlen=_REMEMBERED)

    def deal(self, slots: int) -> Sequence[int]:
        """The next group, for one of `slots` workers; empty when all blocks are dealt out."""
        left = len(self._blocks) - self._dealt
        # The last ones are small: nobody shall wait long for one worker.
        size = min(self._size, max(1, left // (2 * slots)), left)
        self._dealt += size
        return self._blocks[self._dealt - size : self._dealt]

    def took(self, blocks: int, seconds: float, size: float) -> None:
        """Learn from a group of so many blocks: how long it took, and the bytes of its results."""
        self._seconds.append(seconds / blocks)
        self._bytes.append(size / blocks)
        # Medians: the first blocks of a process load compiled code, or compile it.
        by_time = GROUP_SECONDS / max(median(self._seconds), 1e-9)
        by_size = GROUP_BYTES / max(median(self._bytes), 1.0)
        self._size = max(1, int(min(by_time, by_size, GROWTH * blocks)))
