"""Turns first samples into a first attitude, and gyro samples that are missing into the rate that bridges them."""

import math

from kreisel.estimate.filters.dcm import layout as at
from kreisel.maths.directions import VERTICAL
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import (
    NONE,
    Array,
    Vector,
    added,
    cross,
    dot,
    load,
    scaled,
    store,
    unit,
)

# rad/s: 5700 deg/s, which no gyro of this kind reads; a number beyond it is a fault.
_NO_RATE = 100.0

# rad^2/s: what is not known of a rotation that nobody measures.
UNSEEN = 1.0

# rad/s^2: by how much a rate may change each second while its latest sample stands for it. A single sample that is
# lost at 100 Hz leaves 0.06 deg, and after some 0.2 s it is as if nothing stood for it.
_CHANGE = 20.0

# Sine of 0.06 deg: a field that near to the vertical has no direction but that of noise and round-off.
_STEEP = 1e-3


@kernel
def start(state: Array, params: Array, accel: Vector, mag: Vector) -> bool:
    """Level with the first accelerometer sample, head north with the first magnetometer sample.

    True where this sample has set the inclination, and so begins the answer. Without a magnetometer the yaw
    starts at zero: x_S points east, or y_S north where x_S is vertical.
    """
    begins = state[at.LEVELLED] == 0.0
    if begins:
        up = unit(accel)
        if dot(up, up) == 0.0:
            return False
        y = cross(up, (1.0, 0.0, 0.0)) if abs(up[0]) < VERTICAL else (0.0, 1.0, 0.0)
        _face(state, _horizontal(up, y), up)
        state[at.LEVELLED] = 1.0
        state[at.CALM] = state[at.FLAGS] = 0.0
    up = load(state, at.R_NS + 6)
    magnetic = _horizontal(up, mag)
    if state[at.NORTHED] < params[at.START_NORTH] and dot(magnetic, magnetic) > 0.0:
        cos_d, sin_d = params[at.DECLINATION], params[at.DECLINATION + 1]
        north = added(scaled(cos_d, magnetic), sin_d, cross(up, magnetic))
        before = load(state, at.R_NS + 3)
        state[at.HEADING] = math.atan2(dot(cross(north, before), up), dot(before, north))
        _face(state, north, up)
        state[at.NORTHED] = 1.0
    return begins


@inlined
def _horizontal(up: Vector, a: Vector) -> Vector:
    """Direction of `a` made perpendicular to the unit vector `up`; zero where no more than noise is left."""
    level = added(a, -dot(up, a), up)
    return unit(level) if dot(level, level) > _STEEP**2 * dot(a, a) else NONE


@inlined
def _face(state: Array, north: Vector, up: Vector) -> None:
    store(state, at.R_NS, cross(north, up))
    store(state, at.R_NS + 3, north)
    store(state, at.R_NS + 6, up)


@inlined
def is_rate(gyro: Vector) -> bool:
    """Whether a gyro sample is one: not NaN, and nothing that only a fault reads."""
    return abs(gyro[0]) < _NO_RATE and abs(gyro[1]) < _NO_RATE and abs(gyro[2]) < _NO_RATE


@inlined
def _unknown2(gap: float) -> float:
    """Variance of the attitude after `gap` seconds without a gyro, rad^2, none of it from before."""
    held = 0.5 * _CHANGE * gap * gap
    return min(held * held, UNSEEN * gap)


@kernel
def bridge(state: Array, params: Array, dt: float) -> Vector:
    """The rate where a sample is missing: the latest one through a short gap, the bias (no rotation) in a long one."""
    state[at.FLAGS] = float(int(state[at.FLAGS]) | at.HELD)
    before = state[at.GAP]
    state[at.GAP] += dt
    state[at.MISSING] += _unknown2(state[at.GAP]) - _unknown2(before)
    return load(state, at.RATE) if state[at.GAP] <= params[at.HOLD] else load(state, at.GYRO_BIAS)
