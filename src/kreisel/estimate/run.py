"""Turns a recording into attitude, all at once or sample by sample as it comes in."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.recording import ImuRecording
from kreisel.estimate import filters as at
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.maths.kernels import argument


def run(filter: AttitudeFilter, recording: ImuRecording, R_NS: Array | None = None) -> AttitudeHistory:
    """The attitude at every sample of `recording`, the first one from R_NS (3, 3) or from the first samples.

    Raises ValueError where the filter needs a magnetometer that the recording does not have.
    """
    return _history(recording, _answers(filter, recording, R_NS))


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
    return _history(recording, answers), _history(recording, without)


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


def _history(recording: ImuRecording, answers: Array) -> AttitudeHistory:
    flags = answers[:, at.FLAGS].astype(np.int64)
    return AttitudeHistory(
        recording.t,
        _nearest_rotations(answers[:, at.R_NS : at.R_NS + 9].reshape(-1, 3, 3)),
        gyro_bias=answers[:, at.GYRO_BIAS : at.GYRO_BIAS + 3],
        rest=(flags & at.REST) > 0,
        disturbed=(flags & at.DISTURBED) > 0,
        held=(flags & at.HELD) > 0,
        t0_ns=recording.t0_ns,
        name=recording.name,
    )


def _nearest_rotations(R: Array) -> Array:
    """The rotations nearest to matrices that a first-order step has left almost orthonormal.

    Newton's iteration for the orthogonal polar factor (Higham 1986), which squares the error each time.
    """
    for _ in range(6):
        gram = R @ R.transpose(0, 2, 1)
        if np.abs(gram - np.eye(3)).max(initial=0.0) < 1e-12:
            break
        R = 1.5 * R - 0.5 * gram @ R
    return R


class Stream:
    """A filter that is fed sample by sample; its answers equal those of `run` bit for bit."""

    __slots__ = ("_filter", "_parameters", "_sample", "_state")

    def __init__(self, filter: AttitudeFilter, R_NS: Array | None = None) -> None:
        self._filter = filter
        self._parameters = filter.parameters()
        self._state = filter.start(R_NS)
        self._sample = np.empty(9)

    def update(
        self, gyro: npt.ArrayLike, accel: npt.ArrayLike, mag_uT: npt.ArrayLike | None = None, *, dt: float
    ) -> None:
        """Take in samples (3,) of rad/s, m/s^2 and uT that end `dt` seconds after the ones before.

        A NaN is a missing sample, None a magnetometer without one; dt = 0 changes nothing but a stream that has
        not begun. Raises ValueError where time runs back or a sample does not have three numbers.
        """
        if not dt >= 0.0:
            raise ValueError(f"dt must be >= 0 s; got {dt}. Time must not run back: sort the samples.")
        sample = self._sample
        sample[0:3] = gyro
        sample[3:6] = accel
        sample[6:9] = np.nan if mag_uT is None else mag_uT
        self._filter.update(self._state, self._parameters, sample, float(dt))

    @property
    def R_NS(self) -> Array:
        """(3, 3) attitude after the latest sample."""
        return self._state[at.R_NS : at.R_NS + 9].reshape(3, 3).copy()

    @property
    def gyro_bias(self) -> Array:
        """(3,) rad/s."""
        return self._state[at.GYRO_BIAS : at.GYRO_BIAS + 3].copy()

    @property
    def heading_offset(self) -> float:
        """What the magnetometer has turned the attitude by, about up, rad."""
        return float(self._state[at.HEADING])

    @property
    def rest(self) -> bool:
        """The sensor is taken to be at rest."""
        return bool(int(self._state[at.FLAGS]) & at.REST)

    @property
    def disturbed(self) -> bool:
        """The magnetometer is not trusted."""
        return bool(int(self._state[at.FLAGS]) & at.DISTURBED)

    @property
    def held(self) -> bool:
        """The gyro's sample was missing, or nothing has shown yet which way is up."""
        return bool(int(self._state[at.FLAGS]) & at.HELD)
