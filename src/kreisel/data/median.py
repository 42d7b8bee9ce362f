"""Turns numbers that come in pieces, more of them than memory holds, into their median."""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from tempfile import TemporaryFile
from typing import IO

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array

Keys = npt.NDArray[np.uint64]

KEPT = 1 << 21
"""Numbers that are kept in memory; beyond, all wait in a temporary file."""

_DIGIT = 16  # bits by which candidates are told apart in one pass


class RunningMedian:
    """The median of all that was added, with the bits of `numpy.median`."""

    def __init__(self) -> None:
        self._pieces: list[Array] = []
        self._kept = self._count = 0
        self._file: IO[bytes] | None = None

    def add(self, values: Array) -> None:
        """More numbers (n,), none of them NaN."""
        self._pieces.append(np.array(values))
        self._kept += len(values)
        self._count += len(values)
        if self._kept > KEPT:
            if self._file is None:
                self._file = TemporaryFile()  # noqa: SIM115, it goes with the median
                weakref.finalize(self, self._file.close)
            for piece in self._pieces:
                self._file.write(piece.tobytes())
            self._pieces, self._kept = [], 0

    def value(self) -> float:
        """The median; NaN of nothing."""
        if self._file is None:
            return float(np.median(np.concatenate(self._pieces))) if self._count else float("nan")
        low, high = (self._count - 1) // 2, self._count // 2
        below = self._of_rank(low)
        return below if low == high else float(np.mean([below, self._of_rank(high)]))

    def _of_rank(self, rank: int) -> float:
        """The number with so many before it, by the bits of its key from the highest on."""
        prefix = 0
        for shift in range(64 - _DIGIT, -1, -_DIGIT):
            counts = np.zeros(1 << _DIGIT, np.int64)
            for keys in self._keys(prefix, shift + _DIGIT):
                digits = (keys >> np.uint64(shift)) & np.uint64((1 << _DIGIT) - 1)
                counts += np.bincount(digits.astype(np.int64), minlength=1 << _DIGIT)
            digit = int(np.searchsorted(np.cumsum(counts), rank, side="right"))
            rank -= int(counts[:digit].sum())
            prefix = (prefix << _DIGIT) + digit
            if counts[digit] <= KEPT:
                candidates = np.concatenate(list(self._keys(prefix, shift)))
                return float(_numbers(np.partition(candidates, rank)[rank : rank + 1])[0])
        return float(_numbers(np.array([prefix], np.uint64))[0])

    def _keys(self, prefix: int, shift: int) -> Iterator[Keys]:
        """The keys of all numbers that begin with `prefix`, `shift` bits from their end."""
        assert self._file is not None  # where all of them are
        self._file.seek(0)
        while data := self._file.read(8 * KEPT):
            keys = _keys_of(np.frombuffer(data))
            yield keys if shift == 64 else keys[keys >> np.uint64(shift) == prefix]
        for piece in self._pieces:
            keys = _keys_of(piece)
            yield keys if shift == 64 else keys[keys >> np.uint64(shift) == prefix]


_SIGN = np.uint64(1 << 63)


def _keys_of(values: Array) -> Keys:
    """Integers in the order of the numbers: the bits of a positive one, all turned over of a negative one."""
    bits = np.ascontiguousarray(values).view(np.uint64)
    return np.where(bits & _SIGN, ~bits, bits | _SIGN)


def _numbers(keys: Keys) -> Array:
    return np.where(keys & _SIGN, keys ^ _SIGN, ~keys).view(np.float64)
