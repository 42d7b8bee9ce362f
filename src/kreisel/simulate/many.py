"""Turns the ideal reading of an IMU into what it read in many runs of one motion, and into nothing beside that."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.maths.kernels import LANES, argument, kernel
from kreisel.maths.random import Stream, stream, words_abreast
from kreisel.simulate.chain import BLOCK, Felt, read
from kreisel.simulate.context import Context
from kreisel.simulate.effects import Effect, LaneEffect, PutAbreast
from kreisel.simulate.imu import Imu
from kreisel.simulate.session import SENSORS, blocks, contexts_of, felt_by, parts_of

Draws = Sequence[tuple[int, int]]

ROWS = 3 * len(SENSORS)
"""Rows of readings abreast: three of each sensor."""


class Abreast:
    """An IMU that records LANES runs of one motion at once; what these share is made once for all that follow.

    ideal : what `imu.ideal(motion)` made. samples : how many are read at a time.
    """

    def __init__(self, imu: Imu, motion: Motion, ideal: ImuRecording, samples: int) -> None:
        self._imu, self._motion, self._ideal, self._samples = imu, motion, ideal, samples

    @cached_property
    def _channels(self) -> list[_Channel]:
        """Made when they are asked for: of a motion that only one run has nobody does."""
        imu, motion, ideal = self._imu, self._motion, self._ideal
        imu._check(motion)
        there = [sensor for sensor in SENSORS if getattr(ideal, sensor) is not None]
        return [_Channel.of(imu, sensor, motion, ideal, self._samples) for sensor in there]

    def read(self, draws: Draws, room: Array) -> Iterator[tuple[slice, Array]]:
        """What `record` measures in the runs `draws`, (seed, run) each: rows of the motion, and readings there.

        room : (samples, 9, LANES), takes gyro, accel and mag_uT, NaN where there is no sensor; readings are the part
        of it that those of `rows` fill. The stamps are those of the motion unless the clock errs.
        Raises ValueError as `record` does.
        """
        for k, sensor in enumerate(SENSORS):
            if getattr(self._ideal, sensor) is None:
                room[:, 3 * k : 3 * k + 3] = np.nan
        imu = self._imu
        fills = [channel.fill(draws, imu.mount.name) for channel in self._channels]
        clocks = [stream(seed, run, imu.mount.name, "clock") for seed, run in draws if imu.clock.loss]
        lost = [imu.clock.lost(len(self._motion), each) for each in clocks]
        for rows in blocks(len(self._motion), self._samples):
            readings = room[: rows.stop - rows.start]
            for fill in fills:
                fill(rows, readings)
            for lane, mine in enumerate(lost):
                readings[mine[rows], :, lane] = np.nan
            yield rows, readings


@dataclass(frozen=True, slots=True, eq=False)
class _Channel:
    """One sensor, what it feels, and what acts on that."""

    sensor: str
    count: int  # rows of the motion
    felt: Felt
    acting: Sequence[Effect]
    contexts: Sequence[Context]
    puts: Sequence[PutAbreast] | None  # of each context, where the effects act on all runs at once

    @classmethod
    def of(cls, imu: Imu, sensor: str, motion: Motion, ideal: ImuRecording, samples: int) -> _Channel:
        effects, sampling = parts_of(imu, sensor)
        felt, acting = felt_by(sampling, sensor, motion, ideal), [each for each in effects if not each.idle]
        make = _make(acting) if isinstance(felt.rows, slice) else None
        contexts = list(contexts_of(imu, sensor, motion, felt, block=BLOCK if make is None else samples))
        parts = [felt.reading[each.first : each.first + len(each.t)] for each in contexts]
        puts = None if make is None else [make(*each) for each in zip(parts, contexts, strict=True)]
        return cls(sensor, len(motion), felt, acting, contexts, puts)

    def fill(self, draws: Draws, name: str) -> Callable[[slice, Array], None]:
        """What puts the readings of some rows into their places, asked for them in their order."""
        first = 3 * SENSORS.index(self.sensor)
        streams_of = [partial(stream, seed, run, f"{name}/{self.sensor}") for seed, run in draws]
        if self.puts is None:
            found = self._one_by_one(streams_of)
            return lambda rows, readings: _beside(found[:, rows], first, readings)
        # Where nothing acts nobody draws from these streams.
        effect = self.acting[0].name if self.acting else ""
        words, puts = words_abreast([stream_of(effect) for stream_of in streams_of]), iter(self.puts)

        def fill(rows: slice, readings: Array) -> None:
            words[3] = rows.start
            next(puts)(words, first, readings)

        return fill

    def _one_by_one(self, streams_of: Sequence[Callable[[str], Stream]]) -> Array:
        """The readings of all rows (LANES, n, 3)."""
        found = np.empty((LANES, *self.felt.reading.shape))
        for mine, stream_of in zip(found, streams_of, strict=True):
            read(self.acting, self.felt.reading, self.contexts, stream_of, mine)
        if isinstance(self.felt.rows, slice):
            return found
        out = np.full((LANES, self.count, 3), np.nan)
        out[:, self.felt.rows] = found
        return out


def _make(acting: Sequence[Effect]) -> Callable[[Array, Context], PutAbreast] | None:
    """What makes readings of many runs of the one that they share; None where no single effect does."""
    if not acting:
        return _without_errors
    # A second one would have to go from many to many.
    (first, *others) = acting
    return first.abreast if isinstance(first, LaneEffect) and not others else None


def _without_errors(block: Array, context: Context) -> PutAbreast:
    shared = argument(block)
    return lambda words, row, out: _spread(shared, row, out)


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
