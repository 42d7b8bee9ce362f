"""Turns a file larger than memory into blocks of its noun, and such blocks into a file."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, islice
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from kreisel.atomic import replacing
from kreisel.data.checks import read_only
from kreisel.data.tables import CONSTANTS, arrays_of
from kreisel.files.doors import PathLike, as_kind, checked_noun, format_to_write, reader, write
from kreisel.files.formats import Content, Noun, ReadsBlocks, WritesBlocks
from kreisel.files.spool import Column


def read_blocks(
    path: PathLike,
    format: str | None = None,
    *,
    kind: str | None = None,
    columns: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    times: PathLike | None = None,
    topic: str | Sequence[str] = (),
) -> Iterator[Content]:
    """What `read` gives, a block of rows at a time; each begins where the one before ended and has its t0_ns.

    The whole at once where the format has no blocks, and where the file is not laid out row by row. Arguments and
    complaints are those of `read`; what is wrong in a block is told when it comes to that block.
    """
    module, options = reader(path, format, kind, columns, rate_hz, times, topic)
    source = Path(path)
    found = (
        module.blocks(source, options) if isinstance(module, ReadsBlocks) else [module.read(source, options)]
    )
    return (as_kind(block, kind, source) for block in found)


def write_blocks(path: PathLike, blocks: Iterable[Noun], format: str | None = None) -> None:
    """The file that `write` makes of all blocks together, byte for byte; the whole file or nothing.

    Columns of formats that store one after the other wait beside the file until they are whole, and take as much
    disk again. What a format without blocks writes is collected in memory. Raises as `write` does.
    """
    module = format_to_write(path, format)
    checked = _checked(path, blocks)
    begun = list(islice(checked, 2))
    if len(begun) == 1:
        write(path, begun[0], format)
    elif isinstance(module, WritesBlocks):
        with replacing(path) as out:
            module.write_blocks(chain(begun, checked), out)
    else:
        write(path, joined([*begun, *checked]), format)


def joined(blocks: Sequence[Noun]) -> Noun:
    """One noun of blocks that follow each other; what is one for all rows is that of the first."""
    first = blocks[0]
    if len(blocks) == 1:
        return first
    names = [name for name, _ in arrays_of(first) if name not in CONSTANTS]
    columns: dict[str, Any] = {
        name: read_only(np.concatenate([getattr(block, name) for block in blocks])) for name in names
    }
    return dataclasses.replace(first, **columns)


def mapped(blocks: Iterable[Noun]) -> Noun:
    """What `joined` gives, its columns in files without a name that memory looks into: they need no room in it."""
    first, files = None, {}
    with contextlib.ExitStack() as stack:
        for block in blocks:
            first = first or block
            for name, array in arrays_of(block):
                if name in CONSTANTS:
                    continue
                if name not in files:
                    files[name] = Column(array, stack.enter_context(TemporaryFile()))
                files[name].add(array)
        if first is None:
            raise ValueError("there are no blocks to be joined.")
        columns: dict[str, Any] = {name: column.mapped() for name, column in files.items()}
        return dataclasses.replace(first, **columns)


def _checked(path: PathLike, blocks: Iterable[Noun]) -> Iterator[Noun]:
    """The blocks that have rows; ValueError where none has, or where one does not follow the one before."""
    before = None
    for block in blocks:
        checked_noun(block)
        if len(block) == 0:
            continue
        if before is not None and (type(block), block.t0_ns) != before[:2]:
            raise ValueError(f"blocks of one file must be of one type and epoch; got {type(block).__name__}.")
        if before is not None and not block.t[0] > before[2]:
            raise ValueError(
                f"blocks must follow each other in time; one begins at {block.t[0]:.9g} s, not after {before[2]:.9g} s."
            )
        before = type(block), block.t0_ns, float(block.t[-1])
        yield block
    if before is None:
        raise ValueError(f"nothing to write to {path}: the data has no rows.")
