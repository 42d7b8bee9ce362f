"""Turns every noun into HDF5 files of named arrays, each with its unit and frame, and back, to the bit.

Files of others are read by the names of their arrays at the top level, as NPZ files are.
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import QUANTITIES
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import from_arrays, refuse_inflated, to_arrays
from kreisel.files.extras import library
from kreisel.files.formats import Noun, ReadOptions

SUFFIX = ".h5"
HOLDS = (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
OPTIONS = frozenset({"rate_hz"})
KEEPS = "every bit of every field"

MAGIC = b"\x89HDF\r\n\x1a\n"
_TEXT = np.dtype(object)  # also what stands in for groups, which have no type
NETCDF_MARK = b"_NCProperties"  # an attribute every netCDF library leaves in its files


def sniff(head: bytes) -> bool:
    """HDF5, and not netCDF built on it."""
    return head.startswith(MAGIC) and NETCDF_MARK not in head


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun named in the file's schema, or what its names suggest."""
    return from_arrays(path, load(path, "HDF5")[0], options)


def load(path: Path, kind: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """(arrays, attributes) at the top level of a file built on HDF5; ValueError where it is not whole.

    kind : what the file calls itself, for complaints.
    """
    h5py = library("h5py", "data", f"{path} is {'an' if kind == 'HDF5' else 'a'} {kind} file, which")
    try:
        with h5py.File(path, "r") as file:
            # Texts of any length lie in a heap of their own, of which damage can send the library in circles.
            items = {name: item for name, item in file.items() if getattr(item, "dtype", _TEXT).kind != "O"}
            texts = [name for name in file.attrs if file.attrs.get_id(name).dtype.kind != "O"]
            refuse_inflated(path, sum(item.nbytes for item in items.values()))
            return {name: _value(item[()]) for name, item in items.items()}, {
                name: _value(file.attrs[name]) for name in texts
            }
    # HDF5 meets broken bytes with whatever error they lead it into, in several lines.
    except Exception as error:
        reason = str(error).partition("\n")[0]
        raise ValueError(
            f"{path} is not a whole {kind} file: it was cut off or damaged ({reason})."
        ) from None


def _value(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value


def write(data: Noun, out: BinaryIO) -> None:
    """One dataset per field, with the attributes units, frame and long_name."""
    h5py = library("h5py", "data", "writing HDF5")
    # HDF5 reads what it writes, which `out` need not allow.
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        for name, array in to_arrays(data).items():
            item = file.create_dataset(
                name, data=np.bytes_(str(array).encode()) if array.dtype.kind == "U" else array
            )
            if name in QUANTITIES:
                quantity = QUANTITIES[name]
                item.attrs.update(units=quantity.unit, frame=quantity.frame, long_name=quantity.meaning)
    out.write(buffer.getbuffer())
