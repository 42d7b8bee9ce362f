"""Turns what a window summed into what its errors can be: the covariance matrix P, carried on and observed.

Errors are estimate less truth: R_est = Exp(theta) R_true, theta' = -R (bias + C gyro), velocity' = gravity x tilt - R
accel_bias.
"""

import math

from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.estimate.filters.mekf import layout as at
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, load

# m/s: how fast what seems to stay about its place may yet creep on.
_CREEP = 0.1

# rad: a turn by which iron on the body points elsewhere in N.
_ELSEWHERE = 1.0

# rad: what calibration leaves of an accelerometer's axes, as tilt.
_AXES = 0.003

# s: in which an accelerometer's bias may change by as much as it has.
_LASTING = 1000.0


@kernel
def propagate(state: Array, params: Array, P: Array) -> None:
    """P <- F P F^T + Q over the window, and the estimates that fade do so; F is kept in CHANGE."""
    for k in range(3 * at.CONSTANTS):
        state[at.CHANGE + k] = state[at.TURN + k]
    for i in range(2):
        state[at.CHANGE_LAG + i] = -state[at.LAG_SUM + i]
    state[at.CHANGE_FORCE] = state[at.ACCEL_TIME]
    state[at.CHANGE_LENGTH] = state[at.LENGTH]
    _fade(state, params)
    _turn_rows(state[at.CHANGE : at.OBSERVED], P)
    # F P is done. Its transpose is P F^T, of which the same rows make F P F^T.
    _transpose(P)
    _turn_rows(state[at.CHANGE : at.OBSERVED], P)
    # Round-off must not make two halves of it.
    for a in range(at.ERRORS):
        for b in range(a):
            P[b, a] = P[a, b]
    _add_noise(state, params, P)


@kernel
def _transpose(P: Array) -> None:
    for a in range(P.shape[0]):
        for b in range(a):
            P[a, b], P[b, a] = P[b, a], P[a, b]


@kernel
def _turn_rows(change: Array, P: Array) -> None:
    """P <- F P: only rows of what changes are other ones."""
    n = P.shape[0]
    seconds, dt = change[at.CHANGE_FORCE - at.CHANGE], change[at.CHANGE_LENGTH - at.CHANGE]
    kept, lag = at.CHANGE_KEPT - at.CHANGE, at.CHANGE_LAG - at.CHANGE
    # True gravity rather than the force that was seen: an answer that stands on its head must not find itself
    # at rest there. Velocity first, for it grows with the tilt that was there at the beginning.
    g, share = GRAVITY * seconds, seconds / dt
    for i in range(2):
        x, y, z = load(change, at.CONSTANTS * i)
        sign, tilt, pushed, way = (g, 1, change[lag], at.S) if i == 0 else (-g, 0, change[lag + 1], at.S + 1)
        for j in range(n):
            # What a gyro bias turns by, an accelerometer bias pushes by: both are fixed to the sensor.
            a = x * P[at.A, j] + y * P[at.A + 1, j] + z * P[at.A + 2, j]
            P[at.V + i, j] += sign * P[tilt, j] + pushed * P[at.L, j] + share * a
            u = x * P[at.U, j] + y * P[at.U + 1, j] + z * P[at.U + 2, j]
            P[way, j] = change[kept + 2] * P[way, j] + dt * P[at.V + i, j] + u
    for i in range(3):
        for k in range(at.CONSTANTS):
            f = change[at.CONSTANTS * i + k]
            for j in range(n):
                P[i, j] += f * P[at.B + k, j]
    for j in range(n):
        for i in range(3):
            P[at.U + i, j] *= change[kept]
        P[at.D, j] *= change[kept + 1]


