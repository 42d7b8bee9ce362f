"""Turns the sums of a window into rest or motion, and the gyro's readings at rest into its bias."""

from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.covariance import observe
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, dot, load, scaled

# rad/s/sqrt(Hz): how well a mean at rest is known. Some three times a phone's gyro, for tables and hands.
GYRO_NOISE = 5e-4

# s: rest is believed after this time; the same length of gyro readings makes a bias.
STRETCH = 0.5

# rad^2: what missing samples may leave open of a window at rest; a few that are lost, and not all of them.
MISSED = 1e-3

# Standard deviations by which a mean at rest may differ from the known bias; more is a slow rotation.
_GATE = 4.0

# Places in the sums of a window, which begin with its length.
SUMS = 10
_LENGTH, _GYRO_SUM, _GYRO_SQUARES, _ACCEL_SUM, _ACCEL_SQUARES, _ACCEL_TIME = 0, 1, 4, 5, 8, 9

# Places in the memory of rest: how long it has lasted, s; sums of gyro times dt and of dt over the stretch that goes
# on; the same of the stretch before, which waits to be believed.
MEMORY = 9
LASTED, WAITING = 0, 5
_GOING_ON = 1


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
                error = state[at.GYRO_BIAS + i] - memory[WAITING + i] / dt
                observe(state, P, at.B + i, error, GYRO_NOISE**2 / dt)
        begin_stretch(memory)
    return memory[LASTED] >= STRETCH


@kernel
def is_still(
    sums: Array,
    bias: tuple[float, float, float],
    P: Array,
    first: int,
    scatter: tuple[float, float],
) -> bool:
    """Whether a window's readings scatter like noise, around a rate that the known bias explains.

    The bias has the rows from `first` on in the covariance P; scatter: rad/s, m/s^2, of a sensor at rest.
    """
    dt, counted = sums[_LENGTH], sums[_ACCEL_TIME]
    if counted < 0.5 * dt:
        return False
    gyro, accel = scaled(1.0 / dt, load(sums, _GYRO_SUM)), load(sums, _ACCEL_SUM)
    for i in range(3):
        variance = P[first + i, first + i] + GYRO_NOISE**2 / dt
        if (gyro[i] - bias[i]) ** 2 > _GATE**2 * variance:
            return False
    turns = sums[_GYRO_SQUARES] / dt - dot(gyro, gyro)
    shakes = (sums[_ACCEL_SQUARES] - dot(accel, accel) / counted) / counted
    return turns < scatter[0] ** 2 and shakes < scatter[1] ** 2


@kernel
def completes_stretch(memory: Array, sums: Array) -> bool:
    """Add a window at rest; whether a stretch is complete with it, and the one that waits is believed.

    The gyro's mean over a stretch of rest is its bias, if a stretch came before it and another follows: rest begins
    with the end of a motion and ends with the beginning of one, both below any threshold.
    """
    memory[LASTED] += sums[_LENGTH]
    for i in range(3):
        memory[_GOING_ON + i] += sums[_GYRO_SUM + i]
    memory[_GOING_ON + 3] += sums[_LENGTH]
    return memory[_GOING_ON + 3] >= STRETCH


@kernel
def begin_stretch(memory: Array) -> None:
    """Have the stretch that is complete wait, unless rest began with it, and begin another."""
    is_first = memory[LASTED] < 1.5 * memory[_GOING_ON + 3]
    for i in range(4):
        memory[WAITING + i] = 0.0 if is_first else memory[_GOING_ON + i]
        memory[_GOING_ON + i] = 0.0
