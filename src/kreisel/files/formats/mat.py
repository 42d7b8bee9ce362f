"""Turns every noun into MATLAB's MAT files (version 5) and back; what MATLAB users save is understood too.

Matrices are pages as MATLAB has them: R_NB and R_NS are 3 x 3 x n. A stranger's file may name its variables t, s
and phi (rad), or gyro and accel, and others listed in the formats page.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import CONSTANTS
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import SCHEMA, from_arrays, to_arrays
from kreisel.files.formats import Noun, ReadOptions

SUFFIX = ".mat"
HOLDS = (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
OPTIONS = frozenset({"rate_hz"})
KEEPS = "every bit of every field"

_PAGES = {"R_NB", "R_NS"}
_COLUMNS = {"t", "rest", "disturbed", "held", "counts", *CONSTANTS}


def sniff(head: bytes) -> bool:
    """MATLAB's line of text, of any version."""
    return head.startswith(b"MATLAB ")


def read(path: Path, options: ReadOptions) -> Noun:
    """The noun named in the file's schema, or what its variables suggest."""
    from scipy.io import loadmat

    with path.open("rb") as stream:
        head = stream.read(128)
    if head.startswith(b"MATLAB 7.3"):
        raise ValueError(f"{path} is a MAT file of version 7.3 (HDF5). Save it again with save(..., '-v7').")
    if not head.startswith(b"MATLAB 5.0"):
        raise ValueError(f"{path} is no MAT file of version 5: it does not start with 'MATLAB 5.0'.")
    try:
        variables = loadmat(path, appendmat=False)
    # SciPy's reader meets broken bytes with whatever error they lead it into.
    except Exception as error:
        if isinstance(error, MemoryError | OSError) and getattr(error, "errno", None):
            raise
        raise ValueError(f"{path} is not a whole MAT file: it was cut off or damaged ({error}).") from None
    if SCHEMA in variables:
        variables = {name: _ours(name, value) for name, value in variables.items()}
    return from_arrays(path, variables, options)


def write(data: Noun, out: BinaryIO) -> None:
    """Variables under our names: time and vectors as columns, rotation matrices as pages."""
    from scipy.io import savemat

    variables = to_arrays(data)
    for name in _PAGES & variables.keys():
        variables[name] = np.moveaxis(variables[name], 0, -1)
    savemat(out, {name: _as_matlab(value) for name, value in variables.items()}, oned_as="column")


def _as_matlab(value: Any) -> Any:
    return str(value) if value.dtype.kind == "U" else value


def _ours(name: str, value: Any) -> Any:
    if name in _COLUMNS:
        return np.asarray(value).ravel()
    return np.moveaxis(value, -1, 0) if name in _PAGES and np.ndim(value) == 3 else value
