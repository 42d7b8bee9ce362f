"""Turns a motion, what its IMUs read and an estimated attitude into a recording for the Rerun viewer (.rrd)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from kreisel.atomic import replacing
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import Array
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.maths.rotations import quat_wxyz_from_matrix

_AXIS_LENGTH = 0.2  # of the extent of the path
_SENSORS = {"gyro": "rad/s", "accel": "m/s^2", "mag_uT": "uT"}


def save_rerun(
    path: str | os.PathLike[str],
    motion: Motion,
    mounts: Sequence[Mount] = (),
    recordings: Sequence[ImuRecording] = (),
    estimate: AttitudeHistory | None = None,
) -> None:
    """Write what `rerun PATH` shows: the body on its path, the IMUs on the body, and their readings as curves.

    motion : of the body. mounts : of the IMUs, drawn on it. recordings : curves in SI units and microtesla.
    estimate : an attitude that turns beside the body.
    Time is the timeline `t`, s; data with an epoch has `time` as well. The whole file or nothing.
    Raises ValueError where rerun-sdk is not installed.
    """
    rerun = installed()
    stream = rerun.RecordingStream("kreisel", make_default=False)
    memory = stream.memory_recording()
    length = _AXIS_LENGTH * float(np.ptp(motion.p_NB, axis=0).max()) or _AXIS_LENGTH
    stream.log("world", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    stream.log("world/path", rerun.LineStrips3D([motion.p_NB]), static=True)
    _send_turning(rerun, stream, "world/body", motion, motion.R_NB, motion.p_NB, length)
    for mount in mounts:
        stream.log(
            rerun.new_entity_path(["world", "body", mount.name]),
            rerun.Transform3D(translation=mount.p_BS, mat3x3=mount.R_BS),
            rerun.TransformAxes3D(0.5 * length),
            static=True,
        )
    for recording in recordings:
        _send_readings(rerun, stream, recording)
    if estimate is not None:
        beside = np.broadcast_to(motion.p_NB[0], (len(estimate), 3))
        _send_turning(rerun, stream, "world/estimate", estimate, estimate.R_NS, beside, length)
    with replacing(path) as out:
        out.write(memory.drain_as_bytes())


def installed() -> Any:
    """The module `rerun`, or a ValueError with the command that installs it."""
    try:
        import rerun
    except ImportError:
        raise ValueError("Rerun recordings need rerun-sdk: pip install 'kreisel[rerun]'.") from None
    return rerun


def _send_turning(
    rerun: Any, stream: Any, entity: str, data: Motion | AttitudeHistory, R: Array, p_N: Array, length: float
) -> None:
    """Axes that move along `p_N` (n, 3) and turn by `R` (n, 3, 3)."""
    quat_xyzw = quat_wxyz_from_matrix(R)[:, [1, 2, 3, 0]]
    stream.log(entity, rerun.TransformAxes3D(length), static=True)
    stream.send_columns(
        entity, _times(rerun, data), rerun.Transform3D.columns(translation=p_N, quaternion=quat_xyzw)
    )


def _send_readings(rerun: Any, stream: Any, recording: ImuRecording) -> None:
    """Three curves per sensor; a missing sample, NaN, is a gap."""
    for sensor, unit in _SENSORS.items():
        values = getattr(recording, sensor)
        if values is None:
            continue
        entity = rerun.new_entity_path([recording.name or "imu", sensor])
        names = [f"{axis} [{unit}]" for axis in "xyz"]
        stream.log(entity, rerun.SeriesLines(names=names), static=True)
        columns = rerun.Scalars.columns(scalars=values.ravel()).partition(np.full(len(values), 3))
        stream.send_columns(entity, _times(rerun, recording), columns)


def _times(rerun: Any, data: Motion | ImuRecording | AttitudeHistory) -> list[Any]:
    times = [rerun.TimeColumn("t", duration=data.t)]
    if data.t0_ns:
        ns = np.int64(data.t0_ns) + np.rint(data.t * 1e9).astype(np.int64)
        times.append(rerun.TimeColumn("time", timestamp=ns.astype("datetime64[ns]")))
    return times
