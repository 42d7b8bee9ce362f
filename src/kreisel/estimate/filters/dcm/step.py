"""Turns gyro, accelerometer and magnetometer samples into attitude by the DCM filter's default step.

Each sample turns R_NS by Exp and adds to the sums of a short window, which corrects the attitude when it closes.
"""

import math

from kreisel.estimate.answers import Columns, tell
from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.start import UNSEEN, bridge, is_rate, start
from kreisel.estimate.filters.dcm.window import close_part
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import (
    Array,
    Rows,
    Vector,
    added,
    combined,
    cross,
    dot,
    exp_factors,
    load,
    scaled,
    store,
)

# m/s^2: 50 g; what is beyond is a blow that no average survives, or a fault.
NO_FORCE = 500.0


@inlined
def turned(rows: Rows, theta: Vector, near: bool = False) -> Rows:
    """Rows of R Exp(theta), given those of R. near : abs(theta) is below 0.1."""
    x, y, z = theta
    s, c = exp_factors(dot(theta, theta), near)
    e0 = 1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y
    e1 = c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x
    e2 = c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)
    return combined(rows[0], e0, e1, e2), combined(rows[1], e0, e1, e2), combined(rows[2], e0, e1, e2)


@inlined
def corrected(turn: Vector, scale: Rows, bias: Vector, dt: float) -> Vector:
    """The rotation vector of a step whose gyro reads `turn`; the columns of `scale` are what it reads too much."""
    false = combined(turn, scale[0], scale[1], scale[2])
    return added(added(turn, -1.0, false), -dt, bias)


@inlined
def step(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move `state` over the `dt` seconds that end with these samples."""
    waits = state[at.LEVELLED] == 0.0 or state[at.NORTHED] < params[at.START_NORTH]
    if (waits and start(state, params, accel, mag)) or not dt > 0.0:
        return
    state[at.FLAGS] = state[at.CALM]
    latest = load(state, at.RATE)
    if is_rate(gyro):
        state[at.GAP] = 0.0
        store(state, at.RATE, gyro)
    else:
        gyro = bridge(state, params, dt)
    if dt > params[at.HOLD]:
        state[at.MISSING] += UNSEEN * dt
    turn = scaled(dt, gyro)
    rows = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    scale = load(state, at.SCALE), load(state, at.SCALE + 3), load(state, at.SCALE + 6)
    theta = corrected(turn, scale, load(state, at.GYRO_BIAS), dt)
    theta = added(theta, params[at.CONING] * dt * dt, cross(latest, gyro))
    east, north, up = turned(rows, theta)
    store(state, at.R_NS, east)
    store(state, at.R_NS + 3, north)
    store(state, at.R_NS + 6, up)
    state[at.LENGTH] += dt
    store(state, at.GYRO_SUM, added(load(state, at.GYRO_SUM), 1.0, turn))
    w2 = dot(gyro, gyro)
    state[at.GYRO_SQUARES] += dt * w2
    a2 = dot(accel, accel)
    # A dead sensor's zero and NaN fail here too.
    if 0.0 < a2 < NO_FORCE**2:
        state[at.FORCE_SUM] += dt * dot(east, accel)
        state[at.FORCE_SUM + 1] += dt * dot(north, accel)
        store(state, at.ACCEL_SUM, added(load(state, at.ACCEL_SUM), dt, accel))
        state[at.ACCEL_SQUARES] += dt * a2
        state[at.ACCEL_TIME] += dt
    if 0.0 < dot(mag, mag) < math.inf:
        old = load(state, at.LATEST_MAG)
        same = mag[0] == old[0] and mag[1] == old[1] and mag[2] == old[2]
        state[at.STUCK] = state[at.STUCK] + dt * math.sqrt(w2) if same else 0.0
        store(state, at.LATEST_MAG, mag)
        field = dot(east, mag), dot(north, mag), dot(up, mag)
        store(state, at.MAG_SUM, added(load(state, at.MAG_SUM), 1.0, field))
        state[at.MAG_COUNT] += 1.0
    if state[at.LENGTH] > state[at.NEXT_PART]:
        close_part(state, params)


@kernel
def update(state: Array, params: Array, sample: Array, dt: float) -> None:
    """One step, `sample` (9,) being gyro, accel and mag."""
    step(state, params, load(sample, 0), load(sample, 3), load(sample, 6), dt)


@kernel
def batch(state: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns) -> None:
    """The steps through all samples, and what the state says after each."""
    for i in range(t.shape[0]):
        g = gyro[i, 0], gyro[i, 1], gyro[i, 2]
        a = accel[i, 0], accel[i, 1], accel[i, 2]
        m = mag[i, 0], mag[i, 1], mag[i, 2]
        step(state, params, g, a, m, t[i] - t[max(i - 1, 0)])
        tell(state, out, i)
        out.gyro_bias[i, 0], out.gyro_bias[i, 1], out.gyro_bias[i, 2] = load(state, at.GYRO_BIAS)
