"""Turns a whole recording into attitudes that each know all of it, block by block in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from kreisel.estimate.answers import Columns
from kreisel.estimate.filters.dcm.window import turn_world
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.backward import AFTER, BEFORE, FOUND, SIGMA, look_back
from kreisel.estimate.filters.mekf.one import step
from kreisel.estimate.filters.mekf.rival import attend
from kreisel.estimate.filters.mekf.step import batch, tell_all
from kreisel.maths.kernels import kernel
from kreisel.maths.vectors import Array, added, load, scaled, store

Rows = npt.NDArray[np.int64]

ANSWER = at.SIGMA + 3

# s of a block, and s beyond it that it looks ahead: more than twice the time over which a heading is averaged.
_BLOCK, _AHEAD = 300.0, 150.0

# s: a first answer that had to begin again by then began wrong; later it was a sensor that failed.
_STARTED = 30.0

# rad: how well a second pass knows at least which way is up; several times as well as that it does in fact.
_TILT = 0.05


def smoothed(
    state: Array, parameters: Array, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns
) -> None:
    """Fill `out` from a filter's first `state`.

    The first block is gone through twice: what it tells about its own beginning is where the second pass begins.
    """
    inputs = parameters, t, gyro, accel, mag
    once = state.copy()
    _, answers, again = next(blocks(once, *inputs))
    if 0 <= again < _end(t, t[0] + _STARTED) and once[at.LEVELLED] == 1.0:
        # What later samples told ends there: the beginning is found from behind.
        start = _gone_back(state, *inputs, answers)
        _, answers, _ = next(blocks(start, *inputs))
    if once[at.LEVELLED] == 1.0:
        _begin_anew(state, parameters, answers, mag[: len(answers)])
    for first, answers, _ in blocks(state, *inputs):
        put(answers, out, first)


def _gone_back(
    state: Array, parameters: Array, t: Array, gyro: Array, accel: Array, mag: Array, answers: Array
) -> Array:
    """`state` with the attitude that the filter has when it goes from the last of `answers` back to their first."""
    start, back = state.copy(), state.copy()
    last = len(answers) - 1
    back[at.R_NS : at.R_NS + 9] = answers[last, at.R_NS : at.R_NS + 9]
    back[at.LEVELLED] = back[at.NORTHED] = 1.0
    columns = Columns.of((last + 1,), bias=True, sigma=True)
    # What turned S on the way to a sample turns it back on the way from there.
    turns = -np.roll(gyro[: last + 1], -1, axis=0)
    t, gyro, accel, mag = (
        np.ascontiguousarray(x[last::-1]) for x in (t[last] - t[: last + 1], turns, accel, mag)
    )
    batch(back, parameters, t, gyro, accel, mag, columns)
    start[at.R_NS : at.R_NS + 9] = back[at.R_NS : at.R_NS + 9]
    start[at.LEVELLED], start[at.FLAGS], start[at.CALM] = 1.0, 0.0, 0.0
    return start


@kernel
def put(answers: Array, out: Columns, first: int) -> None:
    """Put answers (m, ANSWER) in the rows of `out` from `first` on."""
    for j in range(answers.shape[0]):
        tell_all(answers[j], out, first + j)


def _begin_anew(state: Array, parameters: Array, answers: Array, mag: Array) -> None:
    """Begin with the attitude and the field of smoothed answers, hardly less uncertain than before.

    Biases and all else in which errors are linear keep their first values: knowing them twice would be too much.
    """
    state[at.R_NS : at.R_NS + 9] = answers[0, at.R_NS : at.R_NS + 9]
    state[at.LEVELLED], state[at.FLAGS], state[at.CALM] = 1.0, 0.0, 0.0
    for i in range(2):
        state[at.COVARIANCE + i * (at.ERRORS + 1)] = _TILT**2
    seen = np.flatnonzero(np.isfinite(mag).all(axis=1))
    if not len(seen) or parameters[at.DOF] != 9.0:
        return
    state[at.NORTHED] = 1.0
    if seen[0] > 0:
        # The first sample of a magnetometer turned the answer then, and not what came before.
        jump = answers[seen[0], at.HEADING] - answers[seen[0] - 1, at.HEADING]
        turn_world(state, (0.0, 0.0, jump))
    R = answers[seen, at.R_NS : at.R_NS + 9].reshape(-1, 3, 3)
    east, north, up = np.einsum("nij,nj->in", R, mag[seen])
    field = np.median(np.hypot(east, north)), np.median(up)
    state[at.FIELD : at.FIELD + 2] = state[at.CANDIDATE : at.CANDIDATE + 2] = field
    state[at.FIELD_TIME] = parameters[at.FIELD_MEMORY]


def blocks(
    state: Array, parameters: Array, t: Array, gyro: Array, accel: Array, mag: Array
) -> Iterator[tuple[int, Array, int]]:
    """First sample and smoothed answers (m, ANSWER) of each block; `state` moves on.

    With them comes the first sample after which the filter began again, -1 where it never did: what came later does not
    reach back beyond it.
    """
    inputs = parameters, t, gyro, accel, mag
    first = latest = 0
    while first < len(t):
        end = _end(t, t[first] + _BLOCK)
        last = _end(t, t[end - 1] + _AHEAD)
        rows = int((t[last - 1] - t[latest]) / parameters[at.WINDOW]) + 3
        log, ends = np.empty((rows, at.LOG)), np.empty(rows, np.int64)
        answers = np.empty((last - first, ANSWER))
        # What was known before the first window of this block is its row 0.
        ends[0], log[0] = latest, state[at.COVARIANCE : at.LOG_END]
        inside = answers[: end - first]
        count = log_forward(state, *inputs, first, inside, log, ends, 1)
        kept, known = state.copy(), int(ends[count - 1])
        count = log_forward(state, *inputs, end, answers[end - first :], log, ends, count)
        found = np.empty((count, FOUND))
        look_back(log[:count], np.empty((at.ERRORS + 2, at.ERRORS)), found)
        correct(t, first, inside, ends[:count], found)
        state[:] = kept
        again = np.flatnonzero(log[1:count, at.CHANGE_FORCE - at.COVARIANCE] == at.NOTHING)
        yield first, inside, int(ends[again[0] + 1]) if len(again) else -1
        first, latest = end, known


def _end(t: Array, until: float) -> int:
    return max(int(np.searchsorted(t, until, side="right")), 1)


@kernel
def log_forward(
    state: Array,
    params: Array,
    t: Array,
    gyro: Array,
    accel: Array,
    mag: Array,
    first: int,
    answers: Array,
    log: Array,
    ends: Rows,
    count: int,
) -> int:
    """The filter's steps, and a row of the log for every window that closes; how many there are then."""
    for k in range(first, first + answers.shape[0]):
        closed = state[at.WINDOWS]
        g = gyro[k, 0], gyro[k, 1], gyro[k, 2]
        a = accel[k, 0], accel[k, 1], accel[k, 2]
        m = mag[k, 0], mag[k, 1], mag[k, 2]
        dt = t[k] - t[max(k - 1, 0)]
        step(state, params, g, a, m, dt)
        if state[at.DUE] > 0.0:
            attend(state, params, g, a, m, dt)
        for i in range(answers.shape[1]):
            answers[k - first, i] = state[i]
        if state[at.WINDOWS] != closed:
            ends[count] = k
            for i in range(at.LOG):
                log[count, i] = state[at.COVARIANCE + i]
            count += 1
    return count


@kernel
def correct(t: Array, first: int, answers: Array, ends: Rows, found: Array) -> None:
    """Take from answers, to samples from `first` on, what was found about the windows that end at `ends`.

    Within a window the error goes straight from that after its first to that before its last correction.
    """
    after = 0
    for j in range(answers.shape[0]):
        k = first + j
        while after < len(ends) - 1 and ends[after] < k:
            after += 1
        before = max(after - 1, 0)
        span = t[ends[after]] - t[ends[before]]
        share = min((t[k] - t[ends[before]]) / span, 1.0) if span > 0.0 else 1.0
        closes = ends[after] <= k
        theta = load(found[after], AFTER if closes else BEFORE)
        if not closes:
            theta = added(scaled(share, theta), 1.0 - share, load(found[before], AFTER))
        errors = found[after if closes else before]
        turn_world(answers[j], scaled(-1.0, theta))
        bias = load(errors, AFTER + at.B)
        store(answers[j], at.GYRO_BIAS, added(load(answers[j], at.GYRO_BIAS), -1.0, bias))
        for i in range(3):
            a, b = found[before, SIGMA + i], found[after, SIGMA + i]
            answers[j, at.SIGMA + i] = a + share * (b - a)
