"""Turns what a window summed into what its errors can be: the covariance matrix P, carried on and observed.

Errors are estimate less truth: R_est = Exp(theta) R_true, and theta' = -R (bias + C gyro).
"""

from kreisel.estimate.filters.dcm import layout as at
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array

GRAVITY = 9.80665  # m/s^2


@kernel
def propagate(state: Array, params: Array, P: Array) -> None:
    """P <- F P F^T + Q over the window; only attitude and velocity have rows in F that are not trivial."""
    n, turn = P.shape[0], at.TURN
    # True gravity rather than the force that was seen: an answer that stands on its head must not find itself
    # at rest there. Velocity first, for it grows with the tilt that was there at the beginning.
    g = GRAVITY * state[at.ACCEL_TIME]
    for j in range(n):
        P[at.V, j] += g * P[1, j]
        P[at.V + 1, j] -= g * P[0, j]
    for i in range(3):
        for k in range(at.CONSTANTS):
            f = state[turn + at.CONSTANTS * i + k]
            for j in range(n):
                P[i, j] += f * P[at.B + k, j]
    # F P is done, and (F P) F^T differs from it in the first columns only, which below are known by symmetry.
    for j in range(at.B):
        P[j, at.V] += g * P[j, 1]
        P[j, at.V + 1] -= g * P[j, 0]
        for i in range(3):
            for k in range(at.CONSTANTS):
                P[j, i] += state[turn + at.CONSTANTS * i + k] * P[j, at.B + k]
    for j in range(at.B, n):
        for i in range(at.B):
            P[j, i] = P[i, j]
    _add_noise(state, params, P)


@kernel
def _add_noise(state: Array, params: Array, P: Array) -> None:
    dt = state[at.LENGTH]
    theta = dt * params[at.GYRO_NOISE] ** 2
    theta += state[at.GYRO_SQUARES] * params[at.RATE_NOISE] ** 2
    theta += state[at.MISSING]
    for i in range(3):
        P[i, i] += theta
        P[at.B + i, at.B + i] += dt * params[at.BIAS_DRIFT] ** 2
    for i in range(at.C, at.ERRORS):
        P[i, i] += dt * params[at.SCALE_DRIFT] ** 2


@kernel
def observe(state: Array, P: Array, i: int, error: float, variance: float) -> None:
    """Take in that error i is `error`, known to `variance`; what follows for all is added to CORRECTION."""
    for a in range(P.shape[0]):
        state[at.COLUMN + a] = P[i, a]
    correct(state, P, error - state[at.CORRECTION + i], P[i, i] + variance)


@kernel
def correct(state: Array, P: Array, surprise: float, variance: float) -> None:
    """Take in a `surprise` of this `variance`, whose covariances with all errors are in COLUMN."""
    n = P.shape[0]
    x, column = state[at.CORRECTION : at.CORRECTION + n], state[at.COLUMN : at.COLUMN + n]
    k = 1.0 / variance
    step = k * surprise
    for a in range(n):
        x[a] += column[a] * step
        gain = column[a] * k
        for b in range(n):
            P[a, b] -= gain * column[b]
