"""Turns KITTI trajectories (twelve numbers a line: the rows of [R | p], no time) into Poses and back.

KITTI's own odometry poses are those of a camera (x right, y down, z forward); the numbers are taken as
they are.
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.text import (
    TextFile,
    checked_clock,
    checked_finite,
    load,
    read_text,
    starts_with_numbers,
    write_rows,
)

SUFFIX = ".kitti"
HOLDS = (Poses, Motion)
OPTIONS = frozenset({"rate_hz", "times"})
KEEPS = "positions and matrices to the bit; no time: give rate_hz or a file of times"

NAMES = tuple(
    f"{name}{row}{column}" for row in "123" for name, column in zip("RRRp", ("1", "2", "3", ""), strict=True)
)


def sniff(head: bytes) -> bool:
    """Twelve numbers between blanks."""
    return starts_with_numbers(head, len(NAMES))


def read(path: Path, options: ReadOptions) -> Poses:
    """Poses at `options.rate_hz`, the first at t = 0, or at the stamps in `options.times`."""
    file = read_text(path)
    _, values = load(file, None, NAMES, None, range(12))
    checked_finite(file, values, NAMES)
    rows = values.reshape(-1, 3, 4)
    R_NB = _nearest_rotations(file, np.ascontiguousarray(rows[:, :, :3]))
    t, t0_ns = _times(path, len(values), options)
    return Poses(t, np.ascontiguousarray(rows[:, :, 3]), R_NB, t0_ns=t0_ns, name=path.stem)


def write(data: Noun, out: BinaryIO) -> None:
    """One line per pose; the stamps have no place in this format."""
    if not isinstance(data, Poses | Motion) or data.R_NB is None:
        raise ValueError("kitti files hold positions with attitude; this data lacks one. Write csv instead.")
    rows = np.concatenate([data.R_NB, data.p_NB[:, :, None]], axis=2).reshape(-1, 12)
    write_rows(out, "", list(rows.T), " ")


def _times(path: Path, n: int, options: ReadOptions) -> tuple[Array, int]:
    if options.times is None:
        if options.rate_hz is None:
            raise ValueError(
                f"{path} holds no time. Give rate_hz (--input-rate 10), or times (--times FILE) with one "
                "stamp in s per line."
            )
        return np.arange(n) / options.rate_hz, 0
    file = read_text(options.times)
    stamps, _ = load(file, None, ["time"], 0, [])
    assert stamps is not None
    if len(stamps) != n:
        raise ValueError(f"{options.times} has {len(stamps)} stamps for the {n} poses of {path}.")
    t, end = checked_clock(file, stamps, 9, "time")
    return t, end.t0_ns


def _nearest_rotations(file: TextFile, R: Array) -> Array:
    """`R` where it is orthonormal, the nearest rotations where digits were cut, ValueError beyond 1e-3."""
    gram = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2))
    bad = (gram > 1e-3) | (np.linalg.det(R) < 0.0)
    if bad.any():
        k = int(np.argmax(bad))
        why = "it mirrors" if np.linalg.det(R[k]) < 0.0 else f"R^T R is {gram[k]:.2g} off identity"
        raise file.error(k, f"the first three columns are no rotation matrix: {why}. Check the column order.")
    # A bit-exact file must come back with its bits: only printed matrices are brought back onto SO(3).
    if gram.max() < 1e-12:
        return R
    U, _, Vt = np.linalg.svd(R)
    return np.asarray(U @ Vt)
