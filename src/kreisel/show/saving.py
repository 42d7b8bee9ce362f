"""Turns a figure into a file that is either complete or not there."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.atomic import refuse_unwritable, replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf")


def save(figure: Figure, path: str | os.PathLike[str]) -> Path:
    """Write `figure` to `path` as PNG, SVG or PDF, by its suffix; the same figure gives the same bytes.

    The file appears under its name only when it is complete; one that stood there before is replaced.
    Raises ValueError for another suffix, OSError for a place that cannot be written.
    """
    from matplotlib import rc_context

    target = writable(path, PICTURES)
    kind = target.suffix.lower()
    # Dates and random ids would make every file differ from the last.
    metadata: dict[str, dict[str, Any]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with rc_context({"svg.hashsalt": "kreisel"}), drawn_whole(target) as drawing:
        figure.savefig(drawing, format=kind[1:], metadata=metadata.get(kind))
    return target


def writable(path: str | os.PathLike[str], suffixes: Sequence[str]) -> Path:
    """`path` as a Path when it ends in one of `suffixes`, else a ValueError; OSError where nothing can be written."""
    target = Path(path)
    if target.suffix.lower() not in suffixes:
        got = f"the suffix {target.suffix!r}" if target.suffix else "no suffix"
        raise ValueError(f"{target.name!r} has {got}; name the file {' or '.join(suffixes)}.")
    refuse_unwritable(path)
    return target


@contextmanager
def drawn_whole(target: Path) -> Iterator[io.BytesIO]:
    """A stream to draw into, written to `target` when the block ends without an error."""
    # In memory first: the encoders of pictures write past the stream and tell a full disk by a number of theirs.
    drawing = io.BytesIO()
    yield drawing
    with replacing(target) as out:
        out.write(drawing.getbuffer())
