"""Turns the places that every filter's state begins with into attitude, acceleration and flags."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Mask
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording
from kreisel.estimate import filters as at
from kreisel.estimate.filters import Array
from kreisel.maths.kernels import argument, kernel

# A matrix whose products of rows are that near to those of a rotation is left alone.
_ROUNDING = 1e-12


class Columns(NamedTuple):
    """What a filter says of (n,) samples, or of (runs, n)."""

    R_NS: Array  # (n, 3, 3)
    gyro_bias: Array  # (n, 3) rad/s
    a_N: Array  # (n, 3) m/s^2
    rest: Mask  # (n,)
    disturbed: Mask  # (n,)
    held: Mask  # (n,)

    @classmethod
    def of(cls, *shape: int) -> Columns:
        """Room for so many."""
        R, bias, a_N = (np.empty((*shape, *of_one)) for of_one in ((3, 3), (3,), (3,)))
        rest, disturbed, held = np.empty((3, *shape), np.bool_)
        return cls(R, bias, a_N, rest, disturbed, held)

    def fill(self, rows: slice, answers: Array, accel: Array) -> None:
        """Put answers (m, ANSWER) to `rows` of accel (n, 3) in their place."""
        R, bias, a_N = self.R_NS[rows], self.gyro_bias[rows], self.a_N[rows]
        unpack(
            answers,
            argument(accel[rows]),
            R,
            bias,
            a_N,
            self.rest[rows],
            self.disturbed[rows],
            self.held[rows],
        )

    def history(self, recording: ImuRecording) -> AttitudeHistory:
        """The same beside the time of `recording`."""
        return AttitudeHistory(recording.t, **self._asdict(), t0_ns=recording.t0_ns, name=recording.name)


@kernel
def unpack(
    answers: Array, accel: Array, R: Array, bias: Array, a_N: Array, rest: Mask, disturbed: Mask, held: Mask
) -> None:
    """Fill the Columns of n samples from answers (n, ANSWER) and accel (n, 3).

    a_N is the specific force in N less gravity, of this one sample: nothing is smoothed.
    """
    for k in range(answers.shape[0]):
        for i in range(3):
            for j in range(3):
                R[k, i, j] = answers[k, at.R_NS + 3 * i + j]
            bias[k, i] = answers[k, at.GYRO_BIAS + i]
        _make_rotation(R[k])
        for i in range(3):
            force = R[k, i, 0] * accel[k, 0] + R[k, i, 1] * accel[k, 1] + R[k, i, 2] * accel[k, 2]
            a_N[k, i] = force - STANDARD_GRAVITY if i == 2 else force
        bits = int(answers[k, at.FLAGS])
        rest[k] = bits & at.REST
        disturbed[k] = bits & at.DISTURBED
        held[k] = bits & at.HELD


@kernel
def _make_rotation(R: Array) -> None:
    """Put the nearest rotation in place of a matrix that a first-order step has left almost orthonormal.

    Newton's iteration for the orthogonal polar factor (Higham 1986), which squares the error each time.
    """
    for _ in range(6):
        xx = R[0, 0] ** 2 + R[0, 1] ** 2 + R[0, 2] ** 2
        yy = R[1, 0] ** 2 + R[1, 1] ** 2 + R[1, 2] ** 2
        zz = R[2, 0] ** 2 + R[2, 1] ** 2 + R[2, 2] ** 2
        xy = R[0, 0] * R[1, 0] + R[0, 1] * R[1, 1] + R[0, 2] * R[1, 2]
        xz = R[0, 0] * R[2, 0] + R[0, 1] * R[2, 1] + R[0, 2] * R[2, 2]
        yz = R[1, 0] * R[2, 0] + R[1, 1] * R[2, 1] + R[1, 2] * R[2, 2]
        if max(abs(xx - 1.0), abs(yy - 1.0), abs(zz - 1.0), abs(xy), abs(xz), abs(yz)) < _ROUNDING:
            return
        for j in range(3):
            x, y, z = R[0, j], R[1, j], R[2, j]
            R[0, j] = 1.5 * x - 0.5 * (xx * x + xy * y + xz * z)
            R[1, j] = 1.5 * y - 0.5 * (xy * x + yy * y + yz * z)
            R[2, j] = 1.5 * z - 0.5 * (xz * x + yz * y + zz * z)
