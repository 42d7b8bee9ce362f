"""Turns every noun into NumPy's archive of arrays and back, to the bit; nothing in it is executable."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.archive import arrays_in
from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.arrays import from_arrays, to_arrays
from kreisel.files.formats import Noun, ReadOptions

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


def write(data: Noun, out: BinaryIO) -> None:
    """An uncompressed archive: sensor noise does not compress."""
    np.savez(out, allow_pickle=False, **to_arrays(data))
