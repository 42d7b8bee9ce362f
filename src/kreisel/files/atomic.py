"""Turns a writing function into a whole file or none: a temporary name in the same folder, then a rename."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A binary stream whose bytes appear under `path` when the block ends, all of them or none.

    An error or Ctrl-C inside the block leaves `path` as it was and no temporary file behind.
    Raises OSError with one sentence that names the file and the cause.
    """
    final = Path(os.path.realpath(path))
    if final.exists() and not final.is_file() and not final.is_dir():
        # A device or a pipe (/dev/stdout) has no half-written state and must not be replaced by a file.
        with final.open("wb") as stream:
            yield stream
        return
    temporary = final.with_name(f".{final.name}.{secrets.token_hex(4)}.part")
    try:
        with temporary.open("xb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(final)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError) and error.errno is not None:
            raise _explained(error, Path(path), final) from error
        raise


def _explained(error: OSError, path: Path, final: Path) -> OSError:
    """The same kind of error, its text a sentence for whoever asked for the file."""
    folder = final.parent
    if not folder.exists():
        return type(error)(f"cannot write {path}: the folder {folder} does not exist. Create it first.")
    if not folder.is_dir():
        return type(error)(f"cannot write {path}: {folder} is a file, not a folder.")
    if final.is_dir():
        return type(error)(f"cannot write {path}: it is a folder. Give a file name.")
    if isinstance(error, PermissionError):
        return type(error)(f"cannot write {path}: the folder {folder} is not writable. Choose another one.")
    return type(error)(f"cannot write {path}: {error.strerror}. Nothing was left under that name.")
