"""Turns named arrays that lie in a file into the blocks of the noun that they are, a few rows of each at a time."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from kreisel.data.checks import increasing
from kreisel.data.tables import CONSTANTS, QUANTITIES
from kreisel.files.arrays import FOREIGN, SCHEMA, from_arrays
from kreisel.files.formats import Noun, ReadOptions

ROWS = 1 << 17
"""Rows of a block: what is made of them fits some hundred megabytes."""

# Constants have three of them; so few rows are no block.
_FEWEST = 10


class Member(Protocol):
    """An array in a file; rows are asked for in order, each once."""

    @property
    def shape(self) -> tuple[int, ...]:
        """As NumPy has it."""
        ...

    def __getitem__(self, rows: Any) -> Any:
        """Some rows, `[first:last]`, or all of it, `[()]`."""
        ...


def blocks_of(path: Path, members: Mapping[str, Member], options: ReadOptions) -> Iterator[Noun]:
    """What `from_arrays` makes of all members, block by block; whole where they are not laid out row by row."""
    columns = _columns(members)
    count = members[columns[0]].shape[0] if columns else 1
    constants = {name: member[()] for name, member in members.items() if name not in columns}
    boxes = (
        constants | {name: members[name][first : first + ROWS] for name in columns}
        for first in range(0, count, ROWS)
    )
    return following(path, boxes, options)


def following(path: Path, boxes: Iterable[dict[str, Any]], options: ReadOptions) -> Iterator[Noun]:
    """What `from_arrays` makes of each box; ValueError where one does not follow the one before in time."""
    before, first = np.empty(0), 0
    for box in boxes:
        with _counted_from(first):
            block = from_arrays(path, box, options)
        with _counted_from(first - 1):
            increasing(f"{path}: t", np.append(before, block.t[0]))
        before, first = block.t[-1:], first + len(block)
        yield block


def _columns(members: Mapping[str, Member]) -> list[str]:
    """The members with a row for every stamp, the stamps first; none where that is not clear."""
    if SCHEMA in members:
        t, names = "t", [name for name in QUANTITIES if name not in CONSTANTS]
    else:
        t = next((name for name in FOREIGN["t"] if name in members), "t")
        names = [name for known in FOREIGN.values() for name in known if known is not FOREIGN["rate_hz"]]
    names = [name for name in dict.fromkeys([t, *names]) if name in members]
    shapes = [members[name].shape for name in names]
    if t not in members or len(members[t].shape) != 1 or shapes[0][0] < _FEWEST:
        return []
    return names if all(shape[:1] == shapes[0] for shape in shapes) else []


@contextlib.contextmanager
def _counted_from(first: int) -> Iterator[None]:
    """Complaints about rows of a block name the row of the file; `first` is that of the block's first."""
    try:
        yield
    except ValueError as error:
        text = re.sub(r"\brow (\d+)", lambda match: f"row {int(match[1]) + first}", str(error))
        raise ValueError(text) from None
