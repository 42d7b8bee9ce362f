"""Turns every noun into netCDF files, which are what `to_xarray` gives on disk, and back, to the bit.

Files of others are read by the names of their variables, as NPZ files are.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, BinaryIO, Literal

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import SCHEMA, from_arrays, refuse_inflated, to_arrays
from kreisel.files.extras import library
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.formats.hdf5 import MAGIC, NETCDF_MARK, load

SUFFIX = ".nc"
HOLDS = (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
OPTIONS = frozenset({"rate_hz"})
KEEPS = "every bit of every field"

_ENGINE: Literal["h5netcdf"] = "h5netcdf"
_CLASSIC = (b"CDF\x01", b"CDF\x02")


def sniff(head: bytes) -> bool:
    """HDF5 with the mark of netCDF, or netCDF of the classic kind."""
    return (head.startswith(MAGIC) and NETCDF_MARK in head) or head.startswith(_CLASSIC)


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun named in the file's schema, or what its names suggest."""
    with path.open("rb") as stream:
        classic = stream.read(4) in _CLASSIC
    arrays, attributes = _classic(path) if classic else load(path, "netCDF")
    if SCHEMA in attributes:
        # In the box of arrays they are arrays; in netCDF, attributes of the whole.
        arrays |= {name: np.asarray(value) for name, value in attributes.items()}
    return from_arrays(path, arrays, options)


def _classic(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """(arrays, attributes) of a stranger's file of version 3."""
    from scipy.io import netcdf_file

    try:
        with netcdf_file(path, "r", mmap=False) as file:
            refuse_inflated(path, sum(each.data.nbytes for each in file.variables.values()))
            return {name: each.data.copy() for name, each in file.variables.items()}, {}
    except Exception as error:
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise ValueError(
            f"{path} is not a whole netCDF file: it was cut off or damaged ({reason})."
        ) from None


def write(data: Noun, out: BinaryIO) -> None:
    """The dataset of `to_xarray`, and the schema that lists its variables as an attribute."""
    library("xarray", "data", "writing netCDF")
    library(_ENGINE, "data", "writing netCDF")
    dataset = data.to_xarray()
    # As bytes, which netCDF keeps as plain characters: `load` passes over texts of any length.
    texts = {name: str(value) for name, value in to_arrays(data).items() if value.dtype.kind == "U"}
    dataset.attrs |= {name: np.bytes_(text.encode()) for name, text in texts.items()}
    # A NaN is no filling here but a sample that is missing, which needs no mark.
    encoding: Any = {name: {"_FillValue": None} for name in dataset.variables}
    with TemporaryDirectory() as folder:
        file = Path(folder) / "kreisel.nc"
        dataset.to_netcdf(file, engine=_ENGINE, encoding=encoding)
        out.write(file.read_bytes())
