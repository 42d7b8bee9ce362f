"""Turns the sums of a window into corrections of attitude, gyro bias and gyro scale.

The specific force in N, summed, is a velocity. That of a body which stays about its place stays small, that of one
which travels stays about the same in its own axes, while a tilt makes it run away by gravity times tilt. The field in
N, averaged, gives the heading. Bias and scale follow from how these errors grow with time and with rotation.
"""

from kreisel.estimate.filters.dcm.window import linearise, turn_world
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.covariance import known_to, propagate
from kreisel.estimate.filters.mekf.field import observe_field
from kreisel.estimate.filters.mekf.level import level
from kreisel.estimate.filters.mekf.lost import begin_again, is_lost
from kreisel.estimate.filters.mekf.rest import watch_rest
from kreisel.estimate.filters.mekf.score import keep_score
from kreisel.estimate.filters.mekf.velocity import observe_velocity
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, Vector, dot, load, scaled

# The window is summed in this many parts where its effect on the attitude is linearised.
_PARTS = 8.0

# s: rounded time stamps must not make every other window a sample longer.
_ROUNDING = 5e-10


@kernel
def close_part(state: Array, params: Array) -> None:
    """Linearise a part of the window, and close the window with its last part."""
    linearise(state, at.LENGTH, at.TURN)
    if state[at.LENGTH] >= params[at.WINDOW] - _ROUNDING:
        _close_window(state, params)
    next_part = state[at.LENGTH] + params[at.WINDOW] / _PARTS
    state[at.NEXT_PART] = min(next_part, params[at.WINDOW]) - _ROUNDING


@kernel
def _close_window(state: Array, params: Array) -> None:
    for i in range(at.CORRECTION, at.CHANGE):
        state[i] = 0.0
    state[at.OBSERVED] = 0.0
    state[at.CHANGE_FORCE] = at.NOTHING
    if state[at.CHANGED] > 0.0:
        level(state, params)
    elif state[at.LEVELLED] == 1.0:
        state[at.CALM] = _correct(state, params)
        keep_score(state)
        turn_world(state, scaled(-1.0, load(state, at.CORRECTION)))
        _look_after(state, params)
    state[at.WINDOWS] += 1.0
    state[at.DUE] = 1.0
    for i in range(at.SUMS, at.SUMS_END):
        state[i] = 0.0
    state[at.MISSING] = 0.0


@kernel
def _look_after(state: Array, params: Array) -> None:
    """Begin again where the answer is lost, and say how well it is known."""
    n = at.ERRORS
    P = state[at.COVARIANCE : at.COVARIANCE + n * n].reshape(n, n)
    if params[at.DOF] > 0.0 and is_lost(state, P):
        begin_again(state, P)
        state[at.CHANGE_FORCE] = at.NOTHING
        state[at.OBSERVED] = 0.0
    for i in range(3):
        state[at.SIGMA + i] = known_to(i, P[i, i], state[at.EXCESS])


@kernel
def _correct(state: Array, params: Array) -> float:
    """Find the errors and take them from all but the attitude; the flags of this window."""
    n = at.ERRORS
    P = state[at.COVARIANCE : at.COVARIANCE + n * n].reshape(n, n)
    travel = load(state, at.TRAVEL)
    propagate(state, params, P)
    if params[at.DOF] == 0.0:
        return 0.0
    _sum_ways(state, travel)
    rest = watch_rest(state, params, P)
    observe_velocity(state, params, P, rest)
    flags = float(at.REST) if rest else 0.0
    if params[at.DOF] == 9.0 and state[at.MAG_COUNT] > 0.0:
        flags += observe_field(state, params, P, rest)
    _take_back(state)
    return flags


@kernel
def _sum_ways(state: Array, travel: Vector) -> None:
    """Sum force to velocity, and velocity less `travel` to the way of this span."""
    share = state[at.ACCEL_TIME] / state[at.LENGTH]
    for i in range(2):
        # TURN of the gyro's bias is minus the integral of R, which takes anything fixed to the sensor to N.
        back = load(state, at.TURN + at.CONSTANTS * i)
        state[at.VELOCITY + i] += state[at.FORCE_SUM + i] + share * dot(back, load(state, at.ACCEL_BIAS))
        # A force that is late belongs to the attitude of a moment ago.
        state[at.VELOCITY + i] -= state[at.LAG] * state[at.LAG_SUM + i]
        begun = state[at.MADE + i] if state[at.SPAN] > 0.0 else 0.0
        state[at.MADE + i] = begun + state[at.LENGTH] * state[at.VELOCITY + i] + dot(back, travel)
    state[at.SPAN] += state[at.LENGTH]


@kernel
def _take_back(state: Array) -> None:
    """Take the errors that were found from all but the attitude."""
    x = at.CORRECTION
    for i in range(2):
        state[at.VELOCITY + i] -= state[x + at.V + i]
        state[at.MADE + i] -= state[x + at.S + i]
    for i in range(3):
        state[at.TRAVEL + i] -= state[x + at.U + i]
        state[at.GYRO_BIAS + i] -= state[x + at.B + i]
        state[at.ACCEL_BIAS + i] -= state[x + at.A + i]
    for i in range(9):
        state[at.SCALE + i] -= state[x + at.C + i]
    state[at.TURNED] -= state[x + at.D]
    state[at.LAG] -= state[x + at.L]
