"""Turns the sums of a window into rest or motion, and the gyro's readings at rest into its bias."""

from kreisel.estimate.filters.dcm.rest import (
    GYRO_NOISE,
    LASTED,
    MEMORY,
    MISSED,
    STRETCH,
    SUMS,
    WAITING,
    begin_stretch,
    completes_stretch,
    is_still,
)
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.covariance import look, row_of_next, take
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, load


@kernel
def watch_rest(state: Array, params: Array, P: Array) -> bool:
    """Whether the sensor is at rest; it learns the bias from it."""
    memory, sums = state[at.REST_TIME : at.REST_TIME + MEMORY], state[at.LENGTH : at.LENGTH + SUMS]
    bias = load(state, at.GYRO_BIAS)
    scatter = params[at.REST_GYRO], params[at.REST_ACCEL]
    if state[at.MISSING] > MISSED or not is_still(sums, bias, P, at.B, scatter):
        memory[:] = 0.0
        return False
    if completes_stretch(memory, sums):
        dt = memory[WAITING + 3]
        if dt > 0.0:
            for i in range(3):
                state[row_of_next(state) + at.B + i] = 1.0
                known, own = look(state, P)
                surprise = state[at.GYRO_BIAS + i] - memory[WAITING + i] / dt - known
                take(state, P, surprise, own + GYRO_NOISE**2 / dt)
        begin_stretch(memory)
    return memory[LASTED] >= STRETCH
