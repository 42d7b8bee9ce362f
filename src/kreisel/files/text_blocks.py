"""Turns a text file of any size into blocks of its lines, one after the other."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from kreisel.files.text import UTF_16, TextFile, decode, read_text, taken_apart

PIECE = 1 << 23
"""Bytes of a block: fifty thousand rows or so."""


def text_blocks(path: Path) -> Iterator[TextFile]:
    """The file's lines, block by block; the first has two rows or more where the file has them.

    Raises as `read_text` does, for what is wrong in a block when it comes to that block. Text in UTF-16 is one block.
    """
    with path.open("rb") as stream:
        if path.stat().st_size <= 2 * PIECE or stream.read(2) in UTF_16:
            yield read_text(path)
            return
        stream.seek(0)
        above, at = None, 0
        for data, last in _pieces(stream, path.stat().st_size):
            file = taken_apart(path, decode(path, data, at), above, last)
            if above is None and len(file.rows) < 2:
                yield read_text(path)
                return
            at, above = at + len(data), file
            if file.rows:
                yield file


def _pieces(stream: BinaryIO, size: int) -> Iterator[tuple[bytes, bool]]:
    """(bytes, whether they are the last) of a file of `size` bytes, cut after line ends."""
    kept = b""
    # What is left beyond a piece goes with it: a short one had too few lines to judge the last one by.
    while size - stream.tell() > 2 * PIECE:
        data = kept + stream.read(PIECE)
        # Where there is nothing but carriage returns the last byte may be the first half of a line end.
        cut = 1 + (data.rfind(b"\n") if b"\n" in data else data.rfind(b"\r", 0, -1))
        kept = data[cut:]
        if cut:
            yield data[:cut], False
    yield kept + stream.read(), True
