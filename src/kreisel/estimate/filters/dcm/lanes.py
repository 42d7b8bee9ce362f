"""Turns many recordings at once into attitude by the published step: sixteen abreast, one in each lane of vectors.

Between steps the axes lie in one flat array with the lane as its last index, and the inner loop runs over lanes:
the compiler makes vector instructions of it, whose operations are those of one lane to the last bit. A step in which
any lane has something out of the ordinary (a gap of the gyro, no time, no attitude yet) is taken lane by lane.
"""

import numpy as np

from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.published import advanced, setting_of, step, waits, weights_of
from kreisel.estimate.filters.dcm.start import is_rate
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, scaled

LANES = 16

# Places in the scratch of a step, in units of LANES: axes, then readings (gyro, accel, mag, dt). They are constants:
# of places that it cannot compare the compiler assumes the worst, and takes lane by lane what they hold.
_AXES = 9
_READING = 10

# Steps whose readings are gathered at once: lines of memory are fetched whole.
_BLOCK = 16


@kernel
def batch_of_lanes(
    states: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, first: int, answers: Array
) -> None:
    """The steps from sample `first` on of LANES recordings; answers (LANES, m, at.ANSWER) as `batch` has them.

    states (LANES, STATE); t (LANES, n); gyro, accel, mag (LANES, n, 3).
    """
    scratch, readings = np.empty((_AXES + _READING) * LANES), np.empty(_BLOCK * _READING * LANES)
    begun = False
    for block in range(0, answers.shape[1], _BLOCK):
        steps = min(_BLOCK, answers.shape[1] - block)
        begun = begun or _begun(states, params)
        ordinary = _gather(readings, t, gyro, accel, mag, first + block, steps) and begun
        if ordinary:
            _load_axes(scratch, states)
            for i in range(steps):
                _advance(scratch, readings, params, i)
                _answer(scratch, states, answers, block + i)
            _store_axes(scratch, states)
        else:
            _lane_by_lane(states, params, t, gyro, accel, mag, first + block, answers, block, steps)


@kernel
def _begun(states: Array, params: Array) -> bool:
    begun = params[at.RATE_HZ] == 0.0 and params[at.EXACT] == 0.0
    for lane in range(LANES):
        begun = begun and not waits(states[lane], params)
    return begun


@kernel
def _gather(readings: Array, t: Array, gyro: Array, accel: Array, mag: Array, k: int, steps: int) -> bool:
    """Put the readings from sample k on beside each other; True where all are ordinary."""
    ordinary = k > 0
    for lane in range(LANES):
        for i in range(steps):
            place = i * _READING * LANES + lane
            j = k + i
            for c in range(3):
                readings[place + c * LANES] = gyro[lane, j, c]
                readings[place + (3 + c) * LANES] = accel[lane, j, c]
                readings[place + (6 + c) * LANES] = mag[lane, j, c]
            dt = t[lane, j] - t[lane, max(j - 1, 0)]
            readings[place + 9 * LANES] = dt
            g = gyro[lane, j, 0], gyro[lane, j, 1], gyro[lane, j, 2]
            ordinary = ordinary and is_rate(g) and dt > 0.0
    return ordinary


@kernel
def _advance(s: Array, readings: Array, params: Array, step: int) -> None:
    """Move the axes of all lanes with the readings of one step."""
    weights, setting = weights_of(params, 0.0), setting_of(params)
    for j in range(_READING * LANES):
        s[_AXES * LANES + j] = readings[step * _READING * LANES + j]
    for j in range(LANES):
        east = s[j], s[LANES + j], s[2 * LANES + j]
        north = s[3 * LANES + j], s[4 * LANES + j], s[5 * LANES + j]
        up = s[6 * LANES + j], s[7 * LANES + j], s[8 * LANES + j]
        gyro = s[9 * LANES + j], s[10 * LANES + j], s[11 * LANES + j]
        accel = s[12 * LANES + j], s[13 * LANES + j], s[14 * LANES + j]
        mag = s[15 * LANES + j], s[16 * LANES + j], s[17 * LANES + j]
        turn = scaled(-s[18 * LANES + j], gyro)
        east, north, up = advanced((east, north, up), turn, accel, mag, weights, setting, False)
        s[j], s[LANES + j], s[2 * LANES + j] = east
        s[3 * LANES + j], s[4 * LANES + j], s[5 * LANES + j] = north
        s[6 * LANES + j], s[7 * LANES + j], s[8 * LANES + j] = up


@kernel
def _answer(scratch: Array, states: Array, answers: Array, i: int) -> None:
    for lane in range(LANES):
        for c in range(_AXES):
            answers[lane, i, c] = scratch[c * LANES + lane]
        for c in range(at.GYRO_BIAS, at.FLAGS):
            answers[lane, i, c] = 0.0
        answers[lane, i, at.FLAGS] = states[lane, at.CALM]
        answers[lane, i, at.HEADING] = states[lane, at.HEADING]


@kernel
def _load_axes(scratch: Array, states: Array) -> None:
    for lane in range(LANES):
        for c in range(_AXES):
            scratch[c * LANES + lane] = states[lane, at.R_NS + c]


@kernel
def _store_axes(scratch: Array, states: Array) -> None:
    """Put the axes, and what the latest of these ordinary steps leaves behind, into the states."""
    for lane in range(LANES):
        for c in range(_AXES):
            states[lane, at.R_NS + c] = scratch[c * LANES + lane]
        for c in range(3):
            states[lane, at.RATE + c] = scratch[(_AXES + c) * LANES + lane]
        states[lane, at.FLAGS], states[lane, at.GAP] = states[lane, at.CALM], 0.0


@kernel
def _lane_by_lane(
    states: Array,
    params: Array,
    t: Array,
    gyro: Array,
    accel: Array,
    mag: Array,
    k: int,
    answers: Array,
    block: int,
    steps: int,
) -> None:
    for lane in range(LANES):
        state = states[lane]
        for i in range(steps):
            j = k + i
            g = gyro[lane, j, 0], gyro[lane, j, 1], gyro[lane, j, 2]
            a = accel[lane, j, 0], accel[lane, j, 1], accel[lane, j, 2]
            m = mag[lane, j, 0], mag[lane, j, 1], mag[lane, j, 2]
            step(state, params, g, a, m, t[lane, j] - t[lane, max(j - 1, 0)])
            for c in range(at.ANSWER):
                answers[lane, block + i, c] = state[c]
