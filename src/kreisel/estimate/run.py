"""Turns a recording into attitude, all at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.recording import ImuRecording
from kreisel.estimate import filters as at
from kreisel.estimate.answers import Columns, fill_sigma, room_for_sigma
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.maths.kernels import argument

# Samples whose answers fit the L2 cache (0.5 MB), from where they are unpacked.
_BLOCK = 4096


def run(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None) -> AttitudeHistory:
    """The attitude at every sample of `recording`, the first one from R_NS (3, 3) or from the first samples.

    Its a_N is the specific force of each sample in N less gravity, not smoothed; NaN where the sample is missing.
    Raises ValueError where the filter needs a magnetometer that the recording does not have.
    """
    columns, sigma = Columns.of(1, len(recording)), room_for_sigma(filter, len(recording))
    for first, answers in _blocks(filter, recording, R_NS):
        columns.fill(first, answers[None], argument(recording.accel[None]))
        fill_sigma(filter, sigma, first, answers)
    return columns.history(0, recording, sigma)


def run_both(
    filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None
) -> tuple[AttitudeHistory, AttitudeHistory]:
    """The answers with and without the magnetometer's heading, from one pass.

    The second is the first with all turns about up taken back that the magnetometer asked for: its heading starts
    at zero and drifts, less than that of a run which never saw a magnetometer and learned no bias from it.
    """
    whole, without = Columns.of(1, len(recording)), Columns.of(1, len(recording))
    sigma = room_for_sigma(filter, len(recording))
    accel = argument(recording.accel[None])
    for first, answers in _blocks(filter, recording, R_NS):
        whole.fill(first, answers[None], accel)
        fill_sigma(filter, sigma, first, answers)
        c, s = np.cos(answers[:, at.HEADING, None]), np.sin(answers[:, at.HEADING, None])
        east, north = answers[:, 0:3].copy(), answers[:, 3:6].copy()
        answers[:, 0:3] = c * east + s * north
        answers[:, 3:6] = c * north - s * east
        without.fill(first, answers[None], accel)
    return whole.history(0, recording, sigma), without.history(0, recording)


def readings(
    filter: AttitudeFilter, t: Array, gyro: Array, accel: Array, mag: Array | None
) -> tuple[Array, Array, Array, Array]:
    """t, gyro, accel and mag as kernels take them; NaN in place of a magnetometer that is not needed."""
    if mag is None:
        if filter.needs_mag:
            raise ValueError(
                "this filter needs a magnetometer and the recording has none. "
                'Give mag_uT, or a mode without it (mode="6").'
            )
        mag = np.full_like(gyro, np.nan)
    return argument(t), argument(gyro), argument(accel), argument(mag)


def _blocks(
    filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None
) -> Iterator[tuple[int, Array]]:
    """First sample and answers (m, width) of one block after the other; the next overwrites the answers."""
    n = len(recording)
    inputs = readings(filter, recording.t, recording.gyro, recording.accel, recording.mag_uT)
    state, parameters = filter.start(R_NS), filter.parameters()
    block = np.empty((min(n, _BLOCK), at.width(filter)))
    for first in range(0, n, _BLOCK):
        answers = block[: n - first]
        filter.batch(state, parameters, *inputs, first, answers)
        yield first, answers
