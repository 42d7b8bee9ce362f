"""Turns EuRoC IMU files (ns, gyro rad/s, accelerometer m/s^2) into ImuRecording and back."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from kreisel.data.recording import ImuRecording
from kreisel.files.formats import Noun, ReadOptions
from kreisel.files.stamps import to_nanoseconds
from kreisel.files.text import (
    first_rows,
    load_timed,
    read_text,
    starts_with_nanoseconds,
    write_rows,
)

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
    file = read_text(path)
    t, t0_ns, values = load_timed(file, ",", NAMES, range(1, 7), digits=0, nan_ok=True)
    gyro, accel = np.ascontiguousarray(values[:, :3]), np.ascontiguousarray(values[:, 3:])
    return ImuRecording(t, gyro, accel, t0_ns=t0_ns, name=path.stem)


def write(data: Noun, out: BinaryIO) -> None:
    """Seven columns; the magnetometer, where there is one, has no place in this format."""
    if not isinstance(data, ImuRecording):
        raise ValueError("euroc-imu files hold IMU recordings; this is none. Write euroc or csv instead.")
    stamps = list(map(str, to_nanoseconds(data.t, data.t0_ns).tolist()))
    write_rows(out, "#" + ",".join(NAMES), [stamps, *data.gyro.T, *data.accel.T], ",")
