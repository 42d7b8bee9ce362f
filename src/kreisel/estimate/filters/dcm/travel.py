"""Turns the velocity that forces sum to into corrections: near zero, but for what a body keeps in its own axes.

What turns on its way has a velocity that is constant in its own axes, nose first, and so turns in N as it turns
itself. A constant gyro bias tips the answer just so: whoever takes that velocity for noise without memory learns a
bias from it. So it is an error of its own, in covariance with the others: what turns with the body is shared among
them by what each can be, nearly all to 1 m/s of travel and next to nothing to 0.5 deg/s of bias.
"""

import math

from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.covariance import correct
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, dot, load

# m/s: how fast what seems to stay about its place may yet creep on.
_CREEP = 0.1

# Standard deviations by which a velocity at rest may surprise; more is a body that has started or stopped.
_GATE = 3.0


@kernel
def forget_travel(state: Array, params: Array, P: Array) -> None:
    """A body keeps its travel for a time, and then may change it by as much as it has."""
    kept = math.exp(-state[at.LENGTH] / params[at.TRAVEL_TIME])
    travel = load(state, at.TRAVEL)
    spread2 = min(_CREEP**2 + dot(travel, travel) / 3.0, params[at.TRAVEL_SPREAD] ** 2)
    for i in range(3):
        state[at.TRAVEL + i] *= kept
        for j in range(P.shape[0]):
            P[at.U + i, j] *= kept
        for j in range(P.shape[0]):
            P[j, at.U + i] *= kept
        P[at.U + i, at.U + i] += spread2 * (1.0 - kept**2)


@kernel
def observe_velocity(state: Array, P: Array, i: int, variance: float, rest: bool) -> None:
    """Velocity i is the travel's, to `variance`. Rest may be steady travel: no sensor can tell."""
    n, x = P.shape[0], at.CORRECTION
    row = load(state, at.R_NS + 3 * i)
    for a in range(n):
        state[at.COLUMN + a] = P[at.V + i, a] - dot(row, (P[at.U, a], P[at.U + 1, a], P[at.U + 2, a]))
    surprise = state[at.VELOCITY + i] - dot(row, load(state, at.TRAVEL))
    surprise -= state[x + at.V + i] - dot(row, load(state, x + at.U))
    variance += state[at.COLUMN + at.V + i] - dot(row, load(state, at.COLUMN + at.U))
    if rest and surprise**2 > _GATE**2 * variance:
        variance += _doubt_travel(state, P, i, surprise**2)
    correct(state, P, surprise, variance)


@kernel
def _doubt_travel(state: Array, P: Array, i: int, change2: float) -> float:
    """Let the travel have changed by this mean square along each axis; the variance that it adds to velocity i."""
    row = load(state, at.R_NS + 3 * i)
    for j in range(3):
        P[at.U + j, at.U + j] += change2
        state[at.COLUMN + at.U + j] -= row[j] * change2
    return dot(row, row) * change2
