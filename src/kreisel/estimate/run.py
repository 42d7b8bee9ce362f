"""Turns a recording into attitude, all at once."""

from __future__ import annotations

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.recording import ImuRecording
from kreisel.estimate import filters as at
from kreisel.estimate.answers import history
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.maths.kernels import argument


def run(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None) -> AttitudeHistory:
    """The attitude at every sample of `recording`, the first one from R_NS (3, 3) or from the first samples.

    Raises ValueError where the filter needs a magnetometer that the recording does not have.
    """
    return history(recording, _answers(filter, recording, R_NS))


def run_both(
    filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None
) -> tuple[AttitudeHistory, AttitudeHistory]:
    """The answers with and without the magnetometer's heading, from one pass.

    The second is the first with all turns about up taken back that the magnetometer asked for: its heading starts
    at zero and drifts, less than that of a run which never saw a magnetometer and learned no bias from it.
    """
    answers = _answers(filter, recording, R_NS)
    without = answers.copy()
    c, s = np.cos(answers[:, at.HEADING]), np.sin(answers[:, at.HEADING])
    east, north = answers[:, 0:3], answers[:, 3:6]
    without[:, 0:3] = c[:, None] * east + s[:, None] * north
    without[:, 3:6] = c[:, None] * north - s[:, None] * east
    return history(recording, answers), history(recording, without)


def _answers(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None) -> Array:
    mag = recording.mag_uT
    if mag is None:
        if filter.needs_mag:
            raise ValueError(
                "this filter needs a magnetometer and the recording has none. "
                'Give mag_uT, or a mode without it (mode="6").'
            )
        mag = np.full_like(recording.gyro, np.nan)
    answers = np.empty((len(recording), at.ANSWER))
    t, gyro, accel, mag = (argument(x) for x in (recording.t, recording.gyro, recording.accel, mag))
    filter.batch(filter.start(R_NS), filter.parameters(), t, gyro, accel, mag, answers)
    return answers
