"""Turns gyro, accelerometer and magnetometer samples into attitude by the DCM tutorial's step, to the letter.

The document calls the axes of its world I (north), J (west) and K (up) and moves them as seen from the body;
in ENU the rows of R_NS are east = -J, north = I and up = K. Its gyro shows the world turning, w = -omega_NS_S,
and its accelerometer shows gravity, so that K = +f / abs(f) for a specific force f.
"""

import math

from kreisel.estimate.answers import Columns, answer, repeat, tell
from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.start import bridge, is_rate, start
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import (
    NONE,
    Array,
    Rows,
    Vector,
    added,
    cross,
    dot,
    inverse_root_near_one,
    load,
    rotated,
    scaled,
    store,
)


@inlined
def _at_step(weight: float, own: float, periods: float) -> float:
    """The weight that forgets as much in this step as the given one does in so many of its own periods."""
    return own * math.expm1(periods * math.log1p(weight / own))


# A field whose horizontal part is less than a thousandth of it (0.06 deg) has no direction but that of noise.
_STEEP2 = 1e-6


@inlined
def weights_of(params: Array, dt: float) -> Vector:
    """Of gyro, accelerometer and magnetometer in a step of dt."""
    w_g, w_a, w_m = params[at.WEIGHT_GYRO], params[at.WEIGHT_ACCEL], params[at.WEIGHT_MAG]
    if params[at.RATE_HZ] > 0.0:
        w_a = _at_step(w_a, w_g, dt * params[at.RATE_HZ])
        w_m = _at_step(w_m, w_g, dt * params[at.RATE_HZ])
    return w_g, w_a, w_m


@inlined
def asked(
    rows: Rows,
    askew: float,
    turn: Vector,
    accel: Vector,
    mag: Vector,
    weights: Vector,
    setting: Vector,
    near: bool = False,
) -> Vector:
    """The weighted mean of the rotations that the three sensors ask for; `turn` is the gyro's.

    askew : east . north; up is their product, so that up . up = 1 - askew^2. near : its square is less than 1e-15.
    setting : 1 where weights count only around the axes that a sensor observes; cosine and sine of declination.
    The horizontal field is h = m - (up . m) up, and both its norm and north x h are written with up . m, as
    late as they can be: each step waits for the one before, so that its longest chain of operations is its time.
    """
    east, north, up = rows
    a2, m2 = dot(accel, accel), dot(mag, mag)
    has_accel, has_mag = 1e-60 < a2 < 1e60, 1e-60 < m2 < 1e60
    accel, a2 = (accel, a2) if has_accel else (NONE, 1.0)
    mag, m2 = (mag, m2) if has_mag else (NONE, 1.0)
    rise = dot(up, mag)
    h2 = m2 - rise * rise
    if not near and askew * askew > 1e-15:
        level = added(mag, -rise, up)
        h2 = dot(level, level)
    has_mag = has_mag and h2 > _STEEP2 * m2
    w_g, w_a, w_m = weights[0], weights[1] if has_accel else 0.0, weights[2]
    # The accelerometer sees rotations across `up`, a magnetometer made horizontal those around it; the
    # document divides by the sum of all weights nevertheless. All quotients can be had before the step.
    alone, with_accel = 1.0 / weights[0], 1.0 / (weights[0] + weights[1])
    with_mag, with_both = 1.0 / (weights[0] + weights[2]), 1.0 / (weights[0] + weights[1] + weights[2])
    across = with_accel if has_accel else alone
    around = with_mag if has_mag else alone
    if setting[0] == 0.0:
        both = with_both if has_accel else with_mag
        across = around = both if has_mag else across
    # Magnetic north, where the answer has it.
    if setting[2] != 0.0:
        north = added(scaled(setting[1], north), setting[2], east)
    dtheta = scaled(w_g * across, turn)
    if setting[0] != 0.0:
        dtheta = added(dtheta, w_g * (around - across) * dot(turn, up), up)
    # K x (A - K) is K x A.
    dtheta = added(dtheta, w_a * across / a2 * math.sqrt(a2), cross(up, accel))
    horizontal = added(cross(north, mag), -rise, cross(north, up))
    # The root of what is not positive is not used.
    return added(dtheta, w_m * around / h2 * math.sqrt(h2) if has_mag else 0.0, horizontal)


@inlined
def moved(rows: Rows, askew: float, dtheta: Vector, near: bool = False) -> Rows:
    """The axes moved by dtheta x r, corrected by half of what they lack to a right angle and made unit vectors.

    near : abs(dtheta) is below 0.028.
    """
    # East is -J: what moves or corrects J does the same to it.
    east, north, _ = rows
    d_east, d_north = cross(dtheta, east), cross(dtheta, north)
    # Norms and products of the moved vectors from those before and those of the moves, for east . d_east = 0 and
    # east . d_north = -north . d_east: they need not wait for the vectors.
    ee = (dot(east, east) - 1.0) + dot(d_east, d_east)
    nn = (dot(north, north) - 1.0) + dot(d_north, d_north)
    en = askew + dot(d_east, d_north)
    return _orthonormal(added(east, 1.0, d_east), added(north, 1.0, d_north), ee, nn, en, near)


