"""Turns every noun into NumPy's archive of arrays and back, to the bit; nothing in it is executable."""

from __future__ import annotations

import contextlib
import math
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from kreisel.data.archive import BROKEN, NOT_WHOLE, arrays_in
from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import from_arrays, to_arrays
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.members import blocks_of
from kreisel.files.spool import write_archive

SUFFIX = ".npz"
HOLDS = (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
OPTIONS = frozenset({"rate_hz"})
_NPY = b"\x93NUMPY"
KEEPS = "every bit of every field"


def sniff(head: bytes) -> bool:
    """A zip archive whose first member is an array."""
    return head.startswith(b"PK\x03\x04") and b".npy" in head[:200]


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun named in the archive's schema, or what its array names suggest."""
    with path.open("rb") as stream:
        if stream.read(len(_NPY)) == _NPY:
            raise ValueError(
                f"{path} is one bare array (.npy), not an archive of named ones. Save those with numpy.savez."
            )
    try:
        arrays = arrays_in(path)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return from_arrays(path, arrays, options)


def blocks(path: Path, options: ReadOptions) -> Iterator[Noun]:
    """The same, block by block."""
    try:
        archive = zipfile.ZipFile(path)
    except zipfile.BadZipFile:
        yield read(path, options)  # which says what is wrong
        return
    with archive:
        members = {name.removesuffix(".npy"): _Member(path, archive, name) for name in archive.namelist()}
        if all(member.plain for member in members.values()):
            yield from blocks_of(path, members, options)
        else:
            yield read(path, options)


class _Member:
    """One array of an archive, compressed or not, row by row."""

    def __init__(self, path: Path, archive: zipfile.ZipFile, name: str) -> None:
        self._path, self._stream = path, archive.open(name)
        self.plain = False
        self.shape: tuple[int, ...] = ()
        with contextlib.suppress(*BROKEN):
            version = np.lib.format.read_magic(self._stream)
            header = {
                (1, 0): np.lib.format.read_array_header_1_0,
                (2, 0): np.lib.format.read_array_header_2_0,
            }
            self.shape, by_columns, self._dtype = header[version](self._stream)
            self.plain = not (by_columns and len(self.shape) > 1) and not self._dtype.hasobject

    def __getitem__(self, rows: Any) -> npt.NDArray[Any]:
        shape = self.shape if rows == () else (min(rows.stop, self.shape[0]) - rows.start, *self.shape[1:])
        size = math.prod(shape) * self._dtype.itemsize
        try:
            data = self._stream.read(size)
        except BROKEN:
            data = b""
        if len(data) < size:
            raise ValueError(f"{self._path}: {NOT_WHOLE}")
        return np.frombuffer(data, self._dtype).reshape(shape)


def write(data: Noun, out: BinaryIO) -> None:
    """An uncompressed archive: sensor noise does not compress."""
    np.savez(out, allow_pickle=False, **to_arrays(data))


def write_blocks(blocks: Iterable[Noun], out: BinaryIO) -> None:
    """The same of what comes block by block; columns wait on disk until they are whole."""
    write_archive(map(to_arrays, blocks), out)
