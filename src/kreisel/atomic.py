"""Turns a writing block into a whole file, or folder, or none: a temporary name beside it, then a rename."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import IO, BinaryIO

PathLike = str | os.PathLike[str]

_IN_MEMORY = 1 << 24  # bytes for a pipe that are kept there; more wait on disk


def replacing(path: PathLike) -> AbstractContextManager[BinaryIO]:
    """A binary stream whose bytes appear under `path` when the block ends, all of them or none.

    An error or Ctrl-C inside the block leaves `path` as it was and no temporary file behind. What is no file,
    such as a pipe or /dev/stdout, is written to at the end of the block and not replaced.
    Raises OSError with one sentence that names the file, the cause and the cure.
    """
    refuse_unwritable(path)
    return _through(Path(path)) if _writes_through(path) else _whole(Path(path))


@contextlib.contextmanager
def new_folder(path: PathLike) -> Iterator[Path]:
    """The path of a folder to make, which appears as `path` when the block ends; its own name is the same.

    An error or Ctrl-C inside the block leaves nothing behind. A folder that is there already is never replaced.
    Raises OSError with one sentence that names the folder, the cause and the cure.
    """
    final = Path(os.path.realpath(path))
    if final.exists():
        raise FileExistsError(f"cannot write {path}: it exists already. Choose another name or remove it.")
    if not final.parent.is_dir():
        raise FileNotFoundError(
            f"cannot write {path}: the folder {final.parent} does not exist. Create it first."
        )
    around = final.with_name(f".{final.name}.{secrets.token_hex(4)}.part")
    try:
        around.mkdir()
        yield around / final.name
        (around / final.name).rename(final)
    except OSError as error:
        if error.errno is None:
            raise
        raise _explained(error, Path(path), final.parent) from error
    finally:
        shutil.rmtree(around, ignore_errors=True)


def refuse_unwritable(path: PathLike) -> None:
    """Raise the OSError that `replacing` would, as far as that can be known before."""
    obstacle = _obstacle(path, Path(os.path.realpath(path)))
    if obstacle is not None and not _writes_through(path):
        raise obstacle


def is_standard_output(path: PathLike) -> bool:
    """Whether `path`, such as /dev/stdout, is where this process prints to."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(1))
    except OSError:
        return False


def _writes_through(path: PathLike) -> bool:
    # Not of the resolved name: a pipe behind /dev/stdout has none.
    place = Path(path)
    special = place.exists() and not place.is_file() and not place.is_dir()
    return special or is_standard_output(path)


@contextlib.contextmanager
def _through(path: Path) -> Iterator[BinaryIO]:
    # Kept until the end: archives want to seek, and half a file is no better in a pipe.
    with SpooledTemporaryFile(_IN_MEMORY) as buffer:
        yield buffer  # type: ignore[misc]  # which has all a stream has
        _pour(buffer, path)


def _pour(buffer: IO[bytes], path: Path) -> None:
    buffer.seek(0)
    try:
        if is_standard_output(path):
            sys.stdout.flush()
            stream = os.fdopen(os.dup(1), "wb")
        else:
            stream = path.open("wb")
        with stream:
            shutil.copyfileobj(buffer, stream, 1 << 20)
    except BrokenPipeError:
        raise
    except OSError as error:
        raise type(error)(f"cannot write {path}: {error.strerror}.") from error


@contextlib.contextmanager
def _whole(path: Path) -> Iterator[BinaryIO]:
    final = Path(os.path.realpath(path))
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
            raise _explained(error, path, final.parent) from error
        raise


def _obstacle(path: PathLike, final: Path) -> OSError | None:
    """Why nothing can be written under a name, as far as it shows from outside."""
    named, folder = f"cannot write {os.fspath(path)}", final.parent
    if os.fspath(path).endswith((os.sep, os.altsep or os.sep)):
        return IsADirectoryError(f"{named}: it is the name of a folder. Give a file name.")
    if final.is_dir():
        return IsADirectoryError(f"{named}: it is a folder. Give a file name.")
    if folder.exists() and not folder.is_dir():
        return NotADirectoryError(f"{named}: {folder} is a file, not a folder.")
    if not folder.exists():
        return FileNotFoundError(f"{named}: the folder {folder} does not exist. Create it first.")
    # A rename asks the folder alone; whoever took the rights from a file meant it to stay. The mode counts for
    # an administrator too.
    if final.is_file() and not (os.access(final, os.W_OK) and final.stat().st_mode & 0o222):
        return PermissionError(f"{named}: the file is write-protected. Choose another name or unprotect it.")
    return None


def _explained(error: OSError, path: Path, folder: Path) -> OSError:
    """The same kind of error, its text a sentence for whoever asked for the file."""
    if isinstance(error, PermissionError):
        return type(error)(f"cannot write {path}: the folder {folder} is not writable. Choose another one.")
    return type(error)(f"cannot write {path}: {error.strerror}. Nothing was left under that name.")
