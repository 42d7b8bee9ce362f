"""Turns a figure into a file that is either complete or not there."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf")


def save(figure: Figure, path: str | os.PathLike[str]) -> Path:
    """Write `figure` to `path` as PNG, SVG or PDF, by its suffix; the same figure gives the same bytes.

    The file appears under its name only when it is complete; one that stood there before is replaced.
    Raises ValueError for another suffix or a folder that does not exist.
    """
    from matplotlib import rc_context

    target = writable(path, PICTURES)
    # Dates and random ids would make every file differ from the last.
    metadata: dict[str, dict[str, Any]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with rc_context({"svg.hashsalt": "kreisel"}), complete_or_absent(target) as unfinished:
        figure.savefig(
            unfinished, format=target.suffix.lower()[1:], metadata=metadata.get(target.suffix.lower())
        )
    return target


def writable(path: str | os.PathLike[str], suffixes: Sequence[str]) -> Path:
    """`path` as a Path when it ends in one of `suffixes` and its folder exists, else a ValueError."""
    target = Path(path)
    if target.suffix.lower() not in suffixes:
        got = f"the suffix {target.suffix!r}" if target.suffix else "no suffix"
        raise ValueError(f"{target.name!r} has {got}; name the file {' or '.join(suffixes)}.")
    if not target.parent.is_dir():
        raise ValueError(f"There is no folder {str(target.parent)!r} for {target.name!r}; make it first.")
    return target


@contextmanager
def complete_or_absent(target: Path) -> Iterator[Path]:
    """A temporary name beside `target`, renamed to it at the end, or removed when the block raises."""
    handle, name = tempfile.mkstemp(prefix=f".{target.name}.", suffix=target.suffix, dir=target.parent)
    os.close(handle)
    unfinished = Path(name)
    try:
        yield unfinished
        # mkstemp makes files for their owner alone; a picture has the rights any new file has.
        unfinished.chmod(0o666 & ~_umask())
        os.replace(unfinished, target)
    finally:
        unfinished.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
