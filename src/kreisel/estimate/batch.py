"""Turns many recordings into attitude, abreast in the lanes of vector instructions where the filter can."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import AttitudeHistory, Mask
from kreisel.data.checks import increasing, read_only, shaped
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording
from kreisel.estimate.abreast import steps, takes_lanes
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters import Array, AttitudeFilter
from kreisel.estimate.run import readings, run
from kreisel.maths.kernels import LANES
from kreisel.maths.kinematics import linear_acceleration


@dataclass(frozen=True, slots=True, eq=False)
class AttitudeBatch:
    """Attitude of several runs at the same times; `batch[k]` is the history of run k."""

    t: Array  # (n,) s
    R_NS: Array  # (runs, n, 3, 3)
    gyro_bias: Array  # (runs, n, 3) rad/s, in S
    rest: Mask  # (runs, n) the sensor was taken to be at rest
    disturbed: Mask  # (runs, n) the magnetometer was not trusted
    held: Mask  # (runs, n) a gyro sample was missing and the last rate was held
    accel: Array  # (runs, n, 3) m/s^2, specific force in S, as it was given
    sigma: Array | None = None  # (runs, n, 3) rad, where the filter knows it

    def __len__(self) -> int:
        return len(self.R_NS)

    def __getitem__(self, k: int) -> AttitudeHistory:
        flags = self.rest[k], self.disturbed[k], self.held[k]
        sigma = None if self.sigma is None else self.sigma[k]
        return AttitudeHistory.trusted(
            self.t, self.R_NS[k], self.gyro_bias[k], self.accel[k], flags, 0, "", sigma
        )

    @property
    def a_N(self) -> Array:
        """(runs, n, 3) m/s^2, acceleration in N without gravity; made anew at each call."""
        runs, n = self.rest.shape
        flat = linear_acceleration(self.R_NS.reshape(-1, 3, 3), self.accel.reshape(-1, 3), STANDARD_GRAVITY)
        return flat.reshape(runs, n, 3)


def run_batch(
    filter: AttitudeFilter,
    t: npt.ArrayLike,
    gyro: npt.ArrayLike,
    accel: npt.ArrayLike,
    mag_uT: npt.ArrayLike | None = None,
    *,
    R_NS: npt.ArrayLike | None = None,
    threads: int | None = None,
) -> AttitudeBatch:
    """The attitudes of several runs that were sampled at the same times, each with the bits `run` gives it.

    t : (n,) s, strictly increasing. gyro : (runs, n, 3) rad/s. accel : (runs, n, 3) m/s^2. mag_uT : (runs, n, 3).
    R_NS : (3, 3) or (runs, 3, 3), the first attitudes where they are known.
    threads : how many at most; None for all cores.
    Raises ValueError for other shapes, and where the filter needs a magnetometer and there is none.
    """
    t = increasing("t", shaped("t", t, ("n",)))
    gyro = shaped("gyro", _lent(gyro), ("runs", len(t), 3))
    accel = shaped("accel", accel, gyro.shape)
    mag = None if mag_uT is None else shaped("mag_uT", _lent(mag_uT), gyro.shape)
    runs = len(gyro)
    first = None if R_NS is None else np.broadcast_to(np.asarray(R_NS, float), (runs, 3, 3))
    columns = Columns.room_for(filter, (runs, len(t)))

    readings(filter, t[:0], gyro[:0], accel[:0], mag)

    def tile(part: slice) -> None:
        known = None if first is None else first[part]
        readings = gyro[part], accel[part], None if mag is None else mag[part]
        _fill(filter, t, readings, known, columns.part(part))

    in_threads(tile, _tiles(filter, runs), threads)
    for column in columns:
        column.flags.writeable = False
    return AttitudeBatch(t, *columns[:5], accel, columns.known())


def run_all(
    filter: AttitudeFilter, recordings: Sequence[ImuRecording], *, threads: int | None = None
) -> list[AttitudeHistory]:
    """What `run` makes of each recording, of any length and rate; those on the same stamps go abreast.

    threads : how many at most; None for all cores.
    Raises ValueError where the filter needs a magnetometer that one of the recordings does not have.
    """
    histories: list[AttitudeHistory | None] = [None] * len(recordings)

    def together(members: Sequence[int]) -> None:
        if len(members) < _lanes(filter):
            for k in members:
                histories[k] = run(filter, recordings[k])
            return
        alike = [recordings[k] for k in members]
        gyro, accel = np.stack([r.gyro for r in alike]), np.stack([r.accel for r in alike])
        mag = None if alike[0].mag_uT is None else np.stack([r.mag_uT for r in alike if r.mag_uT is not None])
        columns = Columns.room_for(filter, gyro.shape[:2])
        _fill(filter, alike[0].t, (gyro, accel, mag), None, columns)
        for i, k in enumerate(members):
            histories[k] = columns.part(i).history(recordings[k])

    in_threads(together, _alike(recordings, _lanes(filter)), threads)
    return [history for history in histories if history is not None]


def _lent(x: npt.ArrayLike) -> npt.ArrayLike:
    """The same, not copied by checks: nothing that lasts keeps it."""
    return read_only(x) if isinstance(x, np.ndarray) else x


def _lanes(filter: AttitudeFilter) -> int:
    return LANES if takes_lanes(filter) else 1


def _tiles(filter: AttitudeFilter, runs: int) -> list[slice]:
    """As many runs as there are lanes in each, and the remaining ones one by one."""
    lanes = _lanes(filter)
    whole = runs - runs % lanes
    return [slice(k, k + lanes) for k in range(0, whole, lanes)] + [
        slice(k, k + 1) for k in range(whole, runs)
    ]


def _alike(recordings: Sequence[ImuRecording], lanes: int) -> list[list[int]]:
    """Numbers of recordings, grouped by what lets them go abreast and at most `lanes` in a group."""

    def key(k: int) -> tuple[bool, bytes]:
        return recordings[k].mag_uT is None, recordings[k].t.tobytes() if lanes > 1 else b""

    groups = [list(group) for _, group in groupby(sorted(range(len(recordings)), key=key), key)]
    return [group[i : i + lanes] for group in groups for i in range(0, len(group), lanes)]


def _fill(
    filter: AttitudeFilter,
    t: Array,
    sensors: tuple[Array, Array, Array | None],
    R_NS: Array | None,
    columns: Columns,
) -> None:
    """Run one tile: abreast where it has as many runs as the filter has lanes."""
    t, gyro, accel, mag = readings(filter, t, *sensors)
    runs = len(gyro)
    firsts = [None] * runs if R_NS is None else list(R_NS)
    states, parameters = np.stack([filter.start(first) for first in firsts]), filter.parameters()
    if takes_lanes(filter) and runs == LANES:
        columns.rest[:], columns.disturbed[:], columns.held[:] = False, False, False
        filter.batch_of_rows(states, parameters, steps(t), gyro, accel, mag, columns)
        return
    for k in range(runs):
        filter.batch(states[k], parameters, t, gyro[k], accel[k], mag[k], columns.part(k))


def in_threads(work: Callable[..., None], parts: Iterable[object], threads: int | None) -> None:
    """`work` on every part, at once where there are several threads; the first error is raised."""
    count = len(os.sched_getaffinity(0)) if threads is None else threads
    if count <= 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(work, parts))
