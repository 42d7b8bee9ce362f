"""Turns gyro, accelerometer and magnetometer samples into attitude by the DCM tutorial's step, to the letter.

The document calls the axes of its world I (north), J (west) and K (up) and moves them as seen from the body;
in ENU the rows of R_NS are east = -J, north = I and up = K. Its gyro shows the world turning, w = -omega_NS_S,
and its accelerometer shows gravity, so that K = +f / abs(f) for a specific force f.
"""

import math

from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.start import bridge, is_rate, start
from kreisel.estimate.filters.dcm.vectors import (
    NONE,
    Array,
    Vector,
    added,
    cross,
    dot,
    inverse_root_near_one,
    load,
    norm,
    rotated,
    scaled,
    store,
)
from kreisel.maths.kernels import inlined, kernel


@inlined
def _at_step(weight: float, own: float, periods: float) -> float:
    """The weight that forgets as much in this step as the given one does in so many of its own periods."""
    return own * math.expm1(periods * math.log1p(weight / own))


@inlined
def _orthonormal(east: Vector, north: Vector) -> tuple[Vector, Vector, Vector]:
    """Both corrected by half of what they lack to a right angle, made unit vectors, and up = east x north."""
    ee, nn, half = dot(east, east), dot(north, north), 0.5 * dot(east, north)
    # The norms of the corrected vectors from these three products: they need not wait for the vectors.
    half2 = half * half
    k_e = inverse_root_near_one(ee - half2 * (4.0 - nn))
    k_n = inverse_root_near_one(nn - half2 * (4.0 - ee))
    e, n = added(east, -half, north), added(north, -half, east)
    return scaled(k_e, e), scaled(k_n, n), scaled(k_e * k_n, cross(e, n))


@inlined
def _step(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move `state` over the `dt` seconds that end with these samples."""
    waits = state[at.LEVELLED] == 0.0 or state[at.NORTHED] < params[at.START_NORTH]
    if (waits and start(state, params, accel, mag)) or not dt > 0.0:
        return
    state[at.FLAGS] = state[at.CALM]
    # East is -J: what moves or corrects J does the same to it.
    east, north, up = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    if is_rate(gyro):
        state[at.GAP] = 0.0
        store(state, at.RATE, gyro)
    else:
        gyro = bridge(state, params, dt)
    turn = scaled(-dt, gyro)
    w_g, w_a, w_m = params[at.WEIGHT_GYRO], params[at.WEIGHT_ACCEL], params[at.WEIGHT_MAG]
    if params[at.RATE_HZ] > 0.0:
        w_a = _at_step(w_a, w_g, dt * params[at.RATE_HZ])
        w_m = _at_step(w_m, w_g, dt * params[at.RATE_HZ])
    n_a = norm(accel)
    if n_a == 0.0:
        n_a, w_a, accel = 1.0, 0.0, NONE
    h = added(mag, -dot(up, mag), up)
    n_h = norm(h)
    if n_h == 0.0:
        n_h, w_m, h = 1.0, 0.0, NONE
    if params[at.DECLINATION] != 1.0:
        h = added(scaled(params[at.DECLINATION], h), params[at.DECLINATION + 1], cross(up, h))
    # The accelerometer sees rotations across `up`, a magnetometer made horizontal those around it; the
    # document divides by the sum of all weights nevertheless.
    across, around = 1.0 / (w_g + w_a), 1.0 / (w_g + w_m)
    if params[at.OBSERVED] == 0.0:
        across = around = 1.0 / (w_g + w_a + w_m)
    dtheta = added(scaled(w_g * across, turn), w_g * (around - across) * dot(turn, up), up)
    # K x (A - K) is K x A; each norm, slow to come, is divided out last.
    dtheta = added(dtheta, w_a * across / n_a, cross(up, accel))
    dtheta = added(dtheta, w_m * around / n_h, cross(north, h))
    if params[at.EXACT] == 1.0:
        east, north = rotated(dtheta, east), rotated(dtheta, north)
    else:
        east, north = added(east, 1.0, cross(dtheta, east)), added(north, 1.0, cross(dtheta, north))
    east, north, up = _orthonormal(east, north)
    store(state, at.R_NS, east)
    store(state, at.R_NS + 3, north)
    store(state, at.R_NS + 6, up)


@kernel
def update(state: Array, params: Array, sample: Array, dt: float) -> None:
    """One step, `sample` (9,) being gyro, accel and mag."""
    _step(state, params, load(sample, 0), load(sample, 3), load(sample, 6), dt)


@kernel
def batch(
    state: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, answers: Array
) -> None:
    """All steps; answers (n, at.ANSWER) are the head of the state after each."""
    for k in range(t.size):
        g = gyro[k, 0], gyro[k, 1], gyro[k, 2]
        a = accel[k, 0], accel[k, 1], accel[k, 2]
        m = mag[k, 0], mag[k, 1], mag[k, 2]
        _step(state, params, g, a, m, t[k] - t[max(k - 1, 0)])
        for i in range(at.ANSWER):
            answers[k, i] = state[i]
