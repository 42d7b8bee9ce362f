"""Turns many recordings at once into attitude by the published step: sixteen abreast, one in each lane of vectors.

A block of steps in which any lane has something out of the ordinary (a gap of the gyro, no time, no attitude yet) is
taken lane by lane.
"""

import numpy as np

from kreisel.estimate.abreast import AXES, PIECE, READING, TOLD, gather, scatter, tell_abreast
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm.lanes import BLOCK, ordinary
from kreisel.estimate.filters.dcm.published import asked, moved, setting_of, step, waits, weights_of
from kreisel.maths.kernels import LANES, inlined, kernel, wide_vectors
from kreisel.maths.vectors import Array, Vector, dot, load, nearest_rotation, scaled

# A step of less than 0.028 rad, and axes that are askew by less than this, need no roots (see `moved`).
_STEP2, _ASKEW = 0.8e-3, 1e-8


@kernel
def batch_of_lanes(states: Array, params: Array, dt: Array, readings: Array, answers: Array) -> None:
    """The steps through all samples of LANES recordings, and what the states say after each.

    states (LANES, STATE); dt (n,); readings (n, 9, LANES); answers (n, 9 or 13, LANES).
    """
    wide_vectors()
    axes, flat = np.empty(2 * AXES * LANES), readings.reshape(-1)
    begun = False
    for k in range(0, dt.shape[0], BLOCK):
        end = min(k + BLOCK, dt.shape[0])
        begun = begun or _begun(states, params)
        block = flat[k * READING * LANES : end * READING * LANES]
        if begun and ordinary(dt[k:end], block):
            _load_axes(axes, states)
            _advance(axes, dt[k:end], block, answers[k:end], params)
            _store_axes(axes, block, states)
        else:
            _lane_by_lane(states, params, dt[k:end], readings[k:end], answers[k:end])


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


@kernel
def _begun(states: Array, params: Array) -> bool:
    begun = params[at.RATE_HZ] == 0.0 and params[at.EXACT] == 0.0
    for lane in range(LANES):
        begun = begun and not waits(states[lane], params)
    return begun


@kernel
def _advance(s: Array, dt: Array, readings: Array, answers: Array, params: Array) -> None:
    """Move the axes of all lanes through the steps, and put the rotations nearest to them into the answers."""
    wide_vectors()
    weights, setting = weights_of(params, 0.0), setting_of(params)
    flat, told = answers.reshape(-1), answers.shape[1]
    for i in range(dt.shape[0]):
        r = readings[i * READING * LANES : (i + 1) * READING * LANES]
        q = flat[i * told * LANES : (i * told + AXES) * LANES]
        if _move(s, r, q, weights, setting, dt[i], True) > 0:
            _move(s, r, q, weights, setting, dt[i], False)
        for j in range(AXES * LANES):
            s[j] = s[AXES * LANES + j]
        # Ordinary steps raise no flags and know no bias.
        rest = flat[(i * told + AXES) * LANES : (i + 1) * told * LANES]
        for j in range(rest.shape[0]):
            rest[j] = 0.0


@inlined
def _move(s: Array, r: Array, q: Array, weights: Vector, setting: Vector, dt: float, near: bool) -> int:
    """Move the axes at the head of `s` to behind it; how many lanes were not as near as `near` takes for granted."""
    wide_vectors()
    far = 0
    for j in range(LANES):
        east = s[j], s[LANES + j], s[2 * LANES + j]
        north = s[3 * LANES + j], s[4 * LANES + j], s[5 * LANES + j]
        up = s[6 * LANES + j], s[7 * LANES + j], s[8 * LANES + j]
        gyro = r[j], r[LANES + j], r[2 * LANES + j]
        accel = r[3 * LANES + j], r[4 * LANES + j], r[5 * LANES + j]
        mag = r[6 * LANES + j], r[7 * LANES + j], r[8 * LANES + j]
        askew = dot(east, north)
        dtheta = asked((east, north, up), askew, scaled(-dt, gyro), accel, mag, weights, setting, near)
        rows = moved((east, north, up), askew, dtheta, near)
        s[9 * LANES + j], s[10 * LANES + j], s[11 * LANES + j] = rows[0]
        s[12 * LANES + j], s[13 * LANES + j], s[14 * LANES + j] = rows[1]
        s[15 * LANES + j], s[16 * LANES + j], s[17 * LANES + j] = rows[2]
        now = dot(rows[0], rows[1])
        far += not (dot(dtheta, dtheta) < _STEP2 and abs(askew) < _ASKEW and abs(now) < _ASKEW)
        rows = nearest_rotation(rows, now, near)
        q[j], q[LANES + j], q[2 * LANES + j] = rows[0]
        q[3 * LANES + j], q[4 * LANES + j], q[5 * LANES + j] = rows[1]
        q[6 * LANES + j], q[7 * LANES + j], q[8 * LANES + j] = rows[2]
    return far


@kernel
def _load_axes(axes: Array, states: Array) -> None:
    for lane in range(LANES):
        for c in range(AXES):
            axes[c * LANES + lane] = states[lane, at.R_NS + c]


@kernel
def _store_axes(axes: Array, readings: Array, states: Array) -> None:
    """Put the axes, and what the latest of these ordinary steps leaves behind, into the states."""
    latest = readings[readings.shape[0] - READING * LANES :]
    for lane in range(LANES):
        for c in range(AXES):
            states[lane, at.R_NS + c] = axes[c * LANES + lane]
        for c in range(3):
            states[lane, at.RATE + c] = latest[c * LANES + lane]
        states[lane, at.FLAGS], states[lane, at.GAP] = states[lane, at.CALM], 0.0


@kernel
def _lane_by_lane(states: Array, params: Array, dt: Array, readings: Array, answers: Array) -> None:
    for lane in range(LANES):
        for i in range(dt.shape[0]):
            r = readings[i, :, lane]
            step(states[lane], params, load(r, 0), load(r, 3), load(r, 6), dt[i])
            tell_abreast(states[lane], answers, i, lane)
