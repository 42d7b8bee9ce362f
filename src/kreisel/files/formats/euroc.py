"""Turns EuRoC ground truth (ns, p, q w first, v, biases) into Poses and back; the biases are left out.

Leica and Vicon files of the same dataset (position alone, or position and quaternion) are read too.
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.stamps import to_nanoseconds
from kreisel.files.text import (
    checked_quaternions,
    first_rows,
    load_timed,
    read_text,
    starts_with_nanoseconds,
    write_rows,
)
from kreisel.maths.rotations import matrix_from_quat_wxyz, quat_wxyz_from_matrix

SUFFIX = None
HOLDS = (Poses, Motion)
OPTIONS: frozenset[str] = frozenset()
KEEPS = "int64 nanoseconds exactly, positions and velocities to the bit, attitude to 1e-15"

NAMES = (
    ("timestamp",),
    ("p_RS_R_x [m]", "p_RS_R_y [m]", "p_RS_R_z [m]"),
    ("q_RS_w []", "q_RS_x []", "q_RS_y []", "q_RS_z []"),
    ("v_RS_R_x [m s^-1]", "v_RS_R_y [m s^-1]", "v_RS_R_z [m s^-1]"),
)
# Time and position; with attitude; with velocity; with both biases.
WIDTHS = (4, 8, 11, 17)


def sniff(head: bytes) -> bool:
    """Integer nanoseconds, then one of the widths these files have, between commas."""
    comments, rows = first_rows(head)
    return starts_with_nanoseconds(comments, rows, WIDTHS)


def read(path: Path, options: ReadOptions) -> Poses:
    """Pose of the EuRoC body frame (its IMU) in its reference frame, whose z axis points up."""
    file = read_text(path)
    width = file.rows[0].count(",") + 1
    if width not in WIDTHS:
        raise file.error(0, f"EuRoC poses have {WIDTHS} columns between commas; this line has {width}.")
    names = [name for group in NAMES for name in group][:width] + ["bias"] * max(0, width - 11)
    # The biases stand beyond column 11: an estimate of another kind, for which Poses has no place.
    t, end, values = load_timed(file, ",", names, range(1, min(width, 11)), digits=0)
    R_NB = None
    if width > 4:
        R_NB = matrix_from_quat_wxyz(checked_quaternions(file, values[:, 3:7], "q_RS_w ... q_RS_z"))
    v_NB = np.ascontiguousarray(values[:, 7:10]) if width > 8 else None
    return Poses(t, np.ascontiguousarray(values[:, :3]), R_NB, v_NB, end.t0_ns, path.stem)


def write(data: Noun, out: BinaryIO) -> None:
    """Time and position, then as much of attitude and velocity as the data has."""
    if isinstance(data, ImuRecording):
        raise ValueError("euroc files hold poses; this is an IMU recording. Write euroc-imu instead.")
    if not isinstance(data, Poses | Motion):
        raise ValueError("euroc files hold poses; this data has no positions. Write csv instead.")
    parts: list[Array] = [data.p_NB]
    if data.R_NB is not None:
        parts.append(quat_wxyz_from_matrix(data.R_NB))
        if data.v_NB is not None:
            parts.append(data.v_NB)
    names = [name for group in NAMES[: len(parts) + 1] for name in group]
    stamps = list(map(str, to_nanoseconds(data.t, data.t0_ns).tolist()))
    write_rows(out, "#" + ", ".join(names), [stamps, *(column for part in parts for column in part.T)], ",")
