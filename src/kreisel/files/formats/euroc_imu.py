"""Turns EuRoC IMU files (ns, gyro rad/s, accelerometer m/s^2) into ImuRecording and back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.recording import ImuRecording
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.stamps import to_nanoseconds
from kreisel.files.text import (
    Before,
    TextFile,
    first_rows,
    load_timed,
    read_text,
    starts_with_nanoseconds,
    write_rows,
)
from kreisel.files.text_blocks import text_blocks

SUFFIX = None
HOLDS = (ImuRecording,)
OPTIONS: frozenset[str] = frozenset()
KEEPS = "int64 nanoseconds exactly, rates and forces to the bit; no magnetometer"

NAMES = (
    "timestamp [ns]",
    *(f"w_RS_S_{axis} [rad s^-1]" for axis in "xyz"),
    *(f"a_RS_S_{axis} [m s^-2]" for axis in "xyz"),
)


def sniff(head: bytes) -> bool:
    """Integer nanoseconds, then six numbers, between commas."""
    comments, rows = first_rows(head)
    return starts_with_nanoseconds(comments, rows, (len(NAMES),))


def read(path: Path, options: ReadOptions) -> ImuRecording:
    """Rates and specific forces in the sensor's axes; a row with nan is a missing sample."""
    return _recording(read_text(path))[0]


def blocks(path: Path, options: ReadOptions) -> Iterator[ImuRecording]:
    """The same, block by block."""
    end = None
    for file in text_blocks(path):
        block, end = _recording(file, end)
        yield block


def _recording(file: TextFile, before: Before | None = None) -> tuple[ImuRecording, Before]:
    t, end, values = load_timed(file, ",", NAMES, range(1, 7), digits=0, nan_ok=True, before=before)
    gyro, accel = np.ascontiguousarray(values[:, :3]), np.ascontiguousarray(values[:, 3:])
    return ImuRecording(t, gyro, accel, t0_ns=end.t0_ns, name=file.path.stem), end


def write(data: Noun, out: BinaryIO) -> None:
    """Seven columns; the magnetometer, where there is one, has no place in this format."""
    if not isinstance(data, ImuRecording):
        raise ValueError("euroc-imu files hold IMU recordings; this is none. Write euroc or csv instead.")
    stamps = list(map(str, to_nanoseconds(data.t, data.t0_ns).tolist()))
    write_rows(out, "#" + ",".join(NAMES), [stamps, *data.gyro.T, *data.accel.T], ",")
