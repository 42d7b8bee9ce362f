"""Turns TUM trajectories (lines of t x y z qx qy qz qw, seconds and metres) into Poses and back.

An attitude without positions is written with zeros in their place, for the tools that need eight columns; a
comment above says so, and by it such a file is told from poses at the origin.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.signs import Signs
from kreisel.files.stamps import seconds_text
from kreisel.files.text import (
    Before,
    TextFile,
    checked_quaternions,
    load_timed,
    read_text,
    starts_with_numbers,
    write_rows,
)
from kreisel.files.text_blocks import text_blocks
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
    return _noun(read_text(path))[0]


def blocks(path: Path, options: ReadOptions) -> Iterator[Poses | AttitudeHistory]:
    """The same, block by block."""
    end = None
    for file in text_blocks(path):
        block, end = _noun(file, end)
        yield block


def _noun(file: TextFile, before: Before | None = None) -> tuple[Poses | AttitudeHistory, Before]:
    t, end, values = load_timed(file, None, NAMES, range(1, 8), digits=9, before=before)
    q_wxyz = checked_quaternions(file, values[:, [6, 3, 4, 5]], "qx ... qw")
    R = matrix_from_quat_wxyz(q_wxyz)
    if ATTITUDE_ONLY in file.comments:
        return AttitudeHistory(t, R, t0_ns=end.t0_ns, name=file.path.stem), end
    return Poses(t, np.ascontiguousarray(values[:, :3]), R, t0_ns=end.t0_ns, name=file.path.stem), end


def write(data: Noun, out: BinaryIO) -> None:
    """Epoch stamps get nine decimals, times since a start every digit they have."""
    write_blocks([data], out)


def write_blocks(blocks: Iterable[Noun], out: BinaryIO) -> None:
    """The same of what comes block by block."""
    signs, header = Signs(), "# " + " ".join(NAMES)
    for block in blocks:
        if isinstance(block, AttitudeHistory):
            p, R, remark = np.zeros((len(block), 3)), block.R_NS, f"# {ATTITUDE_ONLY}\n"
        elif isinstance(block, Poses | Motion) and block.R_NB is not None:
            p, R, remark = block.p_NB, block.R_NB, ""
        else:
            raise ValueError("TUM files hold attitude at every stamp; this data does not. Write csv instead.")
        w, *xyz = signs.continued(quat_wxyz_from_matrix(R)).T
        stamps = seconds_text(block.t, block.t0_ns)
        write_rows(out, header and remark + header, [stamps, *p.T, *xyz, w], " ")
        header = ""
