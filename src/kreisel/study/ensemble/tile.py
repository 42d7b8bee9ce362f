"""Turns several runs of one motion into figures at once: readings into shared scratch, filter abreast, errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters import LaneFilter
from kreisel.estimate.run import readings
from kreisel.evaluate.error_angles import angles_into, spread_into
from kreisel.maths.kernels import argument
from kreisel.study.ensemble.figures import FIGURES, KINDS, converged, instants
from kreisel.study.ensemble.stage import Seen
from kreisel.study.run import first_attitude
from kreisel.study.scenario import FilterRecipe, Scenario
from kreisel.study.sensor import errs

# Longest runs that go abreast: sixteen take 2.3 kB a sample.
LONGEST = 100_000


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """Readings of one IMU in several runs of one motion, the runs in front."""

    seen: Seen
    recordings: Sequence[ImuRecording]


def abreast(recipe: FilterRecipe, filter: Any, seen: Seen) -> int:
    """How many runs of this motion can go abreast through this filter with the bits of one; 1: none."""
    plain = recipe.align is None and recipe.clock_offset == 0.0 and not hasattr(filter, "sigma")
    # A clock that errs gives each run stamps of its own.
    imu = seen.imu
    in_time = imu.clock.offset == 0.0 and imu.clock.rate_offset == 0.0 and imu.clock.jitter == 0.0
    fits = plain and in_time and len(seen.ideal) <= LONGEST
    return filter.lanes if fits and isinstance(filter, LaneFilter) else 1


def record(seen: Seen, motion: Motion, runs: Sequence[Scenario]) -> Tile:
    """What the IMU read in each run."""
    if not errs(seen.imu):
        return Tile(seen, [seen.ideal] * len(runs))
    made = [seen.imu.record(motion, run.seed, run.run, ideal=seen.ideal).measured for run in runs]
    return Tile(seen, made)


def estimate(
    tile: Tile, recipes: Sequence[FilterRecipe], filter: Any, most: int
) -> dict[str, npt.NDArray[Any]]:
    """Figures (runs,) of one filter on a tile of as many runs as it has lanes, and "trace" (runs, 3, most)."""
    seen, runs = tile.seen, tile.recordings
    gyro, accel = np.stack([r.gyro for r in runs]), np.stack([r.accel for r in runs])
    mag = None if seen.ideal.mag_uT is None else np.stack([r.mag_uT for r in runs if r.mag_uT is not None])
    columns = Columns.room_for(filter, gyro.shape[:2])
    states = np.stack([filter.start(first_attitude(recipe, seen.truth)) for recipe in recipes])
    sensors = readings(filter, seen.ideal.t, gyro, accel, mag)
    filter.batch_of_lanes(states, filter.parameters(), *sensors, columns)
    return errors(seen, columns.R_NS, most)


def errors(seen: Seen, R_NS: Array, most: int) -> dict[str, npt.NDArray[Any]]:
    """Figures (runs,) and trace of estimates R_NS (runs, n, 3, 3), with the bits that `attitude_errors` gives them."""
    runs, n = R_NS.shape[:2]
    numbers, traces = np.empty((runs, len(FIGURES))), np.empty((runs, len(KINDS), most), dtype=np.float32)
    rows, t, angles = instants(n, most), seen.truth.t, np.empty((len(KINDS), n))
    truth = argument(seen.rows)
    for run in range(runs):
        angles_into(truth, argument(R_NS[run]), angles)
        for k in range(len(KINDS)):
            spread_into(argument(angles[k]), numbers[run, 5 * k : 5 * k + 5])
        numbers[run, -1] = converged(t, angles[0])
        traces[run] = np.degrees(angles[:, rows])
    return {**{name: numbers[:, k] for k, name in enumerate(FIGURES)}, "trace": traces}
