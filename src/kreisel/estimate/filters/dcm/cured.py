"""Gyro, accelerometer and magnetometer samples into attitude by the DCM filter's default step.

Each sample turns R_NS by Exp and adds to the sums of a short window; at the end of a window, `window.py` makes
them corrections of the attitude, the gyro bias and the gyro's scale.
"""

import math

from kreisel.estimate.filters.dcm import state as at
from kreisel.estimate.filters.dcm.start import bridge, is_rate, start
from kreisel.estimate.filters.dcm.vectors import Array, Vector, added, combined, dot, load, scaled, store
from kreisel.estimate.filters.dcm.window import WINDOW, close_window, sum_turn
from kreisel.maths.kernels import inlined, kernel

# A specific force beyond this (m/s^2) is a fault, not a measurement.
_NO_FORCE = 1e5

# rad: a magnetometer that reads the same number to the last bit while it turns by this has died.
_STUCK = 0.35

# The window is summed in this many parts where its effect on the attitude is linearised.
_PARTS = 16.0


@inlined
def _turned(state: Array, theta: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of R_NS Exp(theta)."""
    x, y, z = theta
    a2 = dot(theta, theta)
    if a2 < 0.01:
        # The next terms, a^10 / 11! and a^10 / 12!, are below 3e-18.
        s = 1.0 - a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0 * (1.0 - a2 / 72.0)))
        c = 0.5 - a2 / 24.0 * (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0 * (1.0 - a2 / 90.0)))
    else:
        a = math.sqrt(a2)
        # Half-angle form: 1 - cos(a) loses digits where a is small.
        half = math.sin(0.5 * a) / a
        s, c = math.sin(a) / a, 2.0 * half * half
    e0 = 1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y
    e1 = c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x
    e2 = c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)
    east = combined(load(state, at.R), e0, e1, e2)
    north = combined(load(state, at.R + 3), e0, e1, e2)
    return east, north, combined(load(state, at.R + 6), e0, e1, e2)


@inlined
def _sum_gyro(state: Array, gyro: Vector, dt: float) -> None:
    turn = scaled(dt, gyro)
    state[at.LENGTH] += dt
    store(state, at.GYRO_SUM, added(load(state, at.GYRO_SUM), 1.0, turn))
    state[at.GYRO_SQUARES] += dot(turn, gyro)
    state[at.SUBTIME] += dt
    store(state, at.SUBTURN, added(load(state, at.SUBTURN), 1.0, turn))


@inlined
def _sum_force(state: Array, accel: Vector, east: Vector, north: Vector, up: Vector, dt: float) -> None:
    a2 = dot(accel, accel)
    # NaN, a dead sensor's zero and absurd values fail here.
    if not (0.0 < a2 < _NO_FORCE * _NO_FORCE):
        return
    force = dot(east, accel), dot(north, accel), dot(up, accel)
    store(state, at.FORCE_SUM, added(load(state, at.FORCE_SUM), dt, force))
    store(state, at.ACCEL_SUM, added(load(state, at.ACCEL_SUM), dt, accel))
    state[at.ACCEL_SQUARES] += dt * a2
    state[at.ACCEL_TIME] += dt


@inlined
def _sum_field(state: Array, mag: Vector, turn: float, east: Vector, north: Vector, up: Vector) -> None:
    m2 = dot(mag, mag)
    if not (0.0 < m2 < 1e60) or state[at.STUCK] > _STUCK:
        return
    if mag == load(state, at.LATEST_MAG):
        state[at.STUCK] += turn
    else:
        state[at.STUCK] = 0.0
        store(state, at.LATEST_MAG, mag)
    field = dot(east, mag), dot(north, mag), dot(up, mag)
    store(state, at.MAG_SUM, added(load(state, at.MAG_SUM), 1.0, field))
    state[at.MAG_COUNT] += 1.0


@inlined
def _step(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move `state` over the `dt` seconds that end with these samples."""
    if state[at.LEVELLED] == 0.0 or state[at.NORTHED] < params[at.START_NORTH]:
        if start(state, params, accel, mag):
            return
    if not dt > 0.0:
        return
    state[at.FLAGS] = state[at.CALM] if state[at.LEVELLED] == 1.0 else at.HELD
    if is_rate(gyro):
        state[at.GAP] = 0.0
        store(state, at.RATE, gyro)
    else:
        gyro = bridge(state, params, dt)
        state[at.MISSING] += dt
    rate = (
        gyro[0] - (dot(load(state, at.SCALE), gyro) + state[at.BIAS]),
        gyro[1] - (dot(load(state, at.SCALE + 3), gyro) + state[at.BIAS + 1]),
        gyro[2] - (dot(load(state, at.SCALE + 6), gyro) + state[at.BIAS + 2]),
    )
    east, north, up = _turned(state, scaled(dt, rate))
    store(state, at.R, east)
    store(state, at.R + 3, north)
    store(state, at.R + 6, up)
    _sum_gyro(state, gyro, dt)
    _sum_force(state, accel, east, north, up, dt)
    _sum_field(state, mag, dt * math.sqrt(dot(gyro, gyro)), east, north, up)
    if state[at.SUBTIME] > params[WINDOW] / _PARTS:
        sum_turn(state)
    # Half a nanosecond: rounded time stamps must not make every other window a sample longer.
    if state[at.LENGTH] > params[WINDOW] - 5e-10:
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
