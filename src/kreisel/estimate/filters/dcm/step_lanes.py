"""Turns many recordings at once into attitude by the default step: sixteen abreast, one in each lane of vectors.

Samples and the parts of a window are taken abreast; windows close in all lanes at the same sample, one after the
other. A block of samples in which any lane has something out of the ordinary (a gap of the gyro, no time, no attitude
yet, a window that began at another sample) is taken lane by lane.
"""

import math

import numpy as np

from kreisel.estimate.answers import Columns, flags_of, of_lane, tell
from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.lanes import AXES, BLOCK, LANES, READING, gather, scatter
from kreisel.estimate.filters.dcm.step import NO_FORCE, corrected, turned, update
from kreisel.estimate.filters.dcm.window import close_window, is_over, next_part
from kreisel.maths.kernels import inlined, kernel, wide_vectors
from kreisel.maths.vectors import NONE, Array, Rows, Vector, added, cross, dot, nearest_rotation, scaled

# Places in the scratch, in units of LANES: what the steps between two closings of a window read and write. First what
# lies in the state as well, in this order, then axes after a step and its rotation vector.
_R = 0
_BIAS = 9
_SCALE = 12
_RATE = 21
_STUCK = 24
_LATEST_MAG = 25
_GYRO_SUM = 28
_GYRO_SQUARES = 31
_ACCEL_SUM = 32
_ACCEL_SQUARES = 35
_ACCEL_TIME = 36
_FORCE_SUM = 37
_MAG_SUM = 39
_MAG_COUNT = 42
_TURN = 43
_SUMMED = 79  # the sums of the gyro alone: LENGTH is one for all lanes
_NEW = 82
# One number for all lanes each: how long the window has lasted, what of it is linearised, when the next part is due.
_LENGTH = 91 * LANES
_SUMMED_LENGTH = _LENGTH + 1
_NEXT_PART = _LENGTH + 2
_SIZE = _LENGTH + 3

# Where each of them lies in the state.
_PLACES = np.concatenate(
    [
        np.arange(first, first + count)
        for first, count in (
            (at.R_NS, 9),
            (at.GYRO_BIAS, 3),
            (at.SCALE, 9),
            (at.RATE, 3),
            (at.STUCK, 1),
            (at.LATEST_MAG, 3),
            (at.GYRO_SUM, 3),
            (at.GYRO_SQUARES, 1),
            (at.ACCEL_SUM, 3),
            (at.ACCEL_SQUARES, 1),
            (at.ACCEL_TIME, 1),
            (at.FORCE_SUM, 2),
            (at.MAG_SUM, 3),
            (at.MAG_COUNT, 1),
            (at.TURN, 36),
            (at.SUMMED + 1, 3),
        )
    ]
)


@kernel
def batch_of_lanes(
    states: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns
) -> None:
    """The steps through all samples of LANES recordings, and what the states say after each.

    states (LANES, STATE); t (n,); gyro, accel, mag (LANES, n, 3).
    """
    s, readings = np.empty(_SIZE), np.empty(BLOCK * READING * LANES)
    answers = np.empty(BLOCK * AXES * LANES)
    out.rest[:], out.disturbed[:], out.held[:] = False, False, False
    loaded = False
    for k in range(0, t.shape[0], BLOCK):
        steps = min(BLOCK, t.shape[0] - k)
        ordinary = gather(readings, t, gyro, accel, mag, k, steps) and _no_pause(params, t, k, steps)
        ordinary = ordinary and (_northed(states, params) or _blind(readings, steps))
        if ordinary and (loaded or _together(states)):
            if not loaded:
                _load(s, states)
            loaded = True
            _advance(s, states, readings, answers, params, t, k, steps, out)
        else:
            if loaded:
                _store(s, states)
            loaded = False
            _lane_by_lane(states, params, t, gyro, accel, mag, k, steps, out)


@kernel
def _no_pause(params: Array, t: Array, k: int, steps: int) -> bool:
    """Whether no step of the block is longer than a gyro sample holds."""
    longest = 0.0
    for i in range(k, k + steps):
        longest = max(longest, t[i] - t[max(i - 1, 0)])
    return longest <= params[at.HOLD]


@kernel
def _northed(states: Array, params: Array) -> bool:
    """Whether no lane waits for a first sample of its magnetometer."""
    northed = True
    for lane in range(LANES):
        northed = northed and states[lane, at.NORTHED] >= params[at.START_NORTH]
    return northed


@kernel
def _blind(readings: Array, steps: int) -> bool:
    """Whether no lane has a sample of its magnetometer."""
    blind = True
    for i in range(steps):
        for j in range(LANES):
            place = (i * READING + 6) * LANES + j
            blind = blind and math.isnan(
                readings[place] + readings[place + LANES] + readings[place + 2 * LANES]
            )
    return blind


