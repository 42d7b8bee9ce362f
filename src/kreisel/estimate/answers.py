"""Turns what filters find into columns of attitude, bias, acceleration and flags, one row per sample."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Mask
from kreisel.data.recording import ImuRecording
from kreisel.estimate import filters as at
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import Rows, dot, load, nearest_rotation

_ZERO = bytes(3 * 8)


class Columns(NamedTuple):
    """What a filter says after each of n samples; those of several runs have the runs in front."""

    R_NS: Array  # (n, 3, 3) rotations to 1e-12
    gyro_bias: Array  # (n, 3) rad/s; zeros that nobody writes to where the filter learns none
    rest: Mask  # (n,)
    disturbed: Mask  # (n,)
    held: Mask  # (n,)
    heading: Array  # (n,) rad, or (0,) where nobody asks
    sigma: Array  # (n, 3) rad, or (n, 0) where the filter does not know it

    @classmethod
    def room_for(cls, filter: AttitudeFilter, shape: tuple[int, ...], heading: bool = False) -> Columns:
        """Room for what this filter says of (n,) samples or (runs, n)."""
        # What makes a KnowingFilter; to ask a protocol costs as much as a hundred samples.
        return cls.of(shape, filter.learns_bias, heading, hasattr(filter, "sigma"))

    @classmethod
    def of(cls, shape: tuple[int, ...], bias: bool, heading: bool = False, sigma: bool = False) -> Columns:
        """Room for (n,) samples or (runs, n), in one piece of memory.

        Several pieces would go back to the system and come anew each time, and fresh memory costs more than a step.
        """
        count = math.prod(shape)
        angles = 8 * count * (9 + 3 * bias)
        sigmas = angles + 8 * count * heading
        flags = sigmas + 8 * count * 3 * sigma
        room = np.empty(flags + 3 * count, np.uint8)
        R_NS = np.ndarray((*shape, 3, 3), np.float64, room)
        gyro_bias = np.ndarray((*shape, 3), np.float64, room, 8 * count * 9) if bias else _zeros(shape)
        rest, disturbed, held = np.ndarray((3, *shape), np.bool_, room, flags)
        asked = (*shape[:-1], shape[-1] if heading else 0)
        turned = np.ndarray(asked, np.float64, room, angles)
        known = np.ndarray((*shape, 3 if sigma else 0), np.float64, room, sigmas)
        return cls(R_NS, gyro_bias, rest, disturbed, held, turned, known)

    def part(self, runs: int | slice) -> Columns:
        """The same room, of one or some of the runs."""
        R_NS, bias, rest, disturbed, held, heading, sigma = self
        return Columns(
            R_NS[runs], bias[runs], rest[runs], disturbed[runs], held[runs], heading[runs], sigma[runs]
        )

    def known(self) -> Array | None:
        """The standard deviations, where the filter knows them."""
        return self.sigma if self.sigma.shape[-1] else None

    def history(self, recording: ImuRecording) -> AttitudeHistory:
        """The answers of one run beside the time of its recording."""
        for column in self:
            column.flags.writeable = False
        R_NS, gyro_bias, rest, disturbed, held = self[:5]
        return AttitudeHistory.trusted(
            recording.t,
            R_NS,
            gyro_bias,
            recording.accel,
            (rest, disturbed, held),
            recording.t0_ns,
            recording.name,
            self.known(),
        )


def _zeros(shape: tuple[int, ...]) -> Array:
    """Read-only zeros (*shape, 3) that all are the same three."""
    return np.ndarray((*shape, 3), np.float64, _ZERO, strides=(0,) * len(shape) + (8,))


@inlined
def answer(R: Array, i: int, rows: Rows, askew: float) -> None:
    """Put the rotation nearest to `rows`, whose first two have the product `askew`, in its place."""
    rows = nearest_rotation(rows, askew)
    R[i, 0, 0], R[i, 0, 1], R[i, 0, 2] = rows[0]
    R[i, 1, 0], R[i, 1, 1], R[i, 1, 2] = rows[1]
    R[i, 2, 0], R[i, 2, 1], R[i, 2, 2] = rows[2]


@inlined
def flags_of(flags: float) -> tuple[bool, bool, bool]:
    """Whether at rest, disturbed and held."""
    bits = int(flags)
    return bits & at.REST != 0, bits & at.DISTURBED != 0, bits & at.HELD != 0


@inlined
def tell(state: Array, out: Columns, i: int) -> None:
    """Put all that a state (at least ANSWER,) says in row i of `out`, but for bias and sigma."""
    rows = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    answer(out.R_NS, i, rows, dot(rows[0], rows[1]))
    out.rest[i], out.disturbed[i], out.held[i] = flags_of(state[at.FLAGS])
    if i < out.heading.shape[0]:
        out.heading[i] = state[at.HEADING]


@inlined
def repeat(state: Array, out: Columns, begin: int, end: int) -> None:
    """Put flags and heading of a state in rows from `begin` to `end`, through which they were the same."""
    out.rest[begin:end], out.disturbed[begin:end], out.held[begin:end] = flags_of(state[at.FLAGS])
    out.heading[begin:end] = state[at.HEADING]


@kernel
def show(state: Array, out: Columns) -> None:
    """Put all that a state (at least ANSWER,) says in the only row of `out`, but for sigma."""
    tell(state, out, 0)
    out.gyro_bias[0, 0], out.gyro_bias[0, 1], out.gyro_bias[0, 2] = load(state, at.GYRO_BIAS)