@kernel
def _fade(state: Array, params: Array) -> None:
    """What share is kept of travel and of the field's turn; the estimates keep as much."""
    dt = state[at.LENGTH]
    turned = math.sqrt(dt * state[at.GYRO_SQUARES]) / _ELSEWHERE
    state[at.CHANGE_KEPT] = math.exp(-dt / params[at.TRAVEL_TIME])
    # What disturbs comes and goes faster than the unevenness of a room.
    calm = state[at.SPREAD] <= 4.0 * params[at.FIELD_SPREAD] ** 2
    lasting = params[at.FIELD_TIME_CONSTANT] if calm else params[at.FIELD_RELEASE]
    state[at.CHANGE_KEPT + 1] = math.exp(-dt / lasting - turned)
    state[at.CHANGE_KEPT + 2] = 0.0 if state[at.SPAN] == 0.0 else 1.0
    for i in range(3):
        state[at.TRAVEL + i] *= state[at.CHANGE_KEPT]
    state[at.TURNED] *= state[at.CHANGE_KEPT + 1]


@kernel
def _add_noise(state: Array, params: Array, P: Array) -> None:
    dt = state[at.LENGTH]
    theta = dt * params[at.GYRO_NOISE] ** 2
    theta += state[at.GYRO_SQUARES] * params[at.RATE_NOISE] ** 2
    theta += state[at.MISSING]
    travel2 = 0.0
    for i in range(3):
        travel2 += state[at.TRAVEL + i] ** 2 / 3.0
    travel2 = min(_CREEP**2 + travel2, params[at.TRAVEL_SPREAD] ** 2)
    for i in range(3):
        P[i, i] += theta
        P[at.B + i, at.B + i] += dt * params[at.BIAS_DRIFT] ** 2
        P[at.U + i, at.U + i] += travel2 * (1.0 - state[at.CHANGE_KEPT] ** 2)
    for i in range(at.C, at.C + 9):
        P[i, i] += dt * params[at.SCALE_DRIFT] ** 2
    P[at.D, at.D] += state[at.SPREAD] * (1.0 - state[at.CHANGE_KEPT + 1] ** 2)
    for i in range(at.A, at.A + 3):
        P[i, i] += dt * params[at.ACCEL_SPREAD] ** 2 / _LASTING


@kernel
def known_to(i: int, variance: float, excess: float) -> float:
    """The deviation of attitude error i, with what no error here stands for: an accelerometer's axes and scale.

    excess: by how many times the tilt's variance is more than P says.
    """
    return math.sqrt(excess * variance + _AXES**2) if i < 2 else math.sqrt(variance)


@kernel
def look(state: Array, P: Array) -> tuple[float, float]:
    """What CORRECTION makes of the observation whose row is in place, and the variance of that."""
    n, row = at.ERRORS, at.OBSERVATIONS + int(state[at.OBSERVED]) * at.OBSERVATION
    known, variance = 0.0, 0.0
    for a in range(n):
        state[row + n + a] = 0.0
    for b in range(n):
        h = state[row + b]
        if h != 0.0:
            known += h * state[at.CORRECTION + b]
            for a in range(n):
                state[row + n + a] += h * P[b, a]
    for a in range(n):
        variance += state[row + a] * state[row + n + a]
    return known, variance


@kernel
def row_of_next(state: Array) -> int:
    """Place of the row of the next observation, all zero."""
    row = at.OBSERVATIONS + int(state[at.OBSERVED]) * at.OBSERVATION
    for a in range(at.ERRORS):
        state[row + a] = 0.0
    return row


@kernel
def take(state: Array, P: Array, surprise: float, variance: float) -> None:
    """Take in a `surprise` of this `variance` in all by the row that `look` has seen.

    P <- (1 - k h) P (1 - k h)^T + k r k^T, Joseph's form, which no rounding of the gain k spoils to first order.
    """
    n, row = at.ERRORS, at.OBSERVATIONS + int(state[at.OBSERVED]) * at.OBSERVATION
    column, x = state[row + n : row + 2 * n], state[at.CORRECTION : at.CORRECTION + n]
    state[row + 2 * n], state[row + 2 * n + 1] = surprise, variance
    weight = 1.0 / variance
    for a in range(n):
        gain = column[a] * weight
        x[a] += gain * surprise
        # k h P + P h^T k^T - k S k^T, of which two cancel but for rounding.
        back = gain * variance - column[a]
        for b in range(n):
            P[a, b] -= gain * column[b] - back * (column[b] * weight)
    state[at.OBSERVED] += 1.0
