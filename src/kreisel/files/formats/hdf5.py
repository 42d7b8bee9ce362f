"""Turns every noun into HDF5 files of named arrays, each with its unit and frame, and back, to the bit.

Files of others are read by the names of their arrays at the top level, as NPZ files are.
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import QUANTITIES
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import from_arrays, to_arrays
from kreisel.files.extras import library
from kreisel.files.formats import Noun, ReadOptions

SUFFIX = ".h5"
HOLDS = (Poses, Motion, ImuRecording, AttitudeHistory, Reference)
OPTIONS = frozenset({"rate_hz"})
KEEPS = "every bit of every field"

MAGIC = b"\x89HDF\r\n\x1a\n"
NETCDF_MARK = b"_NCProperties"  # an attribute every netCDF library leaves in its files


def sniff(head: bytes) -> bool:
    """HDF5, and not netCDF built on it."""
    return head.startswith(MAGIC) and NETCDF_MARK not in head


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun named in the file's schema, or what its names suggest."""
    h5py = library("h5py", "data", f"{path} is an HDF5 file, which")
    try:
        with h5py.File(path, "r") as file:
            arrays = {name: _value(item) for name, item in file.items() if isinstance(item, h5py.Dataset)}
    # HDF5 meets broken bytes with whatever error they lead it into, in several lines.
    except Exception as error:
        reason = str(error).partition("\n")[0]
        raise ValueError(f"{path} is not a whole HDF5 file: it was cut off or damaged ({reason}).") from None
    return from_arrays(path, arrays, options)


def _value(item: Any) -> Any:
    return item.asstr()[()] if item.dtype.kind == "O" else item[()]


def write(data: Noun, out: BinaryIO) -> None:
    """One dataset per field, with the attributes units, frame and long_name."""
    h5py = library("h5py", "data", "writing HDF5")
    # HDF5 reads what it writes, which `out` need not allow.
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        for name, array in to_arrays(data).items():
            item = file.create_dataset(name, data=str(array) if array.dtype.kind == "U" else array)
            if name in QUANTITIES:
                quantity = QUANTITIES[name]
                item.attrs.update(units=quantity.unit, frame=quantity.frame, long_name=quantity.meaning)
    out.write(buffer.getbuffer())
