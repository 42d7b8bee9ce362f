"""Turns many recordings at once into attitude by the default step: sixteen abreast, one in each lane of vectors.

Samples and the parts of a window are taken abreast; windows close in all lanes at the same sample, one after the
other. A block of samples in which any lane has something out of the ordinary (a gap of the gyro, no time, no attitude
yet, a window that began at another sample) is taken lane by lane.
"""

import math

import numpy as np

from kreisel.estimate.abreast import (
    AXES,
    PIECE,
    READING,
    TOLD,
    gather,
    scatter,
    scatter_bias,
    tell_abreast,
)
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.lanes import BLOCK, ordinary
from kreisel.estimate.filters.dcm.step import NO_FORCE, corrected, turned, update
from kreisel.estimate.filters.dcm.window import close_window, is_over, next_part
from kreisel.maths.kernels import LANES, inlined, kernel, wide_vectors
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
def batch_of_lanes(states: Array, params: Array, dt: Array, readings: Array, answers: Array) -> None:
    """The steps through all samples of LANES recordings, and what the states say after each.

    states (LANES, STATE); dt (n,); readings (n, 9, LANES); answers (n, 9 or 13, LANES).
    """
    s, flat = np.empty(_SIZE), readings.reshape(-1)
    loaded = False
    for k in range(0, dt.shape[0], BLOCK):
        end = min(k + BLOCK, dt.shape[0])
        block = flat[k * READING * LANES : end * READING * LANES]
        fine = ordinary(dt[k:end], block) and dt[k:end].max() <= params[at.HOLD]
        fine = fine and (_northed(states, params) or _blind(block, end - k))
        if fine and (loaded or _together(states)):
            if not loaded:
                _load(s, states)
            loaded = True
            _advance(s, states, dt[k:end], block, answers[k:end], params)
        else:
            if loaded:
                _store(s, states)
            loaded = False
            _lane_by_lane(states, params, dt[k:end], readings[k:end], answers[k:end])
    if loaded:
        _store(s, states)


@kernel
def batch_of_rows(
    states: Array, params: Array, dt: Array, gyro: Array, accel: Array, mag: Array, out: Columns
) -> None:
    """`batch_of_lanes` of recordings (LANES, n, 3) that lie one after the other, into columns without flags yet."""
    readings, answers = np.empty((PIECE, READING, LANES)), np.empty((PIECE, TOLD, LANES))
    for first in range(0, dt.shape[0], PIECE):
        n = min(PIECE, dt.shape[0] - first)
        gather(gyro, accel, mag, first, readings[:n])
        batch_of_lanes(states, params, dt[first : first + n], readings[:n], answers[:n])
        scatter(answers[:n], first, out)
        scatter_bias(answers[:n], first, out.gyro_bias)


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
def _advance(s: Array, states: Array, dt: Array, readings: Array, answers: Array, params: Array) -> None:
    """Take all lanes through a block of steps; bias and flags are told up to every closing of the window."""
    wide_vectors()
    flat, told, begin = answers.reshape(-1), answers.shape[1], 0
    for i in range(dt.shape[0]):
        r = readings[i * READING * LANES : (i + 1) * READING * LANES]
        q = flat[i * told * LANES : (i * told + AXES) * LANES]
        if _turn(s, r, q, params[at.CONING], dt[i], True) > 0:
            _turn(s, r, q, params[at.CONING], dt[i], False)
        _sum(s, r, dt[i])
        s[_LENGTH] += dt[i]
        if s[_LENGTH] > s[_NEXT_PART]:
            _close_part(s, s[_LENGTH] - s[_SUMMED_LENGTH])
            s[_SUMMED_LENGTH] = s[_LENGTH]
            if is_over(s[_LENGTH], params):
                _tell_what_lasts(s, states, answers[begin:i])
                begin = i + 1
                _close_windows(s, states, params, answers, i)
            s[_NEXT_PART] = next_part(s[_LENGTH], params)
    _tell_what_lasts(s, states, answers[begin:])


@kernel
def _close_windows(s: Array, states: Array, params: Array, answers: Array, i: int) -> None:
    """Close the windows of all lanes with sample i, and answer it anew."""
    _store(s, states)
    for lane in range(LANES):
        close_window(states[lane], params)
        tell_abreast(states[lane], answers, i, lane)
    _load(s, states)


@kernel
def _tell_what_lasts(s: Array, states: Array, answers: Array) -> None:
    """Put bias and flags, which change as a window closes, into answers that have room for them."""
    if answers.shape[1] > AXES:
        for i in range(answers.shape[0]):
            for lane in range(LANES):
                for c in range(3):
                    answers[i, at.GYRO_BIAS + c, lane] = s[(_BIAS + c) * LANES + lane]
                answers[i, at.FLAGS, lane] = states[lane, at.CALM]


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
def _lane_by_lane(states: Array, params: Array, dt: Array, readings: Array, answers: Array) -> None:
    for lane in range(LANES):
        for i in range(dt.shape[0]):
            update(states[lane], params, readings[i, :, lane].copy(), dt[i])
            tell_abreast(states[lane], answers, i, lane)


@inlined
def _vector(s: Array, row: int, lane: int) -> Vector:
    return s[row * LANES + lane], s[(row + 1) * LANES + lane], s[(row + 2) * LANES + lane]


@inlined
def _rows(s: Array, row: int, lane: int) -> Rows:
    return _vector(s, row, lane), _vector(s, row + 3, lane), _vector(s, row + 6, lane)


@inlined
def _put(s: Array, row: int, lane: int, v: Vector) -> None:
    s[row * LANES + lane], s[(row + 1) * LANES + lane], s[(row + 2) * LANES + lane] = v