@kernel
def _together(states: Array) -> bool:
    """Whether all lanes have begun, and their windows at the same sample."""
    together = True
    for lane in range(LANES):
        together = together and states[lane, at.LEVELLED] == 1.0
        for place in (at.LENGTH, at.NEXT_PART, at.SUMMED):
            together = together and states[lane, place] == states[0, place]
    return together


@kernel
def _load(s: Array, states: Array) -> None:
    for lane in range(LANES):
        for row in range(_NEW):
            s[row * LANES + lane] = states[lane, _PLACES[row]]
    s[_LENGTH], s[_SUMMED_LENGTH], s[_NEXT_PART] = (
        states[0, at.LENGTH],
        states[0, at.SUMMED],
        states[0, at.NEXT_PART],
    )


@kernel
def _store(s: Array, states: Array) -> None:
    for lane in range(LANES):
        for row in range(_NEW):
            states[lane, _PLACES[row]] = s[row * LANES + lane]
        states[lane, at.LENGTH], states[lane, at.SUMMED] = s[_LENGTH], s[_SUMMED_LENGTH]
        states[lane, at.NEXT_PART] = s[_NEXT_PART]
        # What an ordinary step leaves behind.
        states[lane, at.FLAGS], states[lane, at.GAP] = states[lane, at.CALM], 0.0


@kernel
def _advance(
    s: Array,
    states: Array,
    readings: Array,
    answers: Array,
    params: Array,
    t: Array,
    k: int,
    steps: int,
    out: Columns,
) -> None:
    """Take all lanes through a block of steps; the block is answered up to every closing of the window."""
    wide_vectors()
    begin = 0
    for i in range(steps):
        dt = t[k + i] - t[k + i - 1]
        r = readings[i * READING * LANES : (i + 1) * READING * LANES]
        q = answers[i * AXES * LANES : (i + 1) * AXES * LANES]
        if _turn(s, r, q, params[at.CONING], dt, True) > 0:
            _turn(s, r, q, params[at.CONING], dt, False)
        _sum(s, r, dt)
        s[_LENGTH] += dt
        if s[_LENGTH] > s[_NEXT_PART]:
            _close_part(s, s[_LENGTH] - s[_SUMMED_LENGTH])
            s[_SUMMED_LENGTH] = s[_LENGTH]
            if is_over(s[_LENGTH], params):
                _answer(s, states, answers, out, k, begin, i + 1)
                begin = i + 1
                _close_windows(s, states, params, out, k + i)
            s[_NEXT_PART] = next_part(s[_LENGTH], params)
    _answer(s, states, answers, out, k, begin, steps)


@kernel
def _close_windows(s: Array, states: Array, params: Array, out: Columns, k: int) -> None:
    """Close the windows of all lanes with sample k, and answer it anew."""
    _store(s, states)
    for lane in range(LANES):
        close_window(states[lane], params)
        mine = of_lane(out, lane)
        tell(states[lane], mine, k)
        for c in range(3):
            mine.gyro_bias[k, c] = states[lane, at.GYRO_BIAS + c]
    _load(s, states)


@inlined
def _turn(s: Array, r: Array, q: Array, coning: float, dt: float, near: bool) -> int:
    """Put the axes after a step into _NEW and `q`; how many lanes were not as near as `near` takes for granted."""
    wide_vectors()
    far = 0
    for j in range(LANES):
        rows = _rows(s, _R, j)
        scale = _rows(s, _SCALE, j)
        gyro = r[j], r[LANES + j], r[2 * LANES + j]
        theta = corrected(scaled(dt, gyro), scale, _vector(s, _BIAS, j), dt)
        theta = added(theta, coning * dt * dt, cross(_vector(s, _RATE, j), gyro))
        rows = turned(rows, theta, near)
        _put(s, _NEW, j, rows[0])
        _put(s, _NEW + 3, j, rows[1])
        _put(s, _NEW + 6, j, rows[2])
        askew = dot(rows[0], rows[1])
        far += not (dot(theta, theta) < 0.01 and abs(askew) < 1e-8)
        rows = nearest_rotation(rows, askew, near)
        _put(q, 0, j, rows[0])
        _put(q, 3, j, rows[1])
        _put(q, 6, j, rows[2])
    return far


