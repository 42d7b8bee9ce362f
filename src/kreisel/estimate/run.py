"""Turns a recording into attitude, all at once."""

from __future__ import annotations

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import instance
from kreisel.data.recording import SOURCE, ImuRecording
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.maths.kernels import argument


def run(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None) -> AttitudeHistory:
    """The attitude at every sample of `recording`, the first one from R_NS (3, 3) or from the first samples.

    Its a_N is the specific force of each sample in N less gravity, not smoothed; NaN where the sample is missing.
    Raises ValueError where the filter needs a magnetometer that the recording does not have.
    """
    instance("recording", recording, ImuRecording, SOURCE)
    columns = Columns.room_for(filter, (len(recording),))
    _fill(filter, recording, R_NS, columns)
    return columns.history(recording)


def run_both(
    filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None
) -> tuple[AttitudeHistory, AttitudeHistory]:
    """The answers with and without the magnetometer's heading, from one pass.

    The second is the first with all turns about up taken back that the magnetometer asked for: its heading starts
    at zero and drifts, less than that of a run which never saw a magnetometer and learned no bias from it.
    """
    whole = Columns.room_for(filter, (len(recording),), heading=True)
    _fill(filter, recording, R_NS, whole)
    without = Columns.of((len(recording),), filter.learns_bias)
    for new, same in zip(without, whole, strict=True):
        if new.flags.writeable and new.shape == same.shape:
            new[:] = same
    c, s = np.cos(whole.heading[:, None]), np.sin(whole.heading[:, None])
    without.R_NS[:, 0] = c * whole.R_NS[:, 0] + s * whole.R_NS[:, 1]
    without.R_NS[:, 1] = c * whole.R_NS[:, 1] - s * whole.R_NS[:, 0]
    return whole.history(recording), without.history(recording)


def readings(
    filter: AttitudeFilter, t: Array, gyro: Array, accel: Array, mag: Array | None
) -> tuple[Array, Array, Array, Array]:
    """t, gyro, accel and mag as kernels take them; NaN in place of a magnetometer that is not needed."""
    if mag is None:
        check_needs(filter)
        mag = np.full_like(gyro, np.nan)
    return argument(t), argument(gyro), argument(accel), argument(mag)


def check_needs(filter: AttitudeFilter) -> None:
    """ValueError where the filter needs a magnetometer, for a recording that has none."""
    if filter.needs_mag:
        raise ValueError(
            "this filter needs a magnetometer and the recording has none. "
            'Give mag_uT, or a mode without it (mode="6").'
        )


def _fill(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None, columns: Columns) -> None:
    inputs = readings(filter, recording.t, recording.gyro, recording.accel, recording.mag_uT)
    filter.batch(filter.start(R_NS), filter.parameters(), *inputs, columns)
