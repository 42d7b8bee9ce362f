"""The sums of a window into corrections: a small Kalman filter of attitude, velocity, gyro bias and gyro scale.

The specific force in N, summed, is a velocity. That of a body which stays about its place stays small, while a
tilt error t makes it run away by g t: this low-passes the force before it corrects the inclination. The field
in N, averaged, gives the heading. Bias and scale follow from how both errors grow with time and with rotation.

Errors are estimate less truth: R_est = Exp(theta) R_true, and theta' = -R (bias + C gyro).
"""

import math

from kreisel.estimate.filters.dcm import state as at
from kreisel.estimate.filters.dcm.vectors import (
    Array,
    Vector,
    added,
    combined,
    cross,
    dot,
    load,
    rotated,
    scaled,
    store,
    unit,
)
from kreisel.maths.kernels import kernel

# Places in the parameter array, after those that every step shares.
DOF = at.COMMON_PARAMETERS  # 9, 6 or 0 (gyro alone)
WINDOW = DOF + 1  # s
GYRO_NOISE = DOF + 2  # rad/s/sqrt(Hz)
BIAS_DRIFT = DOF + 3  # rad/s/sqrt(s)
SCALE_DRIFT = DOF + 4  # 1/sqrt(s)
RATE_NOISE = DOF + 5  # 1/sqrt(Hz)
VELOCITY_NOISE = DOF + 6  # m/s/sqrt(Hz)
HEADING_NOISE = DOF + 7  # rad/sqrt(Hz)
FIELD_SPREAD = DOF + 8  # 1, of the norm of the field
FIELD_RELEASE = DOF + 9  # s
FIELD_MEMORY = DOF + 10  # s
REST_GYRO = DOF + 11  # rad/s
REST_ACCEL = DOF + 12  # m/s^2
PARAMETERS = DOF + 13

# m/s^2
GRAVITY = 9.80665

# rad: an answer whose tilt is known worse than that is still finding its level.
_LEVEL = 0.06

# rad: a magnetometer that reads the same to the last bit while it turns by this has died.
_STUCK = 0.35

# The window is summed in this many parts where its effect on the attitude is linearised.
_PARTS = 16.0

# s: rounded time stamps must not make every other window a sample longer.
ROUNDING = 5e-10

# rad/s/sqrt(Hz): how well a gyro mean at rest is known; twice what a phone's gyro has, for table and hand.
_REST_GYRO_NOISE = 5e-4

# m/s/sqrt(Hz): the same for the velocity of a sensor at rest.
_REST_VELOCITY_NOISE = 0.02

# s: rest is believed after this time; the same length of gyro readings makes a bias.
_STRETCH = 0.5

# Standard deviations by which a mean at rest may differ from the known bias; more is a slow rotation.
_REST_GATE = 4.0

# rad/s/sqrt(Hz): what is known of the rate while the gyro is missing.
_MISSING_NOISE = 1.0


@kernel
def sum_turn(state: Array, params: Array) -> None:
    """Add how bias and scale have turned the attitude since this was last asked."""
    dt = state[at.LENGTH] - state[at.SUMMED]
    for i in range(9):
        state[at.TURN_BY_BIAS + i] -= state[at.R + i] * dt
    for k in range(3):
        turn = state[at.GYRO_SUM + k] - state[at.SUMMED + 1 + k]
        for i in range(9):
            state[at.TURN_BY_SCALE + 9 * k + i] -= state[at.R + i] * turn
        state[at.SUMMED + 1 + k] = state[at.GYRO_SUM + k]
    state[at.SUMMED] = state[at.LENGTH]
    state[at.NEXT_PART] = min(state[at.LENGTH] + params[WINDOW] / _PARTS, params[WINDOW]) - ROUNDING


