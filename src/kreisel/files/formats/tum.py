"""Turns TUM trajectories (lines of t x y z qx qy qz qw, seconds and metres) into Poses and back."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.stamps import seconds_text
from kreisel.files.text import (
    checked_clock,
    checked_finite,
    checked_quaternions,
    first_rows,
    is_number,
    load,
    read_text,
    write_rows,
)
from kreisel.maths.rotations import matrix_from_quat_wxyz, quat_wxyz_from_matrix

SUFFIX = ".tum"
HOLDS = (Poses, Motion)
OPTIONS: frozenset[str] = frozenset()
KEEPS = "time to the nanosecond, positions to the bit, attitude to 1e-15; no velocity"

NAMES = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")


def sniff(head: bytes) -> bool:
    """Eight numbers between blanks."""
    _, rows = first_rows(head)
    fields = rows[0].split() if rows else []
    return len(fields) == len(NAMES) and all(map(is_number, fields))


def read(path: Path, options: ReadOptions) -> Poses:
    """Positions and attitudes as the file has them: TUM names no frame and no direction of up."""
    file = read_text(path)
    stamps, values = load(file, None, NAMES, 0, range(1, 8))
    assert stamps is not None
    t, t0_ns = checked_clock(file, stamps, 9, NAMES[0])
    checked_finite(file, values, NAMES[1:])
    q_wxyz = checked_quaternions(file, values[:, [6, 3, 4, 5]], "qx ... qw")
    p_NB = np.ascontiguousarray(values[:, :3])
    return Poses(t, p_NB, matrix_from_quat_wxyz(q_wxyz), t0_ns=t0_ns, name=path.stem)


def write(data: Noun, out: BinaryIO) -> None:
    """Epoch stamps get nine decimals, times since a start every digit they have."""
    if isinstance(data, ImuRecording) or data.R_NB is None:
        raise ValueError(
            "TUM files hold positions with attitude; this data has no attitude. Write csv instead."
        )
    w, *xyz = quat_wxyz_from_matrix(data.R_NB).T
    write_rows(out, "# " + " ".join(NAMES), [seconds_text(data.t, data.t0_ns), *data.p_NB.T, *xyz, w], " ")
