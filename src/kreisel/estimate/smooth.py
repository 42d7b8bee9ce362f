"""Turns a recording into attitude that knows, at every sample, what came after it as well as what came before."""

from __future__ import annotations

from collections.abc import Sequence

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import instance
from kreisel.data.recording import SOURCE, ImuRecording
from kreisel.estimate.answers import Columns
from kreisel.estimate.batch import in_threads
from kreisel.estimate.filters import Array, AttitudeFilter, SmoothingFilter
from kreisel.estimate.run import readings


def smooth(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None) -> AttitudeHistory:
    """The most likely attitude at every sample given all of `recording`, and its sigma.

    The answer of `run` corrected backwards from the end, after a second pass from a start that knows the rest: bias,
    scale and north are the same from the first sample on. Long recordings go in blocks of five minutes that look
    ahead by half as much, in memory that does not grow. Flags and a_N are as `run` has them.
    R_NS : (3, 3), the first attitude where it is known.
    Raises TypeError for a filter that keeps no covariance, ValueError where it needs a magnetometer and there is none.
    """
    if not isinstance(filter, SmoothingFilter):
        raise TypeError(
            f"{type(filter).__name__} cannot be smoothed: it does not say how well it knows. Take MekfFilter()."
        )
    instance("recording", recording, ImuRecording, SOURCE)
    inputs = readings(filter, recording.t, recording.gyro, recording.accel, recording.mag_uT)
    columns = Columns.room_for(filter, (len(recording),))
    filter.smoothed(*inputs, columns, R_NS)
    return columns.history(recording)


def smooth_all(
    filter: AttitudeFilter, recordings: Sequence[ImuRecording], *, threads: int | None = None
) -> list[AttitudeHistory]:
    """What `smooth` makes of each recording, of any length and rate.

    threads : how many at most; None for all cores. Raises as `smooth` does.
    """
    histories: dict[int, AttitudeHistory] = {}

    def one(k: int) -> None:
        histories[k] = smooth(filter, recordings[k])

    in_threads(one, range(len(recordings)), threads)
    return [histories[k] for k in range(len(recordings))]
