"""First samples into the first attitude, and missing gyro samples into the rate that bridges them."""

import math

from kreisel.estimate.filters.dcm import state as at
from kreisel.estimate.filters.dcm.vectors import Array, Vector, added, cross, dot, load, scaled, store, unit
from kreisel.maths.kernels import inlined, kernel

# rad/s, 57 000 deg/s: no gyro reads that far, so a number beyond it is a fault, not a rate.
_NO_RATE = 1e3

# cos 2.6 deg: where x_S stands nearer to the vertical than that, y_S tells the heading instead.
_VERTICAL = 0.999


@inlined
def horizontal(up: Vector, a: Vector) -> Vector:
    """Direction of `a` made perpendicular to the unit vector `up`; zero where nothing finite is left."""
    return unit(added(a, -dot(up, a), up))


@inlined
def north_of(mag: Vector, up: Vector, cos_d: float, sin_d: float) -> Vector:
    """True north, seen from the body, where the field is `mag` and the declination d."""
    m = horizontal(up, mag)
    return added(scaled(cos_d, m), sin_d, cross(up, m))


@kernel
def start(state: Array, params: Array, accel: Vector, mag: Vector) -> bool:
    """Level with the first accelerometer sample, head north with the first magnetometer sample.

    True where this sample has set the inclination, and so begins the answer. Without a magnetometer the yaw
    starts at zero: x_S points east, or y_S north where x_S is vertical.
    """
    begins = False
    if state[at.LEVELLED] == 0.0:
        up = unit(accel)
        if dot(up, up) == 0.0:
            return False
        y = cross(up, (1.0, 0.0, 0.0)) if abs(up[0]) < _VERTICAL else (0.0, 1.0, 0.0)
        _face(state, horizontal(up, y), up)
        state[at.LEVELLED] = 1.0
        state[at.CALM] = state[at.FLAGS] = 0.0
        begins = True
    up = load(state, at.R + 6)
    north = north_of(mag, up, params[at.DECLINATION], params[at.DECLINATION + 1])
    if state[at.NORTHED] == 0.0 and params[at.START_NORTH] == 1.0 and dot(north, north) > 0.0:
        before = load(state, at.R + 3)
        # Angle about up by which the answer turns: what was north is now seen from the new north.
        state[at.HEADING] = math.atan2(dot(cross(north, before), up), dot(before, north))
        _face(state, north, up)
        state[at.NORTHED] = 1.0
    return begins


@inlined
def _face(state: Array, north: Vector, up: Vector) -> None:
    store(state, at.R, cross(north, up))
    store(state, at.R + 3, north)
    store(state, at.R + 6, up)


@inlined
def is_rate(gyro: Vector) -> bool:
    return abs(gyro[0]) < _NO_RATE and abs(gyro[1]) < _NO_RATE and abs(gyro[2]) < _NO_RATE


@kernel
def bridge(state: Array, params: Array, dt: float) -> Vector:
    """The rate where a gyro sample is missing: the latest one through a short gap, none in a long one."""
    state[at.FLAGS] += at.HELD
    state[at.GAP] += dt
    state[at.MISSING] += dt
    if state[at.GAP] > params[at.HOLD]:
        return 0.0, 0.0, 0.0
    return load(state, at.RATE)
