"""Turns readings that repeat to the last bit while the sensor turns into readings that do not count.

A sensor that froze, or whose range ends, reads the same; noise makes all others differ, at rest on a coarse scale too
when it turns.
"""

import math

from kreisel.estimate.filters.mekf import layout as at
from kreisel.maths.kernels import inlined
from kreisel.maths.vectors import Array, Vector, added, dot, load, store

# rad/s: an axis of the gyro that repeats a rate above the first, or all three one above the second, for this long, s.
# The smallest range of common gyros is 125 deg/s, 2.18 rad/s; on a coarse scale one axis alone repeats slower rates
# wherever they peak, and in every steady turn.
_FAST, _SLOW = 2.1, 0.02
_LASTING = 0.1

# Share of readings that repeat before any was seen, readings over which it is learned, and least share that counts.
FIRST_SHARE, _LEARNED, _LEAST = 0.3, 1000.0, 0.05

# Log of the odds against so many repeats by chance: the scale of a quiet sensor is coarser than its noise, and what it
# reads of a slow motion repeats often.
_ODDS = 20.0

_TOLD = -1.0  # in place of a run: it was long enough

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
def _learn_share(state: Array, place: int, repeats: bool) -> None:
    state[place] += ((1.0 if repeats else 0.0) - state[place]) / _LEARNED


@inlined
def _is_chance(run: float, share: float) -> bool:
    """Whether so many repeats in a row come about where that share of readings repeats."""
    return -run * math.log(max(share, _LEAST)) < _ODDS


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
        if abs(gyro[i]) > _SLOW and state[at.RUNS] != _TOLD:
            _learn_share(state, at.REPEATING, repeats[i])
    if steady or fastest <= (_SLOW if all_three else _FAST):
        state[at.CLIPPED] = state[at.RUNS] = 0.0
        return 0.0
    if state[at.RUNS] == _TOLD:
        return dt
    state[at.CLIPPED] += dt
    state[at.RUNS] += 3.0 if all_three else 1.0
    if state[at.CLIPPED] <= _LASTING or _is_chance(state[at.RUNS], state[at.REPEATING]):
        return 0.0
    state[at.RUNS] = _TOLD
    return state[at.CLIPPED]


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
        run = state[at.RUNS + 1 + i] + 1.0 if repeats[i] and not steady else 0.0
        state[at.UNMOVED + i], state[at.RUNS + 1 + i] = (moved, run) if run > 0.0 else (0.0, 0.0)
        is_told = abs(state[at.UNMOVED + i]) > _MOVED and not _is_chance(run, state[at.REPEATING + 1])
        if turns and not is_told:
            _learn_share(state, at.REPEATING + 1, repeats[i])
        dead = dead or is_told
    return dead
