"""Turns trials of the BROAD benchmark (MAT or HDF5: IMU, optical reference, movement) into a Trial.

The attitude of the reference is the sensor's in east, north, up, aligned with the magnetic field, so that its
heading is magnetic. A sample counts where the benchmark counts it: while the sensor moves, where the cameras
saw it. Poses are the rows in which the cameras saw position and attitude; they come on the IMU's stamps, interpolated
from cameras of 120 Hz.
Source: Laidig, Caruso, Cereatti, Seel: BROAD, Data 6 (7), 2021, doi 10.3390/data6070072.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np

from kreisel.data.attitude import Reference, mask
from kreisel.data.checks import Array, same_length, unit_quaternions
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.data.trial import Trial
from kreisel.files.formats import Noun, ReadOptions
from kreisel.maths.rotations import matrix_from_quat_wxyz

SUFFIX = None
HOLDS: tuple[type[Noun], ...] = ()
OPTIONS: frozenset[str] = frozenset()
KEEPS = "read only: IMU, reference attitude and which samples count, poses"

# Variable -> its columns; the mask may be a row or a column, the rate a number of any shape.
VARIABLES = {"imu_gyr": 3, "imu_acc": 3, "imu_mag": 3, "opt_quat": 4, "movement": 1, "sampling_rate": 1}
_OPTIONAL = {"opt_pos": 3}
_TELLING = (b"imu_gyr", b"imu_acc", b"imu_mag", b"opt_quat", b"opt_pos")

_HDF5 = b"\x89HDF\r\n\x1a\n"
_COMPRESSED, _MATRIX = 15, 14  # MAT 5 element types


def sniff(head: bytes) -> bool:
    """An HDF5 or MAT 5 file with the benchmark's variables."""
    if head.startswith(_HDF5):
        return sum(name in head for name in _TELLING) >= 2
    return head.startswith(b"MATLAB 5.0") and any(name in _TELLING for name in _variable_names(head))


def _variable_names(head: bytes) -> Iterator[bytes]:
    """Names of the variables whose elements start within the first bytes of a MAT 5 file.

    Source: MathWorks, MAT-File Format, chapter on level 5 files.
    """
    order: Literal["big", "little"] = "big" if head[126:128] == b"MI" else "little"
    at = 128
    while at + 8 <= len(head):
        kind, size = (int.from_bytes(head[k : k + 4], order) for k in (at, at + 4))
        start = head[at + 8 : at + 8 + 1024]
        if kind == _COMPRESSED:
            try:
                start = zlib.decompressobj().decompress(start, 256)[8:]
            except zlib.error:
                return
        elif kind != _MATRIX:
            return
        # The name follows the flags and the dimensions, padded with zeros.
        yield next((name for name in _TELLING if name in start[:128]), b"")
        at += 8 + size


def read(path: Path, options: ReadOptions) -> Trial:
    """IMU and reference on the same stamps, from t = 0; missing samples stay NaN, and do not count."""
    with path.open("rb") as stream:
        variables = _from_hdf5(path) if stream.read(8) == _HDF5 else _from_mat(path)
    try:
        columns = VARIABLES | {name: n for name, n in _OPTIONAL.items() if name in variables}
        return _trial(path.stem, {name: _shaped(name, n, variables) for name, n in columns.items()})
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None


def write(data: Noun, out: BinaryIO) -> None:
    """Refused: a benchmark is read."""
    raise ValueError("the format 'broad' is for reading the benchmark. Write csv, npz or mat instead.")


def _from_mat(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    try:
        return dict(loadmat(path, variable_names=list(VARIABLES | _OPTIONAL), appendmat=False))
    # SciPy's reader meets broken bytes with whatever error they lead it into.
    except Exception as error:
        raise ValueError(f"{path} is not a whole MAT file: it was cut off or damaged ({error}).") from None


def _from_hdf5(path: Path) -> dict[str, Any]:
    try:
        import h5py
    except ImportError:
        raise ValueError(
            f"{path} is an HDF5 file, which needs h5py: pip install 'kreisel[data]', or read the .mat."
        ) from None
    try:
        with h5py.File(path, "r") as file:
            found = {name: file[name][()] for name in VARIABLES | _OPTIONAL if name in file}
            # The benchmark's own files have the rate as an attribute.
            return {name: file.attrs[name] for name in VARIABLES if name in file.attrs} | found
    # As above, and with messages of several lines.
    except Exception as error:
        reason = str(error).partition("\n")[0]
        raise ValueError(f"{path} is not a whole HDF5 file: it was cut off or damaged ({reason}).") from None


def _shaped(name: str, columns: int, variables: dict[str, Any]) -> Any:
    if name not in variables:
        raise ValueError(f"variable {name!r} is missing; a trial of BROAD has {', '.join(VARIABLES)}.")
    value = np.asarray(variables[name])
    if columns == 1:
        return value.ravel()
    if value.ndim != 2 or value.shape[1] != columns:
        raise ValueError(f"variable {name!r} must be (n, {columns}); got {value.shape}.")
    return np.ascontiguousarray(value, dtype=np.float64)


def _trial(name: str, found: dict[str, Any]) -> Trial:
    rate_hz = float(found["sampling_rate"][0]) if found["sampling_rate"].size == 1 else np.nan
    if not 0.0 < rate_hz < np.inf:
        raise ValueError(
            f"variable 'sampling_rate' must be one positive number; got {found['sampling_rate']}."
        )
    t = np.arange(len(found["imu_gyr"])) / rate_hz
    same_length(t, **{key: value for key, value in found.items() if key != "sampling_rate"})
    seen = np.isfinite(found["opt_quat"]).all(axis=1)
    q_wxyz = np.full_like(found["opt_quat"], np.nan)
    q_wxyz[seen] = unit_quaternions("opt_quat", found["opt_quat"][seen])
    reference = Reference(
        t, matrix_from_quat_wxyz(q_wxyz), mask("movement", found["movement"]) & seen, name=name
    )
    recording = ImuRecording(t, found["imu_gyr"], found["imu_acc"], found["imu_mag"], name=name)
    return Trial(recording, reference, name, _poses(name, t, reference.R_NS, found.get("opt_pos")))


def _poses(name: str, t: Array, R_NS: Array, position: Array | None) -> Poses | None:
    """The rows in which the cameras saw position and attitude; None where there are none."""
    if position is None:
        return None
    seen = np.isfinite(position).all(axis=1) & np.isfinite(R_NS).all(axis=(1, 2))
    return Poses(t[seen], position[seen], R_NS[seen], name=name) if seen.any() else None
