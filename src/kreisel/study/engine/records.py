"""Turns the arrays of a block into bytes that prove themselves whole, and a file of them back into arrays.

A record is a prefix (mark, block, length of the body, CRC-32 of these), a body (the names as a line of JSON, then
each array as NumPy's .npy) and 16 bytes of BLAKE2b of both. The prefix has a checksum of its own: behind a
damaged body the next record is found by the length, behind a damaged prefix by the mark.
"""

from __future__ import annotations

import io
import json
import struct
import zlib
from collections.abc import Iterator, Mapping
from hashlib import blake2b
from pathlib import Path
from typing import BinaryIO

import numpy as np

MARK = b"\x89KRB1\r\n\x1a"
"""As PNG has it: no text starts so, and a transfer as text that changes line ends shows."""

_FIELDS = struct.Struct("<8sQQ")  # mark, block, length of the body
_CHECK = struct.Struct("<I")
_PREFIX = _FIELDS.size + _CHECK.size
_DIGEST = 16
_WINDOW = 1 << 20

Arrays = dict[str, np.ndarray]


def packed(block: int, arrays: Mapping[str, np.ndarray]) -> bytes:
    """One record; TypeError where a value is not an array, ValueError where an array holds Python objects."""
    body = io.BytesIO()
    body.write(json.dumps(list(arrays)).encode() + b"\n")
    for name, array in arrays.items():
        if not isinstance(array, np.ndarray):
            raise TypeError(f"a block is a dict of arrays; {name!r} is of type {type(array).__name__}.")
        np.lib.format.write_array(body, array, allow_pickle=False)
    fields = _FIELDS.pack(MARK, block, body.tell())
    whole = fields + _CHECK.pack(zlib.crc32(fields)) + body.getbuffer()
    return whole + _digest(whole)


def records(path: Path) -> Iterator[tuple[int, Arrays] | None]:
    """(block, arrays) of every record of a file that is whole, and None for every stretch that is damaged.

    A record that the end of the file cuts off was never finished: it is passed over.
    """
    with path.open("rb") as stream:
        while prefix := stream.read(_PREFIX):
            if len(prefix) < _PREFIX:
                return
            if not _sound(prefix):
                yield None
                _seek_mark(stream, stream.tell() - _PREFIX + 1)
                continue
            _, block, length = _FIELDS.unpack_from(prefix)
            body, digest = stream.read(length), stream.read(_DIGEST)
            if len(digest) < _DIGEST:
                return
            yield (block, _unpacked(body)) if _digest(prefix + body) == digest else None


def _sound(prefix: bytes) -> bool:
    check = _CHECK.pack(zlib.crc32(prefix[: _FIELDS.size]))
    return prefix.startswith(MARK) and prefix.endswith(check)


def _digest(whole: bytes) -> bytes:
    return blake2b(whole, digest_size=_DIGEST).digest()


def _unpacked(body: bytes) -> Arrays:
    stream = io.BytesIO(body)
    names = json.loads(stream.readline())
    return {name: np.lib.format.read_array(stream, allow_pickle=False) for name in names}


def _seek_mark(stream: BinaryIO, start: int) -> None:
    """Move to the next mark at or behind `start`, or to the end."""
    stream.seek(start)
    while window := stream.read(_WINDOW):
        found = window.find(MARK)
        if found >= 0:
            stream.seek(start + found)
            return
        if len(window) < len(MARK):
            return
        # A mark may lie across the border of two windows.
        start += len(window) - len(MARK) + 1
        stream.seek(start)
