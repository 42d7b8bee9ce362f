"""Turns blocks of a noun into whole columns on disk, for formats that store one column after the other."""

from __future__ import annotations

import contextlib
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from kreisel.data.tables import CONSTANTS

_PIECE = 1 << 22  # bytes


class Column:
    """One array (n, ...) whose rows come in order, in a file without a name."""

    def __init__(self, like: npt.NDArray[Any], file: Any) -> None:
        self.dtype, self._row, self._rows, self._file = like.dtype, like.shape[1:], 0, file

    @property
    def shape(self) -> tuple[int, ...]:
        """Of all rows so far."""
        return (self._rows, *self._row)

    def add(self, array: npt.NDArray[Any]) -> None:
        """Put rows at the end."""
        self._file.write(np.ascontiguousarray(array, self.dtype).data.cast("B"))
        self._rows += len(array)

    def mapped(self) -> npt.NDArray[Any]:
        """All rows, read where they are when they are looked at; the file may be closed."""
        self._file.flush()
        return np.memmap(self._file, self.dtype, "r", shape=self.shape)

    def pieces(self) -> Iterator[npt.NDArray[Any]]:
        """All rows, a few at a time."""
        self._file.seek(0)
        width = self.dtype.itemsize * int(np.prod(self._row))
        while data := self._file.read(max(1, _PIECE // width) * width):
            yield np.frombuffer(data, self.dtype).reshape(-1, *self._row)


def temporary_file(out: BinaryIO) -> IO[bytes]:
    """A file without a name beside the file `out`: the folder for temporary files may be small, or memory."""
    name = getattr(out, "name", None)
    return TemporaryFile(dir=Path(name).parent if isinstance(name, str) else None)


@contextlib.contextmanager
def columns_of(
    blocks: Iterable[dict[str, npt.NDArray[Any]]], out: BinaryIO
) -> Iterator[dict[str, npt.NDArray[Any] | Column]]:
    """The arrays whose rows come in `blocks` as columns; what is one for all rows as the last block has it.

    They take as much disk as the file `out` will, beside it. ValueError where a block has other fields than the first.
    """
    found: dict[str, npt.NDArray[Any] | Column] = {}
    with contextlib.ExitStack() as files:
        for block in blocks:
            if found and block.keys() != found.keys():
                odd = ", ".join(sorted(block.keys() ^ found.keys()))
                raise ValueError(f"blocks must have the same fields; {odd} is in some only.")
            for key, array in block.items():
                if array.ndim == 0 or key in CONSTANTS:
                    found[key] = array
                elif key not in found:
                    found[key] = Column(array, files.enter_context(temporary_file(out)))
                if isinstance(column := found[key], Column):
                    column.add(array)
        yield found


def write_archive(blocks: Iterable[dict[str, npt.NDArray[Any]]], out: BinaryIO) -> None:
    """The bytes that `numpy.savez` makes of all blocks together."""
    with columns_of(blocks, out) as arrays, zipfile.ZipFile(out, "w") as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                if not isinstance(array, Column):
                    np.lib.format.write_array(member, array, allow_pickle=False)
                    continue
                descr = np.lib.format.dtype_to_descr(array.dtype)
                header = {"descr": descr, "fortran_order": False, "shape": array.shape}
                np.lib.format.write_array_header_1_0(member, header)
                for piece in array.pieces():
                    member.write(piece.data.cast("B"))
