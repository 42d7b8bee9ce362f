"""Turns several runs of one motion into figures at once: readings in scratch that stays, filter abreast, errors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from threading import local
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.estimate.abreast import AXES, READING, SAMPLES, steps, takes_lanes
from kreisel.estimate.run import check_needs
from kreisel.evaluate.error_angles import DEGREES, angles_abreast, figures_into
from kreisel.maths.kernels import LANES, argument
from kreisel.study.ensemble.figures import FIGURES, KINDS, LIMIT_DEG, instants
from kreisel.study.ensemble.stage import Seen
from kreisel.study.run import first_attitude
from kreisel.study.scenario import FilterRecipe, Scenario

# Samples of the longest runs that go abreast: sixteen take 0.4 kB a sample for each filter, and as much for each sensor
# whose effects go one by one; twice that for one slower than the motion.
LONGEST = 100_000


class Scratch(local):
    """Memory that lives from tile to tile, of each thread its own: fresh memory costs more than what is done in it."""

    def __init__(self) -> None:
        self._kept: dict[str, Array] = {}

    def __reduce__(self) -> tuple[type[Scratch], tuple[()]]:
        # Memory does not travel to other processes.
        return Scratch, ()

    def array(self, name: str, *shape: int) -> Array:
        """An array with anything in it: that of this name before, where it has this shape."""
        if name not in self._kept or self._kept[name].shape != shape:
            self._kept[name] = np.empty(shape)
        return self._kept[name]


def go_abreast(recipe: FilterRecipe, filter: Any, seen: Seen) -> bool:
    """Whether LANES runs of this motion can go abreast through this filter with the bits of one."""
    plain = recipe.align is None and recipe.clock_offset == 0.0
    # A clock that errs gives each run stamps of its own.
    imu = seen.imu
    in_time = imu.clock.offset == 0.0 and imu.clock.rate_offset == 0.0 and imu.clock.jitter == 0.0
    return plain and in_time and 2 <= len(seen.ideal) <= LONGEST and takes_lanes(filter)


def readings(scratch: Scratch, seen: Seen, runs: Sequence[Scenario]) -> Iterator[tuple[slice, Array]]:
    """What the IMU read in LANES runs, abreast, some samples at a time."""
    room = scratch.array("readings", SAMPLES, READING, LANES)
    return seen.abreast.read([(run.seed, run.run) for run in runs], room)


def attitudes(
    scratch: Scratch,
    seen: Seen,
    filters: Sequence[tuple[Sequence[FilterRecipe], Any]],
    read: Iterable[tuple[slice, Array]],
) -> Iterator[tuple[slice, int, Array]]:
    """Attitudes abreast (m, 9, LANES) of what was read, at rows of the motion, by one filter after the other."""
    room, dt = scratch.array("answers", SAMPLES, AXES, LANES), steps(seen.ideal.t)
    states = [
        np.stack([filter.start(first_attitude(recipe, seen.truth)) for recipe in each])
        for each, filter in filters
    ]
    parameters = [filter.parameters() for _, filter in filters]
    for rows, readings in read:
        answers = room[: rows.stop - rows.start]
        for k, (_, filter) in enumerate(filters):
            filter.batch_of_lanes(states[k], parameters[k], dt[rows], readings, answers)
            yield rows, k, answers


def estimates(
    scratch: Scratch,
    seen: Seen,
    runs: Sequence[Scenario],
    filters: Sequence[tuple[Sequence[FilterRecipe], Any]],
    most: int,
) -> list[dict[str, npt.NDArray[Any]]]:
    """Of every filter figures (LANES,) and "trace" (LANES, 3, most), with the bits that `attitude_errors` gives them.

    filters : with what each begins with in every run.
    """
    if seen.ideal.mag_uT is None:
        for _, filter in filters:
            check_needs(filter)
    n = len(seen.ideal)
    angles = scratch.array("angles", len(filters), LANES, len(KINDS), n)
    read = readings(scratch, seen, runs)
    for rows, k, answers in attitudes(scratch, seen, filters, read):
        angles_abreast(seen.R_NS[rows], answers, rows.start, angles[k])
    return [_figures(scratch, seen, of_filter, most) for of_filter in angles]


def _figures(scratch: Scratch, seen: Seen, angles: Array, most: int) -> dict[str, npt.NDArray[Any]]:
    """Figures and traces of angles (LANES, 3, n) rad."""
    n = angles.shape[2]
    numbers, traces = np.empty((LANES, len(FIGURES))), np.empty((LANES, len(KINDS), most), dtype=np.float32)
    at, room, t = instants(n, most), scratch.array("room", len(KINDS), n + 1), argument(seen.truth.t)
    for lane, mine in enumerate(angles):
        figures_into(mine, t, LIMIT_DEG, room, numbers[lane])
        traces[lane] = DEGREES * mine[:, at]
    return {**{name: numbers[:, k] for k, name in enumerate(FIGURES)}, "trace": traces}
