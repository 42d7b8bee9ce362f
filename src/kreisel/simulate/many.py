"""Turns the ideal reading of an IMU into what it read in many runs of one motion, and into nothing beside that."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.maths.kernels import LANES, argument, kernel
from kreisel.maths.random import stream, words_abreast
from kreisel.simulate.chain import read
from kreisel.simulate.clock import spread
from kreisel.simulate.effects import LaneEffect
from kreisel.simulate.imu import Imu
from kreisel.simulate.session import SENSORS, blocks, contexts_of, felt_by, parts_of

Draws = Sequence[tuple[int, int]]
Fill = Callable[[slice, Array], None]


def read_abreast(
    imu: Imu, motion: Motion, ideal: ImuRecording, draws: Draws, room: Array
) -> Iterator[tuple[slice, Array]]:
    """What `imu.record` measures in the LANES runs `draws`, (seed, run) each: rows of the motion, and readings there.

    ideal : what `imu.ideal(motion)` made. room : (m, 9, LANES), takes gyro, accel and mag_uT of m samples at a time,
    NaN where there is no sensor; readings are the part of it that those of `rows` fill.
    The stamps are those of the motion unless the clock errs. Raises ValueError as `record` does.
    """
    imu._check(motion)
    n, there = len(motion), [sensor for sensor in SENSORS if getattr(ideal, sensor) is not None]
    for k, sensor in enumerate(SENSORS):
        if sensor not in there:
            room[:, 3 * k : 3 * k + 3] = np.nan
    fills = [_fill(imu, sensor, motion, ideal, draws, len(room)) for sensor in there]
    clocks = [stream(seed, run, imu.mount.name, "clock") for seed, run in draws if imu.clock.loss]
    lost = [imu.clock.lost(n, each) for each in clocks]
    for rows in blocks(n, len(room)):
        readings = room[: rows.stop - rows.start]
        for fill in fills:
            fill(rows, readings)
        for lane, mine in enumerate(lost):
            readings[mine[rows], :, lane] = np.nan
        yield rows, readings


def _fill(imu: Imu, sensor: str, motion: Motion, ideal: ImuRecording, draws: Draws, samples: int) -> Fill:
    """What puts the readings of one sensor into their places, asked for rows one after the other."""
    effects, sampling = parts_of(imu, sensor)
    felt, first = felt_by(sampling, sensor, motion, ideal), 3 * SENSORS.index(sensor)
    streams_of = [partial(stream, seed, run, f"{imu.mount.name}/{sensor}") for seed, run in draws]
    acting = [effect for effect in effects if not effect.idle]
    if isinstance(felt.rows, slice) and not acting:
        return lambda rows, readings: _spread(argument(felt.reading[rows]), first, readings)
    if isinstance(felt.rows, slice) and len(acting) == 1 and isinstance(acting[0], LaneEffect):
        (effect,), contexts = acting, contexts_of(imu, sensor, motion, felt, block=samples)
        words = words_abreast([stream_of(effect.name) for stream_of in streams_of])

        def fill(rows: slice, readings: Array) -> None:
            words[3] = rows.start
            effect.apply_abreast(felt.reading[rows], next(contexts), words, first, readings)

        return fill
    found, surroundings = np.empty((LANES, *felt.reading.shape)), list(contexts_of(imu, sensor, motion, felt))
    for mine, stream_of in zip(found, streams_of, strict=True):
        read(effects, felt.reading, surroundings, stream_of, mine)
    whole = np.stack([spread(mine, felt.rows, len(motion)) for mine in found])
    return lambda rows, readings: _beside(whole[:, rows], first, readings)


@kernel
def _spread(ideal: Array, first: int, readings: Array) -> None:
    """Put what all runs share (n, 3) into rows from `first` on of readings (n, 9, LANES)."""
    for i in range(ideal.shape[0]):
        for c in range(3):
            for lane in range(LANES):
                readings[i, first + c, lane] = ideal[i, c]


@kernel
def _beside(found: Array, first: int, readings: Array) -> None:
    """Put readings (LANES, n, 3) into rows from `first` on of readings (n, 9, LANES)."""
    for lane in range(LANES):
        for i in range(readings.shape[0]):
            for c in range(3):
                readings[i, first + c, lane] = found[lane, i, c]
