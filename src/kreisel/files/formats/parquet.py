"""Turns every noun into Parquet tables, a column for each component with its unit and frame, and back, to the bit.

Rotation matrices are nine columns, R_xx to R_zz. Tables of others, those of `to_pandas` too, are read by the names of
their columns, as csv files are.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import AXES, CONSTANTS, INCREMENTS, QUANTITIES, at_ends
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import SCHEMA, from_arrays, to_arrays
from kreisel.files.columns import GROUPS, bind
from kreisel.files.extras import library
from kreisel.files.formats import Noun, ReadOptions

SUFFIX = ".parquet"
HOLDS = (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
OPTIONS = frozenset({"columns", "rate_hz"})
KEEPS = "every bit of every field"

_MATRIX = tuple(f"{row}{column}" for row in AXES for column in AXES)
# What is read from a stranger's columns -> what from_arrays knows it by.
_BOX = {"t": "t", "p": "p_NB", "q": "quat_wxyz", "phi": "phi", "v": "v_NB", "gyro": "gyro", "accel": "accel"}
_BOX |= {"mag": "mag_uT", "dtheta": "dtheta", "dv": "dv", "dp": "dp"}


def sniff(head: bytes) -> bool:
    """Parquet's magic bytes."""
    return head.startswith(b"PAR1")


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun named in the file's schema, or what its columns suggest."""
    parquet = library("pyarrow.parquet", "data", f"{path} is a Parquet file, which")
    try:
        table = parquet.read_table(path)
        arrays = {name: table[name].to_numpy() for name in table.column_names}
        about = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
    except Exception as error:
        reason = str(error).partition("\n")[0]
        raise ValueError(
            f"{path} is not a whole Parquet file: it was cut off or damaged ({reason})."
        ) from None
    return from_arrays(
        path, _ours(arrays, about) if SCHEMA in about else _theirs(path, arrays, options), options
    )


def write(data: Noun, out: BinaryIO) -> None:
    """The table, its columns with the metadata unit and frame; one value for all rows is metadata of the table."""
    pyarrow = library("pyarrow", "data", "writing Parquet")
    parquet = library("pyarrow.parquet", "data", "writing Parquet")
    fields, columns, about = [], [], {}
    for name, array in to_arrays(data).items():
        if name not in QUANTITIES or name in CONSTANTS:
            # Python's text of a float reads back to the same bits.
            about[name] = " ".join(map(str, np.atleast_1d(array).tolist()))
            continue
        quantity = QUANTITIES[name]
        for label, column in _columns(quantity.column, at_ends(name, array)):
            columns.append(pyarrow.array(column))
            metadata = {"unit": quantity.unit, "frame": quantity.frame}
            fields.append(pyarrow.field(label, columns[-1].type, nullable=False, metadata=metadata))
    table = pyarrow.Table.from_arrays(columns, schema=pyarrow.schema(fields, metadata=about))
    parquet.write_table(table, out)


def _columns(stem: str, array: npt.NDArray[Any]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    if array.ndim == 1:
        yield stem, array
        return
    names = AXES if array.ndim == 2 else _MATRIX
    for name, column in zip(names, array.reshape(len(array), -1).T, strict=True):
        yield f"{stem}_{name}", np.ascontiguousarray(column)


def _ours(columns: dict[str, Any], about: dict[str, str]) -> dict[str, Any]:
    """The box of arrays that `write` took apart; what is missing stays so, for from_arrays to say it."""
    arrays: dict[str, Any] = dict(about)
    for name in about[SCHEMA].partition(": ")[2].split():
        stem = QUANTITIES[name].column if name in QUANTITIES else name
        if name in CONSTANTS and name in about:
            arrays[name] = np.array(about[name].split(), dtype=np.float64)
        for parts, shape in (("",), (-1,)), (AXES, (-1, 3)), (_MATRIX, (-1, 3, 3)):
            labels = [f"{stem}_{part}".rstrip("_") for part in parts]
            if all(label in columns for label in labels):
                arrays[name] = np.stack([columns[label] for label in labels], axis=1).reshape(shape)
    # The row of the first stamp ends no interval.
    return arrays | {name: arrays[name][1:] for name in INCREMENTS if name in arrays}


def _theirs(path: Path, columns: dict[str, Any], options: ReadOptions) -> dict[str, Any]:
    """The box of arrays whose columns have our names, or names others commonly use, in our units."""
    found = bind(str(path), list(columns), options.columns)
    headers = list(columns)
    box = {}
    for group, name in _BOX.items():
        parts = GROUPS[group][0]
        if parts[0] in found:
            values = [
                found[part].scale(np.asarray(columns[headers[found[part].index]], float)) for part in parts
            ]
            box[name] = values[0] if name == "t" else np.column_stack(values)
            if name in INCREMENTS and np.isnan(box[name][:1]).all():
                box[name] = box[name][1:]
    return box
