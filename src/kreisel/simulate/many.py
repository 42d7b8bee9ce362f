"""Turns the ideal reading of an IMU into what it read in many runs of one motion, and into nothing beside that."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.maths.kernels import LANES, argument, kernel
from kreisel.maths.random import Stream, stream, words_abreast
from kreisel.simulate.chain import BLOCK, Felt, read
from kreisel.simulate.clock import spread
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect, LaneEffect
from kreisel.simulate.imu import Imu
from kreisel.simulate.session import SENSORS, blocks, contexts_of, felt_by, parts_of

Draws = Sequence[tuple[int, int]]

ROWS = 3 * len(SENSORS)
"""Rows of readings abreast: three of each sensor."""


class Abreast:
    """An IMU that records LANES runs of one motion at once; what these share is made once for all that follow.

    ideal : what `imu.ideal(motion)` made. samples : how many are read at a time.
    Raises ValueError as `record` does.
    """

    def __init__(self, imu: Imu, motion: Motion, ideal: ImuRecording, samples: int) -> None:
        imu._check(motion)
        self._imu, self._count, self._samples = imu, len(motion), samples
        there = [sensor for sensor in SENSORS if getattr(ideal, sensor) is not None]
        self._missing = [3 * k for k, sensor in enumerate(SENSORS) if sensor not in there]
        self._channels = [_Channel.of(imu, sensor, motion, ideal, samples) for sensor in there]

    def read(self, draws: Draws, room: Array) -> Iterator[tuple[slice, Array]]:
        """What `record` measures in the runs `draws`, (seed, run) each: rows of the motion, and readings there.

        room : (samples, 9, LANES), takes gyro, accel and mag_uT, NaN where there is no sensor; readings are the part
        of it that those of `rows` fill. The stamps are those of the motion unless the clock errs.
        """
        for row in self._missing:
            room[:, row : row + 3] = np.nan
        imu = self._imu
        fills = [channel.fill(draws, imu.mount.name) for channel in self._channels]
        clocks = [stream(seed, run, imu.mount.name, "clock") for seed, run in draws if imu.clock.loss]
        lost = [imu.clock.lost(self._count, each) for each in clocks]
        for rows in blocks(self._count, self._samples):
            readings = room[: rows.stop - rows.start]
            for fill in fills:
                fill(rows, readings)
            for lane, mine in enumerate(lost):
                readings[mine[rows], :, lane] = np.nan
            yield rows, readings


@dataclass(frozen=True, slots=True, eq=False)
class _Channel:
    """One sensor, what it feels, and what surrounds each block of that."""

    sensor: str
    count: int  # rows of the motion
    felt: Felt
    acting: Sequence[Effect]
    together: bool  # whether they act on all runs at once
    contexts: Sequence[Context]

    @classmethod
    def of(cls, imu: Imu, sensor: str, motion: Motion, ideal: ImuRecording, samples: int) -> _Channel:
        effects, sampling = parts_of(imu, sensor)
        felt, acting = felt_by(sampling, sensor, motion, ideal), [each for each in effects if not each.idle]
        # The first effect makes many readings of one; another would need one that goes from many to many.
        able = not acting or (len(acting) == 1 and isinstance(acting[0], LaneEffect))
        together = isinstance(felt.rows, slice) and able
        contexts = contexts_of(imu, sensor, motion, felt, block=samples if together else BLOCK)
        return cls(sensor, len(motion), felt, acting, together, list(contexts))

    def fill(self, draws: Draws, name: str) -> Callable[[slice, Array], None]:
        """What puts the readings of some rows into their places, asked for them in their order."""
        first = 3 * SENSORS.index(self.sensor)
        streams_of = [partial(stream, seed, run, f"{name}/{self.sensor}") for seed, run in draws]
        if not self.together:
            found = self._one_by_one(streams_of)
            return lambda rows, readings: _beside(found[:, rows], first, readings)
        if not self.acting:
            return lambda rows, readings: _spread(argument(self.felt.reading[rows]), first, readings)
        (effect,), contexts = self.acting, iter(self.contexts)
        words = words_abreast([stream_of(effect.name) for stream_of in streams_of])

        def fill(rows: slice, readings: Array) -> None:
            words[3] = rows.start
            effect.apply_abreast(self.felt.reading[rows], next(contexts), words, first, readings)  # type: ignore[attr-defined]

        return fill

    def _one_by_one(self, streams_of: Sequence[Callable[[str], Stream]]) -> Array:
        """The readings of all rows (LANES, n, 3)."""
        found = np.empty((LANES, *self.felt.reading.shape))
        for mine, stream_of in zip(found, streams_of, strict=True):
            read(self.acting, self.felt.reading, self.contexts, stream_of, mine)
        if isinstance(self.felt.rows, slice):
            return found
        return np.stack([spread(mine, self.felt.rows, self.count) for mine in found])


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
