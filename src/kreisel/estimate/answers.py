"""Turns the places that every filter's state begins with into attitude, acceleration and flags."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Mask
from kreisel.data.checks import read_only
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording
from kreisel.estimate import filters as at
from kreisel.estimate.filters import Array, AttitudeFilter, KnowingFilter
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import Rows, added, combined, dot

# A matrix whose products of rows are that near to those of a rotation has an error of 1e-12 one iteration later.
_NEAR = 1e-6


def room_for_sigma(filter: AttitudeFilter, *shape: int) -> Array | None:
    """Room (..., 3) for standard deviations where `filter` has them."""
    return np.empty((*shape, 3)) if isinstance(filter, KnowingFilter) else None


def fill_sigma(filter: AttitudeFilter, sigma: Array | None, first: int, answers: Array) -> None:
    """Put those of answers (..., m, width) into sigma (..., n, 3), to the samples from `first` on."""
    if sigma is not None and isinstance(filter, KnowingFilter):
        sigma[..., first : first + answers.shape[-2], :] = answers[..., filter.sigma : filter.sigma + 3]


class Columns(NamedTuple):
    """What a filter says of n samples in each of several runs."""

    R_NS: Array  # (runs, n, 3, 3)
    gyro_bias: Array  # (runs, n, 3) rad/s
    a_N: Array  # (runs, n, 3) m/s^2
    rest: Mask  # (runs, n)
    disturbed: Mask  # (runs, n)
    held: Mask  # (runs, n)

    @classmethod
    def of(cls, runs: int, n: int) -> Columns:
        """Room for so many: one piece of memory, for several would go back to the system and come anew each time."""
        room = np.empty(runs * n * (15 * 8 + 3), np.uint8)
        numbers, flags = room[: runs * n * 15 * 8].view(np.float64), room[runs * n * 15 * 8 :].view(np.bool_)
        R, bias, a_N = np.split(numbers, [9 * runs * n, 12 * runs * n])
        rest, disturbed, held = flags.reshape(3, runs, n)
        vectors = bias.reshape(runs, n, 3), a_N.reshape(runs, n, 3)
        return cls(R.reshape(runs, n, 3, 3), *vectors, rest, disturbed, held)

    def part(self, runs: slice) -> Columns:
        """The same room, of some of the runs."""
        R, bias, a_N, rest, disturbed, held = self
        return Columns(R[runs], bias[runs], a_N[runs], rest[runs], disturbed[runs], held[runs])

    def fill(self, first: int, answers: Array, accel: Array) -> None:
        """Put answers (runs, m, ANSWER), to the samples of accel (runs, n, 3) from `first` on, in their place."""
        unpack(answers, accel, first, *self)

    def history(self, run: int, recording: ImuRecording, sigma: Array | None = None) -> AttitudeHistory:
        """The answers of one run beside the time of its recording, and its sigma (n, 3) where there is one."""
        R, bias, a_N = (read_only(column[run]) for column in self[:3])
        rest, disturbed, held = (column[run] for column in self[3:])
        known = None if sigma is None else read_only(sigma)
        return AttitudeHistory(
            recording.t, R, bias, a_N, known, rest, disturbed, held, recording.t0_ns, recording.name
        )


@kernel
def unpack(
    answers: Array,
    accel: Array,
    first: int,
    R: Array,
    bias: Array,
    a_N: Array,
    rest: Mask,
    disturbed: Mask,
    held: Mask,
) -> None:
    """Fill the Columns of m samples from `first` on, from answers (runs, m, ANSWER) and accel (runs, n, 3).

    a_N is the specific force in N less gravity, of this one sample: nothing is smoothed.
    """
    for run in range(answers.shape[0]):
        for i in range(answers.shape[1]):
            k = first + i
            rows = _rotation(
                (
                    (answers[run, i, 0], answers[run, i, 1], answers[run, i, 2]),
                    (answers[run, i, 3], answers[run, i, 4], answers[run, i, 5]),
                    (answers[run, i, 6], answers[run, i, 7], answers[run, i, 8]),
                )
            )
            f = accel[run, k, 0], accel[run, k, 1], accel[run, k, 2]
            R[run, k, 0, 0], R[run, k, 0, 1], R[run, k, 0, 2] = rows[0]
            R[run, k, 1, 0], R[run, k, 1, 1], R[run, k, 1, 2] = rows[1]
            R[run, k, 2, 0], R[run, k, 2, 1], R[run, k, 2, 2] = rows[2]
            a_N[run, k, 0], a_N[run, k, 1] = dot(rows[0], f), dot(rows[1], f)
            a_N[run, k, 2] = dot(rows[2], f) - STANDARD_GRAVITY
            for j in range(3):
                bias[run, k, j] = answers[run, i, at.GYRO_BIAS + j]
            flags = int(answers[run, i, at.FLAGS])
            rest[run, k], disturbed[run, k] = flags & at.REST, flags & at.DISTURBED
            held[run, k] = flags & at.HELD


@inlined
def _rotation(rows: Rows) -> Rows:
    """The rotation nearest to a matrix that a first-order step has left almost orthonormal.

    Newton's iteration for the orthogonal polar factor (Higham 1986), which squares the error each time.
    """
    for _ in range(6):
        x, y, z = rows
        xx, yy, zz, xy, xz, yz = dot(x, x), dot(y, y), dot(z, z), dot(x, y), dot(x, z), dot(y, z)
        rows = (
            added(combined((-0.5 * xx, -0.5 * xy, -0.5 * xz), x, y, z), 1.5, x),
            added(combined((-0.5 * xy, -0.5 * yy, -0.5 * yz), x, y, z), 1.5, y),
            added(combined((-0.5 * xz, -0.5 * yz, -0.5 * zz), x, y, z), 1.5, z),
        )
        # Looked at afterwards, for one turn is enough nearly always: a branch that goes one way costs nothing.
        if max(abs(xx - 1.0), abs(yy - 1.0), abs(zz - 1.0), abs(xy), abs(xz), abs(yz)) < _NEAR:
            break
    return rows
