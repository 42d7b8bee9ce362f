"""Turns nouns into named arrays with a schema, and named arrays, ours or a stranger's, into nouns.

NPZ and MAT files are both boxes of named arrays; what the names mean is settled here once.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.checks import Array, choice, radians, unit_quaternions
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Note
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import INCREMENTS
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions
from kreisel.maths.rotations import matrix_from_euler, matrix_from_quat_wxyz

SCHEMA = "kreisel_schema"
VERSION = 1
NOUNS: dict[str, type[Noun]] = {
    noun.__name__: noun for noun in (Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference)
}

# What others call our arrays, in the order of preference. s and phi are the names of the source
# document's MATLAB tool; imu_* those of the BROAD recordings.
FOREIGN: dict[str, tuple[str, ...]] = {
    "t": ("t", "time", "Time", "timestamps"),
    "p_NB": ("p_NB", "p", "s", "pos", "position", "positions"),
    "R_NB": ("R_NB", "R_NS"),
    "quat_wxyz": ("quat_wxyz", "q_NB_wxyz", "q_NS_wxyz", "quat", "q", "quaternion"),
    "phi": ("phi", "euler"),
    "orientation": ("orientation", "Orientation"),
    "v_NB": ("v_NB", "v", "vel", "velocity"),
    "gyro": ("gyro", "gyr", "imu_gyr"),
    "accel": ("accel", "acc", "imu_acc"),
    "mag_uT": ("mag_uT", "mag", "imu_mag"),
    "dtheta": ("dtheta", "delta_theta", "delta_angle"),
    "dv": ("dv", "delta_v", "delta_velocity"),
    "dp": ("dp",),
    "rate_hz": ("rate_hz", "sampling_rate", "fs", "Fs"),
}
_NEEDED = {"poses": {"p_NB"}, "imu": {"gyro", "accel"}, "increments": {"dtheta", "dv"}}
_CALLED = {"poses": "positions", "imu": "IMU data", "increments": "increments"}
_WIDTHS = {"p_NB": 3, "phi": 3, "v_NB": 3, "gyro": 3, "accel": 3, "mag_uT": 3, "quat_wxyz": 4}
_WIDTHS |= dict.fromkeys(INCREMENTS, 3)


def to_arrays(data: Noun) -> dict[str, npt.NDArray[Any]]:
    """Every field under its own name, led by a schema line that lists them all."""
    arrays: dict[str, npt.NDArray[Any]] = {}
    for field in dataclasses.fields(data):
        value = getattr(data, field.name)
        if field.name == "notes":
            arrays["notes"] = np.array(json.dumps([dataclasses.asdict(note) for note in value]))
        elif field.name == "t0_ns":
            arrays["t0_ns"] = np.array(value, dtype=np.int64)
        elif value is not None:
            arrays[field.name] = np.asarray(value)
    # The list lets a reader tell a file that was cut between two arrays from a smaller noun.
    line = f"{type(data).__name__} {VERSION}: {' '.join(arrays)}"
    return {SCHEMA: np.array(line), **arrays}


def from_arrays(path: Path, arrays: Mapping[str, Any], options: ReadOptions) -> Noun:
    """The noun in a box of arrays; ValueError with file and variable where it is not sound."""
    try:
        if SCHEMA in arrays:
            return _ours(path, arrays)
        return _foreign(path, arrays, options)
    except (ValueError, TypeError) as error:
        text = str(error)
        raise ValueError(text if text.startswith(str(path)) else f"{path}: {text}") from None


def refuse_inflated(path: Path, nbytes: int) -> None:
    """ValueError where arrays of `nbytes` cannot come out of a file of that size: a number in it is damaged.

    Deflate, the strongest compression in use, packs 1032 bytes into one.
    """
    if nbytes > 1032 * path.stat().st_size:
        raise ValueError(f"its arrays would take {nbytes:.3g} bytes")


def _text(value: Any) -> str:
    flat = np.asarray(value).ravel()
    return str(flat[0]) if flat.size else ""


def _ours(path: Path, arrays: Mapping[str, Any]) -> Noun:
    kind, _, names = _text(arrays[SCHEMA]).partition(": ")
    noun, _, version = kind.partition(" ")
    if not version.isdigit() or int(version) > VERSION:
        raise ValueError(f"written with schema {kind!r}; this version of kreisel reads up to {VERSION}.")
    choice("the noun of the file", noun, list(NOUNS))
    wanted = dict.fromkeys([*names.split(), "t0_ns", "name"])
    missing = [name for name in wanted if name not in arrays]
    if missing:
        raise ValueError(f"array {missing[0]!r} is missing: the file was cut off or edited.")
    values: dict[str, Any] = {name: arrays[name] for name in wanted}
    values["t0_ns"] = int(np.asarray(values["t0_ns"]).ravel()[0])
    values["name"] = _text(values["name"])
    if "notes" in values:
        values["notes"] = tuple(Note(**note) for note in json.loads(_text(values["notes"])))
    return NOUNS[noun](**values)


def _foreign(path: Path, arrays: Mapping[str, Any], options: ReadOptions) -> Noun:
    found: dict[str, Array] = {}
    for ours, theirs in FOREIGN.items():
        name = next((name for name in theirs if name in arrays), None)
        if name is not None:
            found[ours] = _rows(name, arrays[name], _WIDTHS.get(ours))
    kinds = [kind for kind, names in _NEEDED.items() if found.keys() >= names]
    attitude = _attitude(found)
    if attitude is not None and (options.kind == "attitude" or not kinds):
        t = _time(found, len(attitude), options)
        return AttitudeHistory(t, attitude, name=path.stem)
    if not kinds:
        listed = ", ".join(sorted(name for name in arrays if not name.startswith("__"))) or "nothing"
        raise ValueError(
            "needs positions (p_NB or s), attitude (quat_wxyz or R_NS), an IMU (gyro and accel) or increments "
            f"(dtheta and dv); it has: {listed}. Rename yours."
        )
    kind = chosen_kind(kinds, options.kind)
    if kind == "increments":
        t = _time(found, len(found["dtheta"]) + 1, options)
        return ImuIncrements(t, found["dtheta"], found["dv"], found.get("dp"), name=path.stem)
    if kind == "imu":
        t = _time(found, len(found["gyro"]), options)
        return ImuRecording(t, found["gyro"], found["accel"], found.get("mag_uT"), name=path.stem)
    t = _time(found, len(found["p_NB"]), options)
    return Poses(t, found["p_NB"], attitude, found.get("v_NB"), name=path.stem)


def chosen_kind(kinds: Sequence[str], asked: str | None) -> str:
    """The kind to read from a file that has `kinds`, in the order of preference; ValueError where nothing decides."""
    if len(kinds) > 1 and asked is None:
        named = [_CALLED[kind] for kind in kinds]
        raise ValueError(
            f"has both {' and '.join(named)}. Say which: "
            f"{' or '.join(f'kind={kind!r}' for kind in kinds)} (--kind)."
        )
    # Increments serve as an IMU's mean rates.
    wanted = ("imu", "increments") if asked == "imu" else (asked,)
    return next((kind for kind in kinds if kind in wanted), kinds[0])


def _rows(name: str, value: Any, width: int | None) -> Array:
    """A variable as float64 with time first; MATLAB saves vectors as rows or columns alike."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"variable {name!r} does not hold numbers.") from None
    if width is None:
        return array.ravel() if array.ndim < 3 and 1 in (array.shape or (1,)) else array
    if array.ndim == 2 and array.shape[1] != width and array.shape[0] == width:
        array = array.T
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"variable {name!r} must be (n, {width}); got {array.shape}.")
    return np.ascontiguousarray(array)


