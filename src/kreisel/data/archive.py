"""Turns an NPZ archive into its arrays; what is cut off, of another kind or pickled is refused."""

from __future__ import annotations

import os
import zipfile
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

# All that NumPy and zipfile raise where bytes are not those of an archive of plain arrays.
BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    KeyError,
    ValueError,
    AttributeError,
    NotImplementedError,
)

NOT_WHOLE = (
    "it is no whole NPZ archive of plain arrays: it was cut off, is of another kind, or holds pickled "
    "objects, which are never loaded."
)


def arrays_in(path: str | os.PathLike[str]) -> dict[str, npt.NDArray[Any]]:
    """Every array of the archive by its name.

    Raises ValueError, whose text follows the name of the file, where it is no whole archive of plain arrays.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except BROKEN:
        raise ValueError(NOT_WHOLE) from None
