"""Turns an answer that cannot be right into one that begins anew, and tells such an answer by the mean of the force.

A gyro that froze or saturated leaves an attitude that is wrong and yet believed. Accelerations end; gravity does not:
over some seconds the mean of the specific force points up, and where it does not, the answer is lost.
"""

import math

from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.estimate.filters.dcm.window import turn_world
from kreisel.estimate.filters.mekf import layout as at
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, Vector, dot, load, norm, scaled, store, unit

# s, over which the force is averaged.
_TIME = 6.0

# rad: a tilt of the mean that accelerations of a vehicle do not make; standard deviations of the tilt it must be as
# well.
_TILTED, _GATE = 0.35, 5.0

# rad: the same where the force is no more than gravity, so that none made it: 1.4 m/s^2 sideways would add 0.1 m/s^2,
# three times what an accelerometer's bias may be. The share of it that tells a push.
_TILTED_AT_G, _PUSHED = 0.14, 0.5

# What comes and goes by so much leaves less than this share of it in the mean.
_BEYOND = 0.5

# rad: an answer that is known no better than that is none.
_UNKNOWN = 1.5

# rad: what a mean of the force and a first field leave open.
NEW_TILT, _NEW_HEADING = 0.35, 1.0

# rad/s and 1: how wrong bias and scale may have become before.
_NEW_BIAS, _NEW_SCALE = 5e-3, 2e-3


@kernel
def is_lost(state: Array, P: Array) -> bool:
    """Whether attitude is unknown, or known and wrong; the mean of the force moves on by one window."""
    tilt2 = 0.5 * (P[0, 0] + P[1, 1])
    seconds = state[at.ACCEL_TIME]
    if seconds > 0.0:
        state[at.MEAN_TIME] = min(state[at.MEAN_TIME] + seconds, _TIME)
        k = seconds / state[at.MEAN_TIME]
        for i in range(3):
            mean = state[at.FORCE_SUM + i] / seconds
            state[at.MEAN_FORCE + i] += k * (mean - state[at.MEAN_FORCE + i])
        square = state[at.ACCEL_SQUARES] / seconds
        state[at.MEAN_SQUARE] += k * (square - state[at.MEAN_SQUARE])
    return tilt2 > _UNKNOWN**2 or (state[at.MEAN_TIME] >= _TIME and _is_tilted(state, tilt2))


@kernel
def _is_tilted(state: Array, tilt2: float) -> bool:
    """Whether the mean of the force is gravity askew, rather than gravity and what pushes."""
    mean = load(state, at.MEAN_FORCE)
    sideways, strength = math.hypot(mean[0], mean[1]), norm(mean)
    tilted = math.atan2(sideways, mean[2])
    # What pushes sideways adds its square to that of gravity; a tilt does not.
    may_be_push = state[at.MEAN_SQUARE] > GRAVITY**2 + _PUSHED * sideways**2
    if not tilted > max(_TILTED if may_be_push else _TILTED_AT_G, _GATE * math.sqrt(tilt2)):
        return False
    # Of the two, the one that leaves less of an acceleration upward.
    is_push = abs(strength - GRAVITY) > abs(mean[2] - GRAVITY)
    scatter2 = max(state[at.MEAN_SQUARE] - strength**2, 0.0)
    return not is_push and sideways**2 > _BEYOND**2 * scatter2


@kernel
def begin_again(state: Array, P: Array) -> None:
    """Level by the mean of the force, or by the next sample where that is old; keep what is known of the sensors."""
    up = unit(load(state, at.MEAN_FORCE))
    if 0.5 * (P[0, 0] + P[1, 1]) > _UNKNOWN**2 or dot(up, up) == 0.0:
        state[at.LEVELLED] = 0.0
    else:
        turn_world(state, to_up(up))
    state[at.NORTHED] = 0.0
    for i in range(2):
        renew(P, i, NEW_TILT**2)
        renew(P, at.V + i, 1.0)
        renew(P, at.S + i, 0.0)
        state[at.VELOCITY + i] = 0.0
    for i in range(3):
        renew(P, at.U + i, 1.0)
        state[at.TRAVEL + i] = 0.0
    renew(P, 2, _NEW_HEADING**2)
    renew(P, at.D, state[at.SPREAD])
    # What is wrong may have taught wrong constants as well.
    for i in range(at.B, at.B + 3):
        P[i, i] += _NEW_BIAS**2
    for i in range(at.C, at.C + 9):
        P[i, i] += _NEW_SCALE**2
    state[at.TURNED] = state[at.SPAN] = state[at.CONTRARY] = 0.0
    store(state, at.MEAN_FORCE, (0.0, 0.0, GRAVITY))
    state[at.MEAN_SQUARE] = GRAVITY**2
    state[at.MEAN_TIME] = 0.0


@kernel
def renew(P: Array, i: int, variance: float) -> None:
    """An error that has nothing to do with any other."""
    for j in range(P.shape[0]):
        P[i, j] = P[j, i] = 0.0
    P[i, i] = variance


@kernel
def to_up(up: Vector) -> Vector:
    """The shortest rotation vector, in N, that makes the direction `up` the new up."""
    angle = math.atan2(math.hypot(up[0], up[1]), up[2])
    axis = unit((up[1], -up[0], 0.0))
    # Upside down any axis will do.
    return scaled(angle, axis if dot(axis, axis) > 0.0 else (1.0, 0.0, 0.0))
