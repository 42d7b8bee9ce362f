"""Turns the sums of a window into rest or motion, and the gyro's readings at rest into its bias."""

from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.covariance import look, row_of_next, take
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, dot, load, scaled

# rad/s/sqrt(Hz): how well a mean at rest is known. Some three times a phone's gyro, for tables and hands.
_GYRO_NOISE = 5e-4

# s: rest is believed after this time; the same length of gyro readings makes a bias.
_STRETCH = 0.5

# Standard deviations by which a mean at rest may differ from the known bias; more is a slow rotation.
_GATE = 4.0


@kernel
def watch_rest(state: Array, params: Array, P: Array) -> bool:
    """Whether the sensor is at rest; it learns the bias from it."""
    if not _is_still(state, params, P):
        state[at.REST_TIME] = 0.0
        _forget(state, at.STRETCH)
        _forget(state, at.WAITING)
        return False
    state[at.REST_TIME] += state[at.LENGTH]
    _learn(state, P)
    return state[at.REST_TIME] >= _STRETCH


@kernel
def _is_still(state: Array, params: Array, P: Array) -> bool:
    """Whether this window's readings scatter like noise, around a rate that the known bias explains."""
    dt, counted = state[at.LENGTH], state[at.ACCEL_TIME]
    if counted < 0.5 * dt or state[at.MISSING] > 0.0:
        return False
    gyro, accel = scaled(1.0 / dt, load(state, at.GYRO_SUM)), load(state, at.ACCEL_SUM)
    for i in range(3):
        variance = P[at.B + i, at.B + i] + _GYRO_NOISE**2 / dt
        if (gyro[i] - state[at.GYRO_BIAS + i]) ** 2 > _GATE**2 * variance:
            return False
    scatter = state[at.GYRO_SQUARES] / dt - dot(gyro, gyro)
    shake = (state[at.ACCEL_SQUARES] - dot(accel, accel) / counted) / counted
    return scatter < params[at.REST_GYRO] ** 2 and shake < params[at.REST_ACCEL] ** 2


@kernel
def _learn(state: Array, P: Array) -> None:
    """The gyro's mean over a stretch of rest is its bias, if a stretch came before it and another follows.

    Rest begins with the end of a motion and ends with the beginning of one, both below any threshold.
    """
    for i in range(3):
        state[at.STRETCH + i] += state[at.GYRO_SUM + i]
    state[at.STRETCH + 3] += state[at.LENGTH]
    if state[at.STRETCH + 3] < _STRETCH:
        return
    dt = state[at.WAITING + 3]
    if dt > 0.0:
        for i in range(3):
            state[row_of_next(state) + at.B + i] = 1.0
            known, own = look(state, P)
            surprise = state[at.GYRO_BIAS + i] - state[at.WAITING + i] / dt - known
            take(state, P, surprise, own + _GYRO_NOISE**2 / dt)
    is_first = state[at.REST_TIME] < 1.5 * state[at.STRETCH + 3]
    for i in range(4):
        state[at.WAITING + i] = 0.0 if is_first else state[at.STRETCH + i]
    _forget(state, at.STRETCH)


@kernel
def _forget(state: Array, stretch: int) -> None:
    for i in range(stretch, stretch + 4):
        state[i] = 0.0