def _time(found: Mapping[str, Array], n: int, options: ReadOptions) -> Array:
    if "t" in found:
        return found["t"].ravel()
    rate_hz = options.rate_hz or (float(found["rate_hz"].ravel()[0]) if "rate_hz" in found else None)
    if not rate_hz:
        raise ValueError("has no time: no variable t or time. Add one, or give rate_hz.")
    return np.arange(n) / rate_hz


def _attitude(found: Mapping[str, Array]) -> Array | None:
    if "R_NB" in found:
        return _pages(found["R_NB"])
    if "quat_wxyz" in found:
        return matrix_from_quat_wxyz(unit_quaternions("quaternion", found["quat_wxyz"]))
    if "phi" in found:
        return matrix_from_euler(radians("phi", found["phi"]))
    if "orientation" in found:
        return _matlab_orientation(found["orientation"])
    return None


def _pages(R: Array) -> Array:
    """(n, 3, 3) from that, or from MATLAB's pages (3, 3, n)."""
    if R.ndim != 3:
        raise ValueError(f"rotation matrices must be (n, 3, 3) or (3, 3, n); got {R.shape}.")
    return np.ascontiguousarray(np.moveaxis(R, -1, 0) if R.shape[:2] == (3, 3) else R)


def _matlab_orientation(value: Array) -> Array:
    """R_NB from MATLAB's `orientation`: compact(quaternion), or pages of its nav-to-body frame rotation.

    The parts of the quaternion are those of q_NB all the same: rotateframe(q, v) is conj(q) v q.
    Source: MathWorks documentation of rotateframe, waypointTrajectory and imuSensor.
    """
    if value.ndim == 2 and value.shape[1] == 4:
        return matrix_from_quat_wxyz(unit_quaternions("orientation", value))
    return np.ascontiguousarray(np.swapaxes(_pages(value), 1, 2))
