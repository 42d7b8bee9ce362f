"""Turns a recording back into a motion and compares it with the motion the recording was made from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.estimate.strapdown import integrate
from kreisel.evaluate.motion_errors import MotionErrors, motion_errors


def round_trip(
    recording: ImuRecording | ImuIncrements, truth: Motion, environment: Environment | None = None
) -> MotionErrors:
    """Errors of `recording`, integrated from its first stamp on, against `truth`, the sensor's own motion.

    truth : `motion.at(mount)`, with the same stamps as the recording.
    """
    return motion_errors(truth, integrate(recording, truth, environment))


def complete(recording: ImuRecording, truth: Motion) -> tuple[ImuRecording, Motion]:
    """Those rows at which gyroscope and accelerometer both gave a sample, and the truth there, stamped alike.

    truth : `motion.at(mount)`, row by row that of `recording`, whose clock may be wrong.
    """
    rows = np.flatnonzero(np.isfinite(recording.gyro).all(axis=1) & np.isfinite(recording.accel).all(axis=1))
    t, gyro, accel = recording.t[rows], recording.gyro[rows], recording.accel[rows]
    kept = ImuRecording(t=t, gyro=gyro, accel=accel, t0_ns=recording.t0_ns, name=recording.name)
    return kept, replace(truth.rows(rows), t=t)
