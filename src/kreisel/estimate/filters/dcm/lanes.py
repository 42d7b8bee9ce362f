"""Turns recordings that lie one after the other into rows that lie beside each other, one lane each, and answers back.

What is stepped abreast lies in flat arrays with the lane as the last index, and the inner loops run over lanes: the
compiler makes vector instructions of them, whose operations are those of one lane to the last bit.
"""

from kreisel.estimate.filters.dcm.start import is_rate
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array

LANES = 16

# Rows of LANES in the scratch. They are constants: of places that it cannot compare the compiler assumes the worst,
# and takes lane by lane what they hold.
AXES = 9
READING = 9  # gyro, accel, mag

# Steps whose readings are gathered at once: lines of memory are fetched whole, and all scratch stays in the L1 cache.
BLOCK = 16


@kernel
def gather(readings: Array, t: Array, gyro: Array, accel: Array, mag: Array, k: int, steps: int) -> bool:
    """Put the readings from sample k on beside each other; True where all are ordinary."""
    ordinary = k > 0
    for i in range(k, k + steps):
        ordinary = ordinary and t[i] - t[max(i - 1, 0)] > 0.0
    for lane in range(LANES):
        g, a, m = gyro[lane, k : k + steps], accel[lane, k : k + steps], mag[lane, k : k + steps]
        for i in range(steps):
            place = i * READING * LANES + lane
            for c in range(3):
                readings[place + c * LANES] = g[i, c]
                readings[place + (3 + c) * LANES] = a[i, c]
                readings[place + (6 + c) * LANES] = m[i, c]
            ordinary = ordinary and is_rate((g[i, 0], g[i, 1], g[i, 2]))
    return ordinary


@kernel
def scatter(answers: Array, R: Array, k: int, steps: int) -> None:
    """Put the rows of `answers` into the R_NS (LANES, n, 3, 3) of samples from k on."""
    for lane in range(LANES):
        rows = R[lane, k : k + steps]
        for i in range(steps):
            place = i * AXES * LANES + lane
            for row in range(3):
                for c in range(3):
                    rows[i, row, c] = answers[place + (3 * row + c) * LANES]
