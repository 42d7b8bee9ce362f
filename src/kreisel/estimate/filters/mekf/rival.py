"""Turns an answer in doubt into a contest: a second filter begins anew beside it, and the better one goes on.

Whatever taught a filter wrong constants, a wrong field or a wrong attitude, one that begins later has not seen it.
While the answer is surprised more than most motions surprise, such a rival runs beside it; where it turns out to
foretell velocity and field by far better, it is the answer.
"""

import math

from kreisel.estimate.filters.dcm.window import turn_world
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.begin import begin
from kreisel.estimate.filters.mekf.lost import renew
from kreisel.estimate.filters.mekf.one import step
from kreisel.estimate.filters.mekf.score import begin_score, is_better
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, Vector, dot, load

# m/s/sqrt(Hz): noise of the velocity beyond which an answer is in doubt.
_DOUBT = 1.0

# s: a rival finds its level until the first, and is judged at the second.
_SETTLED, _JUDGED = 10.0, 25.0

# s: the age of one that has seen nothing yet.
_BEGUN = 1e-9

# s of motion in which both were judged.
_LEAST = 7.0


@kernel
def attend(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move the rival, if any, over a sample that `state` has seen, and let one begin, lose or win."""
    rival = state[at.RIVAL : at.RIVAL + at.ONE]
    if state[at.AGE] > 0.0:
        _follow(state, rival, params, gyro, accel, mag, dt)
    # At the end of a window, so that whoever looks back sees it.
    if state[at.AGE] > _JUDGED and state[at.LENGTH] == 0.0:
        if rival[at.LEVELLED] == 1.0 and rival[at.CHANGED] == 0.0 and is_better(rival, state, _LEAST):
            _win(state, rival)
        state[at.AGE] = 0.0
    doubted = state[at.WANDERING] > _DOUBT**2 and state[at.LEVELLED] == 1.0 and params[at.DOF] > 0.0
    if state[at.AGE] == 0.0 and doubted:
        begin(rival, params)
        state[at.AGE] = _BEGUN
    state[at.DUE] = state[at.AGE]


@kernel
def _follow(
    state: Array, rival: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float
) -> None:
    """The rival's step over this sample; once it has settled, both are judged."""
    before = state[at.AGE]
    step(rival, params, gyro, accel, mag, dt)
    state[at.AGE] += dt
    if before < _SETTLED <= state[at.AGE]:
        begin_score(state)
        begin_score(rival)


@kernel
def _win(state: Array, rival: Array) -> None:
    """The rival's state is the answer, which knows nothing about what was before."""
    turned = _turned(rival, state)
    if rival[at.FIELD_TIME] == 0.0:
        # It has no heading of its own.
        turn_world(rival, (0.0, 0.0, -turned))
        n = at.ERRORS
        P = rival[at.COVARIANCE : at.COVARIANCE + n * n].reshape(n, n)
        renew(P, 2, state[at.COVARIANCE + 2 * (n + 1)])
        turned = 0.0
    rival[at.HEADING] = state[at.HEADING] + turned
    rival[at.WINDOWS] = state[at.WINDOWS]
    for i in range(at.ONE):
        state[i] = rival[i]
    for i in range(at.CORRECTION, at.CHANGE):
        state[i] = 0.0
    state[at.OBSERVED] = 0.0
    state[at.CHANGE_FORCE] = at.NOTHING


@kernel
def _turned(to: Array, of: Array) -> float:
    """By how much the answer `to` is turned about up against the answer `of`."""
    east, north = load(to, at.R_NS), load(to, at.R_NS + 3)
    x, y = load(of, at.R_NS), load(of, at.R_NS + 3)
    return math.atan2(dot(north, x) - dot(east, y), dot(east, x) + dot(north, y))
