"""Turns the velocity that forces sum to into corrections: near zero, but for what a body keeps in its own axes.

How near is learned from the surprises of the last seconds: a sensor on a turntable, in a hand, on a drone and in a
car differ
a hundredfold in what an acceleration may be, and a filter that knows which one it has is as good as one made for it.
"""

import math

from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.covariance import look, row_of_next, take
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, dot, load

# Standard deviations by which a velocity at rest may surprise; more is a body that has started or stopped.
_GATE = 3.0

# m/s/sqrt(Hz): how well the velocity of a sensor at rest is known to be zero.
_REST_NOISE = 0.02

# s: surprises are averaged over this time, for noise that is faster does not tilt; and judged over that.
_SLOW, _JUDGED = 2.0, 15.0

# s, for which an acceleration lasts in the turns of a drone or a car: a white one of the density a^2 T makes a velocity
# that wanders like noise of a T^(3/2).
_PUSH_TIME = 2.0

# s, for which what is known of the noise before counts.
_BEFORE = 3.0


@kernel
def observe_velocity(state: Array, params: Array, P: Array, rest: bool) -> None:
    """Velocity is travel, give or take what a body moves; a window without samples does not say so again."""
    seconds = state[at.ACCEL_TIME]
    if rest and seconds > 0.0:
        for i in range(2):
            _observe(state, P, i, _REST_NOISE**2 / seconds)
        state[at.SPAN] = 0.0
    elif state[at.SPAN] >= params[at.SPAN_LENGTH] - 1e-6:
        noise2 = _noise2(state, params)
        for i in range(2):
            state[row_of_next(state) + at.S + i] = 1.0
            known, own = look(state, P)
            surprise, variance = state[at.MADE + i] - known, own + noise2 * state[at.SPAN]
            tail = params[at.TAIL]
            take(state, P, surprise, variance * max(1.0, (tail + surprise**2 / variance) / (tail + 1.0)))
        _judge(state, params, state[at.SPAN])
        state[at.SPAN] = 0.0


@kernel
def _noise2(state: Array, params: Array) -> float:
    """Squared noise of the velocity, as the last seconds and, if that is more, the last two show it."""
    now = _SLOW * (state[at.SURPRISE] ** 2 + state[at.SURPRISE + 1] ** 2)
    noise2 = max(state[at.ROAMING], 0.25 * now, params[at.VELOCITY_NOISE] ** 2)
    noise2 = min(noise2, _most2(state, params))
    # About half of the tilt's variance is that of the velocity, and grows with what its noise is in fact.
    state[at.EXCESS] = max(1.0, 0.5 + 0.5 * state[at.WANDERING] / noise2)
    return noise2


@kernel
def _most2(state: Array, params: Array) -> float:
    """Square of the most that the noise may be: forces that add to the square of gravity are no tilt of it."""
    pushes2 = state[at.MEAN_SQUARE] - GRAVITY**2
    return max(params[at.VELOCITY_NOISE + 1] ** 2, _PUSH_TIME**3 * pushes2)


@kernel
def _judge(state: Array, params: Array, seconds: float) -> None:
    """Let this window's surprises into what is known of the noise."""
    last = at.OBSERVATIONS + (int(state[at.OBSERVED]) - 1) * at.OBSERVATION + 2 * at.ERRORS
    k = 1.0 - math.exp(-seconds / _SLOW)
    now = 0.0
    for i in range(2):
        surprise = state[last - (1 - i) * at.OBSERVATION] / seconds
        state[at.SURPRISE + i] += k * (surprise - state[at.SURPRISE + i])
        # White noise of density N^2 has the variance N^2 / (2 time constant) after a low-pass of first order.
        now += _SLOW * state[at.SURPRISE + i] ** 2
    state[at.JUDGED] = min(state[at.JUDGED] + seconds, _JUDGED)
    # The low-pass began with nothing.
    now /= 1.0 - math.exp(-2.0 * state[at.JUDGED] / _SLOW)
    k = 1.0 - math.exp(-seconds / min(state[at.JUDGED] + _BEFORE, _JUDGED))
    state[at.WANDERING] += k * (now - state[at.WANDERING])
    now = min(now, _most2(state, params))
    state[at.ROAMING] += k * (now - state[at.ROAMING])


@kernel
def _observe(state: Array, P: Array, i: int, variance: float) -> None:
    """Velocity i is the travel's, to `variance`. Rest may be steady travel: no sensor can tell."""
    up = load(state, at.R_NS + 3 * i)
    row = row_of_next(state)
    state[row + at.V + i] = 1.0
    for j in range(3):
        state[row + at.U + j] = -up[j]
    known, own = look(state, P)
    surprise = state[at.VELOCITY + i] - dot(up, load(state, at.TRAVEL)) - known
    variance += own
    if surprise**2 > _GATE**2 * variance:
        # The travel may have changed by as much along each axis.
        for j in range(3):
            P[at.U + j, at.U + j] += surprise**2
        variance += look(state, P)[1] - own
    take(state, P, surprise, variance)
