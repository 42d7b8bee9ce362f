"""Turns readings that repeat to the last bit while the sensor turns into readings that do not count.

A sensor that froze, or whose range ends, reads the same; noise makes all others differ, at rest on a coarse scale too
when it turns.
"""

from kreisel.estimate.filters.mekf import layout as at
from kreisel.maths.kernels import inlined
from kreisel.maths.vectors import Array, Vector, added, dot, load, store

# rad/s: an axis of the gyro that repeats a rate above the first, or all three one above the second, for this long, s,
# and one axis alone until this angle, rad: a coarse scale repeats where a slow rate is at its peak.
_FAST, _SLOW = 0.1, 0.02
_LASTING, _TURNED = 0.1, 0.05

# rad/s and m/s^2: below the step of any scale.
_ROUND_OFF = 1e-9

# rad/s: what no bias explains; m/s^2: by which gravity must have moved along an axis that reads the same; m/s^3: the
# fastest that counts, for fast readings are the same once in a while.
_TURNING = 0.05
_MOVED, _FASTEST = 0.3, 6.0


@inlined
def _repeats(a: Vector, b: Vector) -> tuple[bool, bool, bool]:
    return a[0] == b[0], a[1] == b[1], a[2] == b[2]


@inlined
def is_steady(state: Array, gyro: Vector, latest: Vector, accel: Vector, mag: Vector) -> bool:
    """Whether gyro and accelerometer stay as they are, but for round-off, and the magnetometer, if any, does not.

    So does a steady turn look to sensors without noise, and none of them froze.
    """
    before, moved = load(state, at.LATEST_ACCEL), 0.0
    for i in range(3):
        moved = max(moved, abs(gyro[i] - latest[i]), abs(accel[i] - before[i]))
    x, y, z = _repeats(mag, load(state, at.LATEST_MAG))
    return moved < _ROUND_OFF and not (x and y and z)


@inlined
def unmeasured(state: Array, gyro: Vector, latest: Vector, steady: bool, dt: float) -> float:
    """The seconds for which the gyro turns out not to have measured; all of them once they were enough to tell."""
    repeats, fastest, all_three = _repeats(gyro, latest), 0.0, True
    for i in range(3):
        fastest = max(fastest, abs(gyro[i])) if repeats[i] else fastest
        all_three = all_three and repeats[i]
    if steady or fastest <= (_SLOW if all_three else _FAST):
        state[at.CLIPPED] = 0.0
        return 0.0
    before, enough = state[at.CLIPPED], _LASTING if all_three else max(_LASTING, _TURNED / fastest)
    state[at.CLIPPED] = before + dt
    if state[at.CLIPPED] <= enough:
        return 0.0
    return dt if before > enough else state[at.CLIPPED]


@inlined
def is_dead(state: Array, gyro: Vector, accel: Vector, pushed: Vector, steady: bool, dt: float) -> bool:
    """Whether an axis of the accelerometer reads the same though gravity moved along it; `pushed` is gyro x accel."""
    repeats = _repeats(accel, load(state, at.LATEST_ACCEL))
    store(state, at.LATEST_ACCEL, accel)
    rate = added(gyro, -1.0, load(state, at.GYRO_BIAS))
    turns = dot(rate, rate) > _TURNING**2
    dead = False
    for i in range(3):
        moved = state[at.UNMOVED + i] + (dt * min(max(pushed[i], -_FASTEST), _FASTEST) if turns else 0.0)
        state[at.UNMOVED + i] = moved if repeats[i] and not steady else 0.0
        dead = dead or abs(state[at.UNMOVED + i]) > _MOVED
    return dead
