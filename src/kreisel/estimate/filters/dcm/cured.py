"""Gyro, accelerometer and magnetometer samples into attitude by the DCM filter's default step.

Each sample turns R_NS by Exp and adds to the sums of a short window; at the end of a window, `window.py` makes
them corrections of the attitude, the gyro bias and the gyro's scale.
"""

import math

from kreisel.estimate.filters.dcm import state as at
from kreisel.estimate.filters.dcm.start import bridge, is_rate, start
from kreisel.estimate.filters.dcm.vectors import (
    Array,
    Vector,
    added,
    combined,
    dot,
    exp_factors,
    load,
    scaled,
    store,
)
from kreisel.estimate.filters.dcm.window import ROUNDING, WINDOW, close_window, sum_turn
from kreisel.maths.kernels import inlined, kernel

# A specific force beyond this (m/s^2) is a fault, not a measurement.
_NO_FORCE = 1e5


@inlined
def _turned(rows: tuple[Vector, Vector, Vector], theta: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of R Exp(theta), given those of R."""
    x, y, z = theta
    s, c = exp_factors(dot(theta, theta))
    e0 = 1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y
    e1 = c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x
    e2 = c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)
    return combined(rows[0], e0, e1, e2), combined(rows[1], e0, e1, e2), combined(rows[2], e0, e1, e2)


@inlined
def _is_force(a2: float) -> bool:
    """Whether a squared specific force is a measurement: not NaN, not a dead sensor's zero, not absurd."""
    return 0.0 < a2 < _NO_FORCE * _NO_FORCE


@inlined
def _is_field(m2: float) -> bool:
    return 0.0 < m2 < 1e60


@inlined
def _step(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move `state` over the `dt` seconds that end with these samples."""
    waits = state[at.LEVELLED] == 0.0 or state[at.NORTHED] < params[at.START_NORTH]
    if (waits and start(state, params, accel, mag)) or not dt > 0.0:
        return
    state[at.FLAGS] = state[at.CALM]
    if is_rate(gyro):
        state[at.GAP] = 0.0
        store(state, at.RATE, gyro)
    else:
        gyro = bridge(state, params, dt)
    turn = scaled(dt, gyro)
    rows = load(state, at.R), load(state, at.R + 3), load(state, at.R + 6)
    false = combined(turn, load(state, at.SCALE), load(state, at.SCALE + 3), load(state, at.SCALE + 6))
    theta = added(added(turn, -1.0, false), -dt, load(state, at.BIAS))
    east, north, up = _turned(rows, theta)
    store(state, at.R, east)
    store(state, at.R + 3, north)
    store(state, at.R + 6, up)
    state[at.LENGTH] += dt
    store(state, at.GYRO_SUM, added(load(state, at.GYRO_SUM), 1.0, turn))
    w2 = dot(gyro, gyro)
    state[at.GYRO_SQUARES] += dt * w2
    a2 = dot(accel, accel)
    if _is_force(a2):
        force = dot(east, accel), dot(north, accel), dot(up, accel)
        store(state, at.FORCE_SUM, added(load(state, at.FORCE_SUM), dt, force))
        store(state, at.ACCEL_SUM, added(load(state, at.ACCEL_SUM), dt, accel))
        state[at.ACCEL_SQUARES] += dt * a2
        state[at.ACCEL_TIME] += dt
    if _is_field(dot(mag, mag)):
        old = load(state, at.LATEST_MAG)
        same = mag[0] == old[0] and mag[1] == old[1] and mag[2] == old[2]
        state[at.STUCK] = state[at.STUCK] + dt * math.sqrt(w2) if same else 0.0
        store(state, at.LATEST_MAG, mag)
        field = dot(east, mag), dot(north, mag), dot(up, mag)
        store(state, at.MAG_SUM, added(load(state, at.MAG_SUM), 1.0, field))
        state[at.MAG_COUNT] += 1.0
    if state[at.LENGTH] > state[at.NEXT_PART]:
        sum_turn(state, params)
        if state[at.LENGTH] >= params[WINDOW] - ROUNDING:
            close_window(state, params)


@kernel
def _update(state: Array, params: Array, gyro: Array, accel: Array, mag: Array, dt: float) -> None:
    _step(state, params, load(gyro, 0), load(accel, 0), load(mag, 0), dt)


@kernel
def _batch(
    state: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, answers: Array
) -> None:
    """Step through all samples; answers : (n, at.ANSWER), the head of the state after each."""
    for k in range(t.size):
        g = gyro[k, 0], gyro[k, 1], gyro[k, 2]
        a = accel[k, 0], accel[k, 1], accel[k, 2]
        m = mag[k, 0], mag[k, 1], mag[k, 2]
        _step(state, params, g, a, m, t[k] - t[max(k - 1, 0)])
        for i in range(at.ANSWER):
            answers[k, i] = state[i]