@inlined
def _orthonormal(east: Vector, north: Vector, ee: float, nn: float, en: float, near: bool = False) -> Rows:
    """Both corrected by half of what they lack to a right angle, made unit vectors, and up = east x north.

    ee, nn : their squared norms less one; en : their product.
    """
    half = 0.5 * en
    k_e = inverse_root_near_one(ee - (en * en) * (0.75 - 0.25 * nn), near)
    k_n = inverse_root_near_one(nn - (en * en) * (0.75 - 0.25 * ee), near)
    e, n = added(east, -half, north), added(north, -half, east)
    return scaled(k_e, e), scaled(k_n, n), scaled(k_e * k_n, cross(e, n))


@inlined
def advanced(
    rows: Rows,
    askew: float,
    turn: Vector,
    accel: Vector,
    mag: Vector,
    weights: Vector,
    setting: Vector,
    exact: bool,
) -> Rows:
    """The axes after a step with these samples; `askew` is east . north before."""
    dtheta = asked(rows, askew, turn, accel, mag, weights, setting)
    if not exact:
        return moved(rows, askew, dtheta)
    east, north = rotated(dtheta, rows[0]), rotated(dtheta, rows[1])
    return _orthonormal(east, north, dot(east, east) - 1.0, dot(north, north) - 1.0, dot(east, north))


@inlined
def setting_of(params: Array) -> Vector:
    """Whether weights count only where they observe, and the declination's cosine and sine."""
    return params[at.OBSERVED], params[at.DECLINATION], params[at.DECLINATION + 1]


@inlined
def waits(state: Array, params: Array) -> bool:
    """Whether the first attitude is still to be told by samples."""
    return state[at.LEVELLED] == 0.0 or state[at.NORTHED] < params[at.START_NORTH]


@kernel
def step(state: Array, params: Array, gyro: Vector, accel: Vector, mag: Vector, dt: float) -> None:
    """Move `state` over the `dt` seconds that end with these samples."""
    if (waits(state, params) and start(state, params, accel, mag)) or not dt > 0.0:
        return
    state[at.FLAGS] = state[at.CALM]
    if is_rate(gyro):
        state[at.GAP] = 0.0
        store(state, at.RATE, gyro)
    else:
        gyro = bridge(state, params, dt)
    rows = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    weights, setting = weights_of(params, dt), setting_of(params)
    askew = dot(rows[0], rows[1])
    rows = advanced(rows, askew, scaled(-dt, gyro), accel, mag, weights, setting, params[at.EXACT] == 1.0)
    store(state, at.R_NS, rows[0])
    store(state, at.R_NS + 3, rows[1])
    store(state, at.R_NS + 6, rows[2])


@kernel
def update(state: Array, params: Array, sample: Array, dt: float) -> None:
    """One step, `sample` (9,) being gyro, accel and mag."""
    step(state, params, load(sample, 0), load(sample, 3), load(sample, 6), dt)


@kernel
def batch(state: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns) -> None:
    """The steps through all samples, and what the state says after each."""
    i = 0
    while i < t.shape[0]:
        g = gyro[i, 0], gyro[i, 1], gyro[i, 2]
        a = accel[i, 0], accel[i, 1], accel[i, 2]
        m = mag[i, 0], mag[i, 1], mag[i, 2]
        step(state, params, g, a, m, t[i] - t[max(i - 1, 0)])
        tell(state, out, i)
        i += 1
        if not waits(state, params) and params[at.RATE_HZ] == 0.0:
            i = _ordinary(state, params, t, gyro, accel, mag, out, i)


@kernel
def _ordinary(
    state: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns, first: int
) -> int:
    """The steps from sample `first` on, up to the first whose gyro sample is missing or whose time stands still.

    The axes stay in registers, no array is passed on, and indices begin at 0, where none can be taken for one that
    counts from the end: each would cost a tenth of the time and more.
    """
    exact, setting, weights = params[at.EXACT] == 1.0, setting_of(params), weights_of(params, 0.0)
    rows = load(state, at.R_NS), load(state, at.R_NS + 3), load(state, at.R_NS + 6)
    before, t, gyro, accel, mag, R = (
        t[first - 1 :],
        t[first:],
        gyro[first:],
        accel[first:],
        mag[first:],
        out.R_NS[first:],
    )
    g, askew, done = NONE, dot(rows[0], rows[1]), 0
    for i in range(t.shape[0]):
        dt = t[i] - before[i]
        new = gyro[i, 0], gyro[i, 1], gyro[i, 2]
        if not is_rate(new) or not dt > 0.0:
            break
        g, done = new, i + 1
        a = accel[i, 0], accel[i, 1], accel[i, 2]
        m = mag[i, 0], mag[i, 1], mag[i, 2]
        rows = advanced(rows, askew, scaled(-dt, g), a, m, weights, setting, exact)
        askew = dot(rows[0], rows[1])
        answer(R, i, rows, askew)
    if done > 0:
        store(state, at.R_NS, rows[0])
        store(state, at.R_NS + 3, rows[1])
        store(state, at.R_NS + 6, rows[2])
        store(state, at.RATE, g)
        state[at.FLAGS], state[at.GAP] = state[at.CALM], 0.0
        repeat(state, out, first, first + done)
    return first + done
