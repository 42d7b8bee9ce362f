"""Turns recordings that lie one after the other into rows that lie beside each other, one lane each, and answers back.

Readings abreast are (n, 9, LANES), gyro, accel and mag; answers abreast (n, 9, LANES), the rotation row by row, or
(n, 13, LANES) with the gyro's bias and the flags, as states have them. Loops over lanes become vector instructions,
whose operations are those of one lane to the last bit.
"""

from typing import TypeGuard

import numpy as np

from kreisel.estimate import filters as at
from kreisel.estimate.answers import Columns, flags_of
from kreisel.estimate.filters import AttitudeFilter, LaneFilter
from kreisel.maths.kernels import LANES, argument, inlined, kernel
from kreisel.maths.vectors import Array, dot, load, nearest_rotation

# Constants all of them: of places that it cannot compare the compiler assumes the worst, and takes lane by lane what
# they hold.
READING = 9
"""Rows of readings: gyro, accel, mag."""

AXES = 9
"""Rows of answers without bias and flags."""

TOLD = at.FLAGS + 1
"""Rows of answers with them."""

BLOCK = 16
"""Samples that are brought from rows into lanes at a time: whole lines of memory, and all in the first-level cache."""

PIECE = 64
"""Samples that one kernel brings into lanes, steps and brings back at a time."""

SAMPLES = 512
"""Samples that go through several kernels at a time: readings and answers of so many stay in the second-level cache.

Half as many are 2 % faster in one thread, but two wait for each other and Python twice as often.
"""


def takes_lanes(filter: AttitudeFilter) -> TypeGuard[LaneFilter]:
    """Whether LANES recordings go through this filter abreast; answers abreast have no room for sigma."""
    return isinstance(filter, LaneFilter) and filter.lanes == LANES and not hasattr(filter, "sigma")


def steps(t: Array) -> Array:
    """Time (n,) s since the sample before, at times t (n,); 0 for the first, as filters take it."""
    return argument(np.diff(t, prepend=t[:1]))


@kernel
def gather(gyro: Array, accel: Array, mag: Array, first: int, readings: Array) -> None:
    """Put readings (LANES, N, 3), those from sample `first` on, beside each other."""
    flat, n = readings.reshape(-1), readings.shape[0]
    for begin in range(0, n, BLOCK):
        rows, block = min(BLOCK, n - begin), flat[begin * READING * LANES :]
        k = first + begin
        for lane in range(LANES):
            g, a, m = gyro[lane, k : k + rows], accel[lane, k : k + rows], mag[lane, k : k + rows]
            for i in range(rows):
                place = i * READING * LANES + lane
                for c in range(3):
                    block[place + c * LANES] = g[i, c]
                    block[place + (3 + c) * LANES] = a[i, c]
                    block[place + (6 + c) * LANES] = m[i, c]


@kernel
def scatter(answers: Array, first: int, out: Columns) -> None:
    """Put answers (n, TOLD, LANES) into rows from `first` on of columns with the lanes in front and no flags yet."""
    flat, n = answers.reshape(-1), answers.shape[0]
    for begin in range(0, n, BLOCK):
        rows, block = min(BLOCK, n - begin), flat[begin * TOLD * LANES :]
        k = first + begin
        for lane in range(LANES):
            R = out.R_NS[lane, k : k + rows]
            for i in range(rows):
                place = i * TOLD * LANES + lane
                for row in range(3):
                    for c in range(3):
                        R[i, row, c] = block[place + (3 * row + c) * LANES]
                flags = block[place + at.FLAGS * LANES]
                if flags != 0.0:
                    out.rest[lane, k + i], out.disturbed[lane, k + i], out.held[lane, k + i] = flags_of(flags)


@kernel
def scatter_bias(answers: Array, first: int, bias: Array) -> None:
    """Put the biases of answers (n, TOLD, LANES) into rows (LANES, N, 3) from `first` on."""
    for begin in range(0, answers.shape[0], BLOCK):
        block = answers[begin : begin + BLOCK]
        for lane in range(LANES):
            rows = bias[lane, first + begin : first + begin + block.shape[0]]
            for i in range(block.shape[0]):
                for c in range(3):
                    rows[i, c] = block[i, at.GYRO_BIAS + c, lane]


@inlined
def tell_abreast(state: Array, answers: Array, i: int, lane: int) -> None:
    """Put what the state of a lane says in its place among the answers of sample i."""
    rows = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    rows = nearest_rotation(rows, dot(rows[0], rows[1]))
    for c in range(3):
        answers[i, c, lane] = rows[0][c]
        answers[i, 3 + c, lane] = rows[1][c]
        answers[i, 6 + c, lane] = rows[2][c]
    for c in range(AXES, answers.shape[1]):
        answers[i, c, lane] = state[c]
