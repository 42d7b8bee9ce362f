"""Turns the first seconds of a start in full motion into a level, by the mean of the force that the gyro carries along.

One sample of an accelerometer that reads far from gravity says nothing about up, and linear corrections do not find
the way from there. Accelerations end, gravity does not: over T seconds the mean of the specific force is off by the
change of the velocity over gravity times T, whatever the attitude was taken for at first.
"""

import math

from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.estimate.filters.dcm.window import turn_world
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.lost import NEW_TILT, renew, to_up
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, Vector, added, load, norm, rotated, scaled, store

# m/s^2: a first sample that is that far from gravity has seen an acceleration of half of it at least, by which up may
# be off by 27 deg: more than a first sample is taken to leave open.
_FAR = 0.5 * GRAVITY

# s, after which the mean is as good as any.
_LONGEST = 6.0

# m/s: by how much velocity changes at least where accelerations are as large.
_LEAST_CHANGE = 1.0

# rad: rotation that nobody measured, after which the mean begins anew.
_MISSED = 0.1

# rad: what is known of up while nothing is.
_UNKNOWN = 1.0


@kernel
def seek(state: Array, params: Array, accel: Vector) -> None:
    """Begin to look for up where this first sample is no gravity."""
    if params[at.DOF] > 0.0 and abs(norm(accel) - GRAVITY) > _FAR:
        state[at.CHANGED] = _LEAST_CHANGE
        # Nothing but the gyro may turn N while forces are summed in it.
        state[at.NORTHED] = 1.0
        _forget(state)
        _know(state, _UNKNOWN)


@kernel
def level(state: Array, params: Array) -> None:
    """Level by the mean of the force since the start, and end the search once it is known well enough.

    The velocity's change along the mean is seen, for gravity is known; across it is taken to be as large.
    """
    if state[at.MISSING] > _MISSED**2:
        _forget(state)
    elif state[at.ACCEL_TIME] > 0.0:
        force = _mean(state)
        strength = norm(force)
        if strength > 0.0:
            _face(state, params, scaled(1.0 / strength, force))
        T = state[at.SOUGHT]
        state[at.CHANGED] = max(state[at.CHANGED], abs(strength - GRAVITY) * T)
        tilt = state[at.CHANGED] / (GRAVITY * T)
        _know(state, min(tilt, _UNKNOWN))
        if tilt < NEW_TILT or T > _LONGEST:
            state[at.CHANGED] = state[at.NORTHED] = 0.0


@kernel
def _mean(state: Array) -> Vector:
    """Mean of the force over the T seconds sought, weighted by t (T - t); this window is let into it."""
    seconds = state[at.ACCEL_TIME]
    t = state[at.SOUGHT] + 0.5 * seconds
    state[at.SOUGHT] += seconds
    force = load(state, at.FORCE_SUM)
    first = added(load(state, at.MOMENTS), t, force)
    second = added(load(state, at.MOMENTS + 3), t * t, force)
    store(state, at.MOMENTS, first)
    store(state, at.MOMENTS + 3, second)
    T = state[at.SOUGHT]
    return scaled(6.0 / T**3, added(scaled(T, first), -1.0, second))


@kernel
def _face(state: Array, params: Array, up: Vector) -> None:
    """Turn the answer so that `up` is up, and the field of this window points north."""
    upright = to_up(up)
    _turn(state, upright)
    if params[at.DOF] == 9.0 and state[at.MAG_COUNT] > 0.0:
        east, north, _ = rotated(upright, load(state, at.MAG_SUM))
        cos_d, sin_d = params[at.DECLINATION], params[at.DECLINATION + 1]
        error = math.atan2(sin_d * north - cos_d * east, cos_d * north + sin_d * east)
        _turn(state, (0.0, 0.0, -error))


@kernel
def _turn(state: Array, theta: Vector) -> None:
    """Turn the answer and all that is summed in N."""
    turn_world(state, theta)
    for i in range(0, 6, 3):
        store(state, at.MOMENTS + i, rotated(theta, load(state, at.MOMENTS + i)))


@kernel
def _forget(state: Array) -> None:
    state[at.SOUGHT] = 0.0
    for i in range(6):
        state[at.MOMENTS + i] = 0.0


@kernel
def _know(state: Array, tilt: float) -> None:
    n = at.ERRORS
    P = state[at.COVARIANCE : at.COVARIANCE + n * n].reshape(n, n)
    for i in range(2):
        renew(P, i, tilt**2)
        renew(P, at.V + i, state[at.CHANGED] ** 2)
        state[at.SIGMA + i] = tilt
