"""Turns the ideal reading of an IMU into what it read in many runs of one motion, and into nothing beside that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.maths.random import stream
from kreisel.simulate.chain import read
from kreisel.simulate.clock import spread
from kreisel.simulate.imu import Imu
from kreisel.simulate.session import contexts_of, felt_by, parts_of


def read_many(
    imu: Imu,
    motion: Motion,
    ideal: ImuRecording,
    draws: Sequence[tuple[int, int]],
    out: Mapping[str, Array],
) -> None:
    """What `imu.record` measures in the runs `draws`, (seed, run) each: into `out`.

    ideal : what `imu.ideal(motion)` made. out : name of each sensor in it -> readings (runs, n, 3).
    The stamps are those of the motion unless the clock errs. Raises ValueError as `record` does.
    """
    imu._check(motion)
    for sensor, readings in out.items():
        effects, sampling = parts_of(imu, sensor)
        felt = felt_by(sampling, sensor, motion, ideal)
        contexts = list(contexts_of(imu, sensor, motion, felt))
        whole = isinstance(felt.rows, slice)
        found = readings if whole else np.empty((len(draws), *felt.reading.shape))
        streams_of = [partial(stream, seed, run, f"{imu.mount.name}/{sensor}") for seed, run in draws]
        read(effects, felt.reading, contexts, streams_of, found)
        for (seed, run), reading, mine in zip(draws, readings, found, strict=True):
            if not whole:
                reading[:] = spread(mine, felt.rows, len(motion))
            if imu.clock.loss:
                lost = imu.clock.lost(len(motion), stream(seed, run, imu.mount.name, "clock"))
                reading[lost] = np.nan
