"""Turns a block of readings abreast into whether every step of it is an ordinary one in every lane."""

from kreisel.estimate.abreast import READING
from kreisel.estimate.filters.dcm.start import is_rate
from kreisel.maths.kernels import LANES, inlined
from kreisel.maths.vectors import Array

BLOCK = 16
"""Steps that are looked at together."""


@inlined
def ordinary(dt: Array, readings: Array) -> bool:
    """Whether all steps of a block take time and have a rate of the gyro; dt (n,), readings flat."""
    fine = True
    for i in range(dt.shape[0]):
        fine = fine and dt[i] > 0.0
        r = readings[i * READING * LANES :]
        good = 0
        for j in range(LANES):
            good += is_rate((r[j], r[LANES + j], r[2 * LANES + j]))
        fine = fine and good == LANES
    return fine
