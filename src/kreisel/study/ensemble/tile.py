"""Turns several runs of one motion into figures at once: readings in scratch that stays, filter abreast, errors."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from threading import local
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters import LaneFilter
from kreisel.estimate.run import readings
from kreisel.evaluate.error_angles import DEGREES, figures_into
from kreisel.maths.kernels import argument
from kreisel.simulate.imu import SENSORS
from kreisel.simulate.many import read_many
from kreisel.study.ensemble.figures import FIGURES, KINDS, LIMIT_DEG, instants
from kreisel.study.ensemble.stage import Seen
from kreisel.study.run import first_attitude
from kreisel.study.scenario import FilterRecipe, Scenario
from kreisel.study.sensor import errs

# Longest runs that go abreast: sixteen take 2.3 kB a sample.
LONGEST = 100_000

Readings = dict[str, Array]  # name of the sensor -> (runs, n, 3)
Made = TypeVar("Made")


class Scratch(local):
    """Memory that lives from tile to tile, of each thread its own: fresh memory costs more than what is done in it."""

    def __init__(self) -> None:
        self._kept: dict[str, Any] = {}

    def __reduce__(self) -> tuple[type[Scratch], tuple[()]]:
        # Memory does not travel to other processes.
        return Scratch, ()

    def keep(self, name: str, like: Hashable, make: Callable[[], Made]) -> Made:
        """What was made under this name before, where it was made to be `like` this."""
        if name not in self._kept or self._kept[name][0] != like:
            self._kept[name] = like, make()
        found: Made = self._kept[name][1]
        return found

    def array(self, name: str, *shape: int) -> Array:
        """An array with anything in it."""
        return self.keep(name, shape, lambda: np.empty(shape))


def abreast(recipe: FilterRecipe, filter: Any, seen: Seen) -> int:
    """How many runs of this motion can go abreast through this filter with the bits of one; 1: none."""
    plain = recipe.align is None and recipe.clock_offset == 0.0 and not hasattr(filter, "sigma")
    # A clock that errs gives each run stamps of its own.
    imu = seen.imu
    in_time = imu.clock.offset == 0.0 and imu.clock.rate_offset == 0.0 and imu.clock.jitter == 0.0
    fits = plain and in_time and len(seen.ideal) <= LONGEST
    return filter.lanes if fits and isinstance(filter, LaneFilter) else 1


def record(scratch: Scratch, seen: Seen, motion: Motion, runs: Sequence[Scenario]) -> Readings:
    """What the IMU read in each run, the runs in front."""
    names = [name for name in SENSORS if getattr(seen.ideal, name) is not None]
    out = {name: scratch.array(name, len(runs), len(motion), 3) for name in names}
    if errs(seen.imu):
        read_many(seen.imu, motion, seen.ideal, [(run.seed, run.run) for run in runs], out)
    else:
        for name, readings in out.items():
            readings[:] = getattr(seen.ideal, name)
    return out


def estimate(
    scratch: Scratch, seen: Seen, recorded: Readings, recipes: Sequence[FilterRecipe], filter: Any, most: int
) -> dict[str, npt.NDArray[Any]]:
    """Figures (runs,) of one filter on as many runs as it has lanes, and "trace" (runs, 3, most)."""
    return errors(scratch, seen, attitudes(scratch, seen, recorded, recipes, filter), most)


def attitudes(
    scratch: Scratch, seen: Seen, recorded: Readings, recipes: Sequence[FilterRecipe], filter: Any
) -> Array:
    """R_NS (runs, n, 3, 3) of one filter on as many runs as it has lanes, in scratch."""
    shape = recorded["gyro"].shape[:2]
    like = (*shape, filter.learns_bias)
    columns = scratch.keep("answers", like, lambda: Columns.room_for(filter, shape))
    states = np.stack([filter.start(first_attitude(recipe, seen.truth)) for recipe in recipes])
    sensors = readings(filter, seen.ideal.t, recorded["gyro"], recorded["accel"], recorded.get("mag_uT"))
    filter.batch_of_lanes(states, filter.parameters(), *sensors, columns)
    return columns.R_NS


def errors(scratch: Scratch, seen: Seen, R_NS: Array, most: int) -> dict[str, npt.NDArray[Any]]:
    """Figures (runs,) and trace of estimates R_NS (runs, n, 3, 3), with the bits that `attitude_errors` gives them."""
    runs, n = R_NS.shape[:2]
    numbers, traces = np.empty((runs, len(FIGURES))), np.empty((runs, len(KINDS), most), dtype=np.float32)
    at, room = instants(n, most), scratch.array("errors", 2 * len(KINDS), n + 1)
    truth, t = argument(seen.rows), argument(seen.truth.t)
    for run in range(runs):
        figures_into(truth, argument(R_NS[run]), t, LIMIT_DEG, room, numbers[run])
        traces[run] = DEGREES * room[: len(KINDS), at]
    return {**{name: numbers[:, k] for k, name in enumerate(FIGURES)}, "trace": traces}
