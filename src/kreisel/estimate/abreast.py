"""Turns recordings that lie one after the other into rows that lie beside each other, one lane each, and answers back.

Readings abreast are (n, 9, LANES), gyro, accel and mag; answers abreast (n, 9, LANES), the rotation row by row, or
(n, 13, LANES) with the gyro's bias and the flags, as states have them. Loops over lanes become vector instructions,
whose operations are those of one lane to the last bit.
"""

import numpy as np

from kreisel.estimate import filters as at
from kreisel.estimate.answers import Columns, flags_of
from kreisel.maths.kernels import LANES, argument, inlined, kernel
from kreisel.maths.vectors import Array, dot, load, nearest_rotation

READING = 9
"""Rows of readings: gyro, accel, mag."""

AXES = 9
"""Rows of answers without bias and flags."""

TOLD = at.FLAGS + 1
"""Rows of answers with them."""

SAMPLES = 512
"""Samples that go through several kernels at a time: readings and answers of so many stay in the second-level cache."""


def steps(t: Array) -> Array:
    """Time (n,) s since the sample before, at times t (n,); 0 for the first, as filters take it."""
    return argument(np.diff(t, prepend=t[:1]))


@kernel
def gather(gyro: Array, accel: Array, mag: Array, readings: Array) -> None:
    """Put readings (LANES, n, 3) beside each other."""
    for lane in range(LANES):
        g, a, m = gyro[lane], accel[lane], mag[lane]
        for i in range(readings.shape[0]):
            for c in range(3):
                readings[i, c, lane], readings[i, 3 + c, lane], readings[i, 6 + c, lane] = (
                    g[i, c],
                    a[i, c],
                    m[i, c],
                )


@kernel
def scatter(answers: Array, first: int, out: Columns) -> None:
    """Put answers (n, TOLD, LANES) into the rows from `first` on of columns with the lanes in front."""
    R_NS, _, rest, disturbed, held, _, _ = out
    for lane in range(LANES):
        R = R_NS[lane, first:]
        for i in range(answers.shape[0]):
            for row in range(3):
                for c in range(3):
                    R[i, row, c] = answers[i, 3 * row + c, lane]
            k = first + i
            rest[lane, k], disturbed[lane, k], held[lane, k] = flags_of(answers[i, at.FLAGS, lane])


@kernel
def scatter_bias(answers: Array, first: int, bias: Array) -> None:
    """Put the biases of answers (n, TOLD, LANES) into rows (LANES, n, 3) from `first` on."""
    for lane in range(LANES):
        for i in range(answers.shape[0]):
            for c in range(3):
                bias[lane, first + i, c] = answers[i, at.GYRO_BIAS + c, lane]


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
