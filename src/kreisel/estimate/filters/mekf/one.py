"""Turns a sample into the attitude and the sums of one filter, whose window closes when it is full."""

from kreisel.estimate.filters.dcm.start import UNSEEN, bridge, is_rate, start
from kreisel.estimate.filters.dcm.step import NO_FORCE, corrected, turned
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.level import seek
from kreisel.estimate.filters.mekf.repeated import is_dead, is_steady, unmeasured
from kreisel.estimate.filters.mekf.window import close_part
from kreisel.maths.kernels import inlined
from kreisel.maths.vectors import Array, Rows, Vector, added, cross, dot, load, norm, scaled, store

# uT: a hundred Earth's fields and more, beside which nobody looks for north; or a fault.
_NO_FIELD = 1e4


@inlined
def step(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move `state` over the `dt` seconds that end with these samples."""
    waits = state[at.LEVELLED] == 0.0 or state[at.NORTHED] < params[at.START_NORTH]
    if waits and start(state, params, accel, mag):
        seek(state, params, accel)
        return
    if not dt > 0.0:
        return
    state[at.FLAGS] = state[at.CALM]
    latest = load(state, at.RATE)
    steady = is_steady(state, gyro, latest, accel, mag)
    if is_rate(gyro):
        state[at.GAP] = 0.0
        state[at.MISSING] += UNSEEN * unmeasured(state, gyro, latest, steady, dt)
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
    rows = turned(rows, theta)
    store(state, at.R_NS, rows[0])
    store(state, at.R_NS + 3, rows[1])
    store(state, at.R_NS + 6, rows[2])
    state[at.LENGTH] += dt
    store(state, at.GYRO_SUM, added(load(state, at.GYRO_SUM), 1.0, turn))
    state[at.GYRO_SQUARES] += dt * dot(gyro, gyro)
    _sum_force(state, rows, gyro, accel, steady, dt)
    _sum_field(state, rows, gyro, mag, dt)
    if state[at.LENGTH] > state[at.NEXT_PART]:
        close_part(state, params)


@inlined
def _sum_force(state: Array, rows: Rows, gyro: Vector, accel: Vector, steady: bool, dt: float) -> None:
    a2 = dot(accel, accel)
    # A dead sensor's zero and NaN fail here too.
    if not 0.0 < a2 < NO_FORCE**2:
        return
    pushed = cross(gyro, accel)
    if is_dead(state, gyro, accel, pushed, steady, dt):
        return
    east, north, up = rows
    force = dot(east, accel), dot(north, accel), dot(up, accel)
    store(state, at.FORCE_SUM, added(load(state, at.FORCE_SUM), dt, force))
    store(state, at.ACCEL_SUM, added(load(state, at.ACCEL_SUM), dt, accel))
    state[at.ACCEL_SQUARES] += dt * a2
    state[at.LAG_SUM] += dt * dot(east, pushed)
    state[at.LAG_SUM + 1] += dt * dot(north, pushed)
    state[at.ACCEL_TIME] += dt


@inlined
def _sum_field(state: Array, rows: Rows, gyro: Vector, mag: Vector, dt: float) -> None:
    if not 0.0 < dot(mag, mag) < _NO_FIELD**2:
        return
    old = load(state, at.LATEST_MAG)
    same = mag[0] == old[0] and mag[1] == old[1] and mag[2] == old[2]
    state[at.STUCK] = state[at.STUCK] + dt * norm(gyro) if same else 0.0
    store(state, at.LATEST_MAG, mag)
    field = dot(rows[0], mag), dot(rows[1], mag), dot(rows[2], mag)
    store(state, at.MAG_SUM, added(load(state, at.MAG_SUM), 1.0, field))
    state[at.MAG_COUNT] += 1.0