@inlined
def _sum(s: Array, r: Array, dt: float) -> None:
    """Make _NEW the axes, and add a sample to the sums of the window: the second half of `step`."""
    wide_vectors()
    for j in range(LANES):
        east, north, up = _rows(s, _NEW, j)
        _put(s, _R, j, east)
        _put(s, _R + 3, j, north)
        _put(s, _R + 6, j, up)
        gyro = r[j], r[LANES + j], r[2 * LANES + j]
        _put(s, _RATE, j, gyro)
        _put(s, _GYRO_SUM, j, added(_vector(s, _GYRO_SUM, j), 1.0, scaled(dt, gyro)))
        w2 = dot(gyro, gyro)
        s[_GYRO_SQUARES * LANES + j] += dt * w2
        accel = r[3 * LANES + j], r[4 * LANES + j], r[5 * LANES + j]
        a2 = dot(accel, accel)
        counts = 0.0 < a2 < NO_FORCE**2
        # Adding zero changes no sum, while a branch would keep lanes from being vectors.
        accel, a2, time = (accel, a2, dt) if counts else (NONE, 0.0, 0.0)
        s[_FORCE_SUM * LANES + j] += dt * dot(east, accel)
        s[(_FORCE_SUM + 1) * LANES + j] += dt * dot(north, accel)
        _put(s, _ACCEL_SUM, j, added(_vector(s, _ACCEL_SUM, j), dt, accel))
        s[_ACCEL_SQUARES * LANES + j] += dt * a2
        s[_ACCEL_TIME * LANES + j] += time
        mag, old = (r[6 * LANES + j], r[7 * LANES + j], r[8 * LANES + j]), _vector(s, _LATEST_MAG, j)
        same = mag[0] == old[0] and mag[1] == old[1] and mag[2] == old[2]
        seen = 0.0 < dot(mag, mag) < math.inf
        stuck = s[_STUCK * LANES + j] + dt * math.sqrt(w2) if same else 0.0
        s[_STUCK * LANES + j] = stuck if seen else s[_STUCK * LANES + j]
        _put(s, _LATEST_MAG, j, mag if seen else old)
        mag, count = (mag, 1.0) if seen else (NONE, 0.0)
        field = dot(east, mag), dot(north, mag), dot(up, mag)
        _put(s, _MAG_SUM, j, added(_vector(s, _MAG_SUM, j), 1.0, field))
        s[_MAG_COUNT * LANES + j] += count


@inlined
def _close_part(s: Array, dt: float) -> None:
    """Linearise a part of the window of all lanes: the first half of `close_part`."""
    wide_vectors()
    for j in range(LANES):
        turn = added(_vector(s, _GYRO_SUM, j), -1.0, _vector(s, _SUMMED, j))
        for i in range(3):
            for c in range(3):
                r = s[(_R + 3 * i + c) * LANES + j]
                place = (_TURN + 12 * i + c) * LANES + j
                s[place] -= r * dt
                s[place + 3 * LANES] -= r * turn[0]
                s[place + 6 * LANES] -= r * turn[1]
                s[place + 9 * LANES] -= r * turn[2]
        _put(s, _SUMMED, j, _vector(s, _GYRO_SUM, j))


@kernel
def _answer(s: Array, states: Array, answers: Array, out: Columns, k: int, begin: int, end: int) -> None:
    """Put what the steps from `begin` to `end` of the block at sample k say into their rows."""
    scatter(answers[begin * AXES * LANES :], out.R_NS, k + begin, end - begin)
    for lane in range(LANES):
        bias = s[_BIAS * LANES + lane], s[(_BIAS + 1) * LANES + lane], s[(_BIAS + 2) * LANES + lane]
        rows = out.gyro_bias[lane, k + begin : k + end]
        for i in range(end - begin):
            rows[i, 0], rows[i, 1], rows[i, 2] = bias
        if states[lane, at.CALM] != 0.0:
            rest, disturbed, held = flags_of(states[lane, at.CALM])
            for i in range(k + begin, k + end):
                out.rest[lane, i], out.disturbed[lane, i], out.held[lane, i] = rest, disturbed, held


@kernel
def _lane_by_lane(
    states: Array,
    params: Array,
    t: Array,
    gyro: Array,
    accel: Array,
    mag: Array,
    k: int,
    steps: int,
    out: Columns,
) -> None:
    sample = np.empty(READING)
    for lane in range(LANES):
        state, mine = states[lane], of_lane(out, lane)
        for i in range(k, k + steps):
            for c in range(3):
                sample[c], sample[3 + c], sample[6 + c] = gyro[lane, i, c], accel[lane, i, c], mag[lane, i, c]
            update(state, params, sample, t[i] - t[max(i - 1, 0)])
            tell(state, mine, i)
            for c in range(3):
                mine.gyro_bias[i, c] = state[at.GYRO_BIAS + c]


@inlined
def _vector(s: Array, row: int, lane: int) -> Vector:
    return s[row * LANES + lane], s[(row + 1) * LANES + lane], s[(row + 2) * LANES + lane]


@inlined
def _rows(s: Array, row: int, lane: int) -> Rows:
    return _vector(s, row, lane), _vector(s, row + 3, lane), _vector(s, row + 6, lane)


@inlined
def _put(s: Array, row: int, lane: int, v: Vector) -> None:
    s[row * LANES + lane], s[(row + 1) * LANES + lane], s[(row + 2) * LANES + lane] = v