@kernel
def _propagate(state: Array, params: Array, P: Array) -> None:
    """P over the window: P <- F P F^T + Q, where only the rows of attitude and velocity of F are not trivial."""
    n = at.ERRORS
    # Velocity first, for it grows with the tilt at the beginning. True gravity rather than the force that was
    # seen: an answer that stands on its head must not find itself at rest there.
    g = GRAVITY * state[at.ACCEL_TIME]
    for j in range(n):
        P[3, j] += g * P[1, j]
        P[4, j] -= g * P[0, j]
    for j in range(n):
        P[j, 3] += g * P[j, 1]
        P[j, 4] -= g * P[j, 0]
    for i in range(3):
        for k in range(3):
            g = state[at.TURN_BY_BIAS + 3 * i + k]
            for j in range(n):
                P[i, j] += g * P[at.B + k, j]
        for k in range(9):
            g = state[at.TURN_BY_SCALE + 9 * (k // 3) + 3 * i + k % 3]
            for j in range(n):
                P[i, j] += g * P[at.C + k, j]
    for j in range(n):
        for i in range(3):
            g = 0.0
            for k in range(3):
                g += state[at.TURN_BY_BIAS + 3 * i + k] * P[j, at.B + k]
            for k in range(9):
                g += state[at.TURN_BY_SCALE + 9 * (k // 3) + 3 * i + k % 3] * P[j, at.C + k]
            P[j, i] += g
    dt = state[at.LENGTH]
    q = dt * params[GYRO_NOISE] ** 2 + state[at.GYRO_SQUARES] * params[RATE_NOISE] ** 2 + state[at.MISSING] * _MISSING_NOISE**2
    for i in range(3):
        P[i, i] += q
        P[at.B + i, at.B + i] += dt * params[BIAS_DRIFT] ** 2
    for i in range(9):
        P[at.C + i, at.C + i] += dt * params[SCALE_DRIFT] ** 2


@kernel
def _observe(state: Array, P: Array, i: int, error: float, variance: float) -> None:
    """Take in that error i is `error`, known to `variance`."""
    n = at.ERRORS
    x, column = state[at.CORRECTION : at.CORRECTION + n], state[at.COLUMN : at.COLUMN + n]
    column[:] = P[i]
    k = 1.0 / (column[i] + variance)
    innovation = k * (error - x[i])
    for a in range(n):
        x[a] += column[a] * innovation
        g = column[a] * k
        for b in range(n):
            P[a, b] -= g * column[b]


@kernel
def _is_still(state: Array, params: Array, P: Array) -> bool:
    """Whether this window's readings scatter like noise, around a rate that the known bias explains."""
    dt, da = state[at.LENGTH], state[at.ACCEL_TIME]
    gyro, accel = scaled(1.0 / dt, load(state, at.GYRO_SUM)), load(state, at.ACCEL_SUM)
    if da < 0.5 * dt or state[at.MISSING] > 0.0:
        return False
    scatter = state[at.GYRO_SQUARES] / dt - dot(gyro, gyro)
    shake = (state[at.ACCEL_SQUARES] - dot(accel, accel) / da) / da
    for i in range(3):
        spread = P[at.B + i, at.B + i] + _REST_GYRO_NOISE**2 / dt
        if (gyro[i] - state[at.BIAS + i]) ** 2 > _REST_GATE**2 * spread:
            return False
    return scatter < params[REST_GYRO] ** 2 and shake < params[REST_ACCEL] ** 2


@kernel
def _clear(state: Array, first: int, past: int) -> None:
    for i in range(first, past):
        state[i] = 0.0


@kernel
def _learn_at_rest(state: Array, P: Array) -> None:
    """The gyro's mean over a stretch of rest is its bias, if another stretch came before it and one follows.

    Rest begins with the end of a motion and ends with the beginning of one, below any threshold.
    """
    for i in range(3):
        state[at.STRETCH + i] += state[at.GYRO_SUM + i]
    state[at.STRETCH + 3] += state[at.LENGTH]
    if state[at.STRETCH + 3] < _STRETCH:
        return
    dt = state[at.WAITING + 3]
    if dt > 0.0:
        for i in range(3):
            error = state[at.BIAS + i] - state[at.WAITING + i] / dt
            _observe(state, P, at.B + i, error, _REST_GYRO_NOISE**2 / dt)
    first = state[at.REST_TIME] < 1.5 * _STRETCH
    for i in range(4):
        state[at.WAITING + i] = 0.0 if first else state[at.STRETCH + i]
    _clear(state, at.STRETCH, at.STRETCH + 4)


@kernel
def _watch_rest(state: Array, params: Array, P: Array) -> bool:
    """Keep account of rest, and learn the bias from it."""
    if not _is_still(state, params, P):
        state[at.REST_TIME] = 0.0
        _clear(state, at.STRETCH, at.STRETCH + 4)
        _clear(state, at.WAITING, at.WAITING + 4)
        return False
    state[at.REST_TIME] += state[at.LENGTH]
    _learn_at_rest(state, P)
    return state[at.REST_TIME] >= _STRETCH


@kernel
def _observe_velocity(state: Array, params: Array, P: Array, rest: bool) -> None:
    noise = _REST_VELOCITY_NOISE if rest else params[VELOCITY_NOISE]
    # Without samples the sum says nothing new.
    if state[at.ACCEL_TIME] > 0.0:
        for i in range(2):
            _observe(state, P, at.V + i, state[at.VELOCITY + i], noise**2 / state[at.ACCEL_TIME])


@kernel
def _learn_field(state: Array, params: Array, level: float, up: float, trust: float) -> None:
    """The reference is the mean of the first while, and then follows slowly what is trusted."""
    state[at.FIELD_TIME] += state[at.LENGTH]
    if state[at.FIELD_TIME] < params[FIELD_MEMORY]:
        trust = 1.0
    k = trust * state[at.LENGTH] / min(state[at.FIELD_TIME], params[FIELD_MEMORY])
    state[at.FIELD] += k * (level - state[at.FIELD])
    state[at.FIELD + 1] += k * (up - state[at.FIELD + 1])


@kernel
def _consider_field(state: Array, params: Array, P: Array, level: float, up: float) -> None:
    """A field that stays the same in N while the body moves is the world's, whatever the reference says.

    Iron on the body fails this test; a start beside iron, or another room, passes after FIELD_MEMORY of motion.
    The heading may then be off by as much as the reference was.
    """
    spread2 = (2.0 * params[FIELD_SPREAD]) ** 2 * (level**2 + up**2)
    k = min(1.0, 4.0 * state[at.LENGTH] / params[FIELD_MEMORY])
    a, b = level - state[at.CANDIDATE], up - state[at.CANDIDATE + 1]
    state[at.CANDIDATE] += k * a
    state[at.CANDIDATE + 1] += k * b
    state[at.CANDIDATE + 2] += k * (0.5 * (a * a + b * b) - state[at.CANDIDATE + 2])
    state[at.STEADY] += state[at.LENGTH]
    if state[at.CANDIDATE + 2] > spread2:
        state[at.STEADY] = 0.0
    a, b = state[at.CANDIDATE] - state[at.FIELD], state[at.CANDIDATE + 1] - state[at.FIELD + 1]
    if state[at.STEADY] > params[FIELD_MEMORY] and a * a + b * b > 2.0*spread2:
        state[at.FIELD], state[at.FIELD + 1] = state[at.CANDIDATE], state[at.CANDIDATE + 1]
        P[2, 2] += min(1.0, (a * a + b * b) / level**2)
        state[at.DEVIATION] = state[at.STEADY] = 0.0


@kernel
def _observe_field(state: Array, params: Array, P: Array, rest: bool) -> float:
    """Heading from the field, trusted as far as its norm and dip are those of the reference; at.DISTURBED or 0.

    A disturbance that adds as much along each axis turns the heading by as much as it changes norm and dip:
    these two known components tell how far to believe the third.
    """
    k = 1.0 / state[at.MAG_COUNT]
    east, north, up = scaled(k, load(state, at.MAG_SUM))
    level = math.hypot(east, north)
    if state[at.FIELD_TIME] == 0.0:
        state[at.FIELD], state[at.FIELD + 1] = level, up
        state[at.CANDIDATE], state[at.CANDIDATE + 1] = level, up
    norm = math.hypot(state[at.FIELD], state[at.FIELD + 1])
    stretched = math.hypot(level, up) - norm
    dipped = norm * (math.atan2(up, level) - math.atan2(state[at.FIELD + 1], state[at.FIELD]))
    deviation = 0.5 * (stretched**2 + dipped**2)
    # A peak is kept for a while: what disturbed a moment ago is still near.
    state[at.DEVIATION] *= math.exp(-state[at.LENGTH] / params[FIELD_RELEASE])
    state[at.DEVIATION] = max(deviation, state[at.DEVIATION])
    tilt = 0.5 * (P[0, 0] + P[1, 1])
    if tilt > _LEVEL**2:
        # What is not level knows neither heading nor dip: both follow the latest window.
        P[2, 2] += 1.0
        state[at.FIELD], state[at.FIELD + 1] = level, up
        state[at.DEVIATION] = state[at.FIELD_TIME] = 0.0
    doubt = 1.0 + state[at.DEVIATION] / (norm**2 * (params[FIELD_SPREAD] ** 2 + tilt))
    # An answer of the arc tangent in -pi .. pi, whatever the declination.
    cos_d, sin_d = params[at.DECLINATION], params[at.DECLINATION + 1]
    error = math.atan2(sin_d * north - cos_d * east, cos_d * north + sin_d * east)
    before = state[at.CORRECTION + 2]
    variance = (doubt * params[HEADING_NOISE]) ** 2 / state[at.LENGTH] + tilt * (up / level) ** 2
    before = state[at.CORRECTION + 2]
    _observe(state, P, 2, error, variance)
    state[at.HEADING] -= state[at.CORRECTION + 2] - before
    _learn_field(state, params, level, up, 1.0 / doubt)
    if not rest:
        _consider_field(state, params, P, level, up)
    return at.DISTURBED if doubt > 2.0 else 0.0


@kernel
def _correct(state: Array) -> None:
    x = state[at.CORRECTION : at.CORRECTION + at.ERRORS]
    turn_rows(state, (-x[0], -x[1], -x[2]))
    for i in range(2):
        state[at.VELOCITY + i] -= x[at.V + i]
    for i in range(3):
        state[at.BIAS + i] -= x[at.B + i]
    for i in range(9):
        state[at.SCALE + i] -= x[at.C + i]


@kernel
def turn_rows(state: Array, theta: Vector) -> None:
    """R_NS <- Exp(theta) R_NS for theta in N, orthonormal to round-off."""
    east, north, up = load(state, at.R), load(state, at.R + 3), load(state, at.R + 6)
    x, y, z = rotated(theta, (1.0, 0.0, 0.0)), rotated(theta, (0.0, 1.0, 0.0)), rotated(theta, (0.0, 0.0, 1.0))
    new_east = unit(combined((x[0], y[0], z[0]), east, north, up))
    new_up = combined((x[2], y[2], z[2]), east, north, up)
    new_up = unit(added(new_up, -dot(new_up, new_east), new_east))
    store(state, at.R, new_east)
    store(state, at.R + 3, cross(new_up, new_east))
    store(state, at.R + 6, new_up)


@kernel
def close_window(state: Array, params: Array) -> None:
    """Turn the sums of a window into corrections, and begin the next one."""
    n = at.ERRORS
    P = state[at.COVARIANCE : at.COVARIANCE + n * n].reshape(n, n)
    calm = 0.0
    _clear(state, at.CORRECTION, at.CORRECTION + n)
    if params[DOF] > 0.0 and state[at.LEVELLED] == 1.0:
        _propagate(state, params, P)
        for i in range(2):
            state[at.VELOCITY + i] += state[at.FORCE_SUM + i]
        rest = _watch_rest(state, params, P)
        _observe_velocity(state, params, P, rest)
        calm = at.REST if rest else 0.0
        if params[DOF] == 9.0 and state[at.MAG_COUNT] > 0.0:
            if state[at.STUCK] > _STUCK:
                calm += at.DISTURBED
            else:
                calm += _observe_field(state, params, P, rest)
    _correct(state)
    _clear(state, at.SUMS, at.SUMS_END)
    state[at.MISSING] = 0.0
    state[at.NEXT_PART] = params[WINDOW] / _PARTS - ROUNDING
    if state[at.LEVELLED] == 1.0:
        state[at.CALM] = calm
