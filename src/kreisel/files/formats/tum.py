"""Turns TUM trajectories (lines of t x y z qx qy qz qw, seconds and metres) into Poses and back.

An attitude without positions is written with zeros in their place, for the tools that need eight columns; a
comment above says so, and by it such a file is told from poses at the origin.
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.stamps import seconds_text
from kreisel.files.text import (
    checked_quaternions,
    load_timed,
    read_text,
    starts_with_numbers,
    write_rows,
)
from kreisel.maths.rotations import matrix_from_quat_wxyz, quat_wxyz_from_matrix

SUFFIX = ".tum"
HOLDS = (Poses, Motion, AttitudeHistory)
OPTIONS: frozenset[str] = frozenset()
KEEPS = "time to the nanosecond, positions to the bit, attitude to 1e-15; no velocity, no bias"

ATTITUDE_ONLY = "attitude only: the positions are zero"
NAMES = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")


def sniff(head: bytes) -> bool:
    """Eight numbers between blanks."""
    return starts_with_numbers(head, len(NAMES))


def read(path: Path, options: ReadOptions) -> Poses | AttitudeHistory:
    """Positions and attitudes as the file has them: TUM names no frame and no direction of up."""
    file = read_text(path)
    t, t0_ns, values = load_timed(file, None, NAMES, range(1, 8), digits=9)
    q_wxyz = checked_quaternions(file, values[:, [6, 3, 4, 5]], "qx ... qw")
    R = matrix_from_quat_wxyz(q_wxyz)
    if ATTITUDE_ONLY in file.comments:
        return AttitudeHistory(t, R, t0_ns=t0_ns, name=path.stem)
    return Poses(t, np.ascontiguousarray(values[:, :3]), R, t0_ns=t0_ns, name=path.stem)


def write(data: Noun, out: BinaryIO) -> None:
    """Epoch stamps get nine decimals, times since a start every digit they have."""
    if isinstance(data, AttitudeHistory):
        p, R, remark = np.zeros((len(data), 3)), data.R_NS, f"# {ATTITUDE_ONLY}\n"
    elif isinstance(data, Poses | Motion) and data.R_NB is not None:
        p, R, remark = data.p_NB, data.R_NB, ""
    else:
        raise ValueError("TUM files hold attitude at every stamp; this data does not. Write csv instead.")
    w, *xyz = quat_wxyz_from_matrix(R).T
    header = remark + "# " + " ".join(NAMES)
    write_rows(out, header, [seconds_text(data.t, data.t0_ns), *p.T, *xyz, w], " ")
