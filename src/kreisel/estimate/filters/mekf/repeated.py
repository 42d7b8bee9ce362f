"""Turns readings that repeat to the last bit while the sensor turns into readings that do not count.

A sensor that froze, or whose range ends, reads the same; noise makes all others differ, at rest on a coarse scale too
when it turns.
"""

from kreisel.estimate.filters.mekf import layout as at
from kreisel.maths.kernels import inlined
from kreisel.maths.vectors import Array, Vector, added, dot, load, store

# rad/s: an axis of the gyro that repeats a rate above the first, or all three one above the second, for this long, s.
_FAST, _SLOW = 0.1, 0.02
_LASTING = 0.1

# rad/s: what no bias explains; m/s^2: by which gravity must have moved along an axis that reads the same; m/s^3: the
# fastest that counts, for fast readings are the same once in a while.
_TURNING = 0.05
_MOVED, _FASTEST = 0.3, 6.0


@inlined
def _repeats(a: Vector, b: Vector) -> tuple[bool, bool, bool]:
    return a[0] == b[0], a[1] == b[1], a[2] == b[2]


@inlined
def unmeasured(state: Array, gyro: Vector, latest: Vector, dt: float) -> float:
    """The seconds for which the gyro turns out not to have measured; all of them once they were enough to tell."""
    x, y, z = _repeats(gyro, latest)
    fastest = max(abs(gyro[0]), abs(gyro[1]), abs(gyro[2]))
    clipped = (x and abs(gyro[0]) > _FAST) or (y and abs(gyro[1]) > _FAST) or (z and abs(gyro[2]) > _FAST)
    if not (clipped or (x and y and z and fastest > _SLOW)):
        state[at.CLIPPED] = 0.0
        return 0.0
    before = state[at.CLIPPED]
    state[at.CLIPPED] = before + dt
    if state[at.CLIPPED] <= _LASTING:
        return 0.0
    return dt if before > _LASTING else state[at.CLIPPED]


@inlined
def is_dead(state: Array, gyro: Vector, accel: Vector, pushed: Vector, dt: float) -> bool:
    """Whether an axis of the accelerometer reads the same though gravity moved along it; `pushed` is gyro x accel."""
    repeats = _repeats(accel, load(state, at.LATEST_ACCEL))
    store(state, at.LATEST_ACCEL, accel)
    rate = added(gyro, -1.0, load(state, at.GYRO_BIAS))
    turns = dot(rate, rate) > _TURNING**2
    dead = False
    for i in range(3):
        moved = state[at.UNMOVED + i] + (dt * min(max(pushed[i], -_FASTEST), _FASTEST) if turns else 0.0)
        state[at.UNMOVED + i] = moved if repeats[i] else 0.0
        dead = dead or abs(state[at.UNMOVED + i]) > _MOVED
    return dead
