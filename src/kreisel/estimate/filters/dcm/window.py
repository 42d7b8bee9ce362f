"""Turns the sums of a window into corrections of attitude, gyro bias and gyro scale.

The specific force in N, summed, is a velocity. That of a body which stays about its place stays small, that of one
which travels stays about the same in its own axes, while a tilt makes it run away by gravity times tilt: so the
force is low-passed before it corrects the inclination. With bias and scale settled the correction is a Butterworth
filter of second order. The field in N, averaged, gives the heading. Bias and scale follow from how these errors
grow with time and with rotation.
"""

from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.covariance import propagate
from kreisel.estimate.filters.dcm.field import observe_field
from kreisel.estimate.filters.dcm.rest import watch_rest
from kreisel.estimate.filters.dcm.travel import forget_travel, observe_velocity
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import (
    Array,
    Vector,
    added,
    combined,
    cross,
    dot,
    load,
    rotated,
    store,
    unit,
)

# The window is summed in this many parts where its effect on the attitude is linearised.
_PARTS = 16.0

# s: rounded time stamps must not make every other window a sample longer.
_ROUNDING = 5e-10

# m/s/sqrt(Hz): how well the velocity of a sensor at rest is known to be zero.
_REST_NOISE = 0.02


@kernel
def close_part(state: Array, params: Array) -> None:
    """Linearise a part of the window, and close the window with its last part."""
    linearise(state, at.LENGTH, at.TURN)
    if is_over(state[at.LENGTH], params):
        close_window(state, params)
    state[at.NEXT_PART] = next_part(state[at.LENGTH], params)


@kernel
def linearise(state: Array, length: int, turn: int) -> None:
    """What an error of the constants turns the attitude by, in the part of the window since the last one.

    length: place in the state of the window's length, behind which is the sum of the gyro; turn: of the matrix, behind
    which are length and sum that it holds already.
    """
    summed = turn + 3 * at.CONSTANTS
    dt = state[length] - state[summed]
    moved = added(load(state, length + 1), -1.0, load(state, summed + 1))
    for i in range(3):
        row = turn + at.CONSTANTS * i
        for j in range(3):
            r = state[at.R_NS + 3 * i + j]
            state[row + j] -= r * dt
            state[row + 3 + j] -= r * moved[0]
            state[row + 6 + j] -= r * moved[1]
            state[row + 9 + j] -= r * moved[2]
    state[summed] = state[length]
    store(state, summed + 1, load(state, length + 1))


@inlined
def is_over(length: float, params: Array) -> bool:
    """Whether a window of this length is one."""
    return length >= params[at.WINDOW] - _ROUNDING


@inlined
def next_part(length: float, params: Array) -> float:
    """s into the window, when the part is due that begins at this length."""
    return min(length + params[at.WINDOW] / _PARTS, params[at.WINDOW]) - _ROUNDING


@kernel
def close_window(state: Array, params: Array) -> None:
    """Correct what the sums of a window, its last part among them, tell, and begin another."""
    if state[at.LEVELLED] == 1.0:
        state[at.CALM] = _correct(state, params) if params[at.DOF] > 0.0 else 0.0
    turn_world(state, (-state[at.CORRECTION], -state[at.CORRECTION + 1], -state[at.CORRECTION + 2]))
    for i in range(at.CORRECTION, at.CORRECTION + at.ERRORS):
        state[i] = 0.0
    for i in range(at.SUMS, at.SUMS_END):
        state[i] = 0.0
    state[at.MISSING] = 0.0


@kernel
def _correct(state: Array, params: Array) -> float:
    """Find the errors and take them from all but the attitude; the flags of this window."""
    n = at.ERRORS
    P = state[at.COVARIANCE : at.COVARIANCE + n * n].reshape(n, n)
    propagate(state, params, P)
    forget_travel(state, params, P)
    for i in range(2):
        state[at.VELOCITY + i] += state[at.FORCE_SUM + i]
    rest = watch_rest(state, params, P)
    _observe_velocity(state, params, P, rest)
    flags = float(at.REST) if rest else 0.0
    if params[at.DOF] == 9.0 and state[at.MAG_COUNT] > 0.0:
        flags += observe_field(state, params, P, rest)
    for i in range(2):
        state[at.VELOCITY + i] -= state[at.CORRECTION + at.V + i]
    for i in range(3):
        state[at.TRAVEL + i] -= state[at.CORRECTION + at.U + i]
        state[at.GYRO_BIAS + i] -= state[at.CORRECTION + at.B + i]
    for i in range(9):
        state[at.SCALE + i] -= state[at.CORRECTION + at.C + i]
    return flags


@kernel
def _observe_velocity(state: Array, params: Array, P: Array, rest: bool) -> None:
    """Velocity is travel, give or take what a body moves; a window without samples does not say so again."""
    noise = _REST_NOISE if rest else params[at.VELOCITY_NOISE]
    if state[at.ACCEL_TIME] > 0.0:
        for i in range(2):
            observe_velocity(state, P, i, noise**2 / state[at.ACCEL_TIME], rest)


@kernel
def turn_world(state: Array, theta: Vector) -> None:
    """R_NS <- Exp(theta) R_NS with theta in N, orthonormal to round-off."""
    east, north, up = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    # Rows of Exp(theta) are the columns of Exp(-theta).
    back = -theta[0], -theta[1], -theta[2]
    new_east = unit(combined(rotated(back, (1.0, 0.0, 0.0)), east, north, up))
    new_up = combined(rotated(back, (0.0, 0.0, 1.0)), east, north, up)
    new_up = unit(added(new_up, -dot(new_up, new_east), new_east))
    store(state, at.R_NS, new_east)
    store(state, at.R_NS + 3, cross(new_up, new_east))
    store(state, at.R_NS + 6, new_up)
