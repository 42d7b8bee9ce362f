"""Times many runs of one scenario against the two ways to write them by hand: a loop, and NumPy over all runs.

    python benchmarks/bench_montecarlo.py [--runs 160] [--samples 10000] [--threads]

Nine channels of white noise and the published step of the DCM filter, without and with statistics: RMSE, mean, median,
95th percentile and largest of total, heading and inclination error of every run.
The loop is what a careful user writes today: noise by NumPy, `run`, `attitude_errors(...).summary()`; "NumPy" is the
tutorial's step in arrays over runs, sample by sample. All take turns; times are those of this process's processors.

The limit, ns a sample: nine normals 1.8 each (16), sixteen lanes of the step 10 with their readings and answers in the
cache (44 through memory), errors: 27 products and three angles 11, order statistics of three angles 11.
"""

from __future__ import annotations

import os

for limit in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[limit] = "1"

import argparse
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter, process_time

import numpy as np
import numpy.typing as npt

from kreisel import DcmFilter, ImuRecording, Scenario, attitude_errors, run
from kreisel.maths.kernels import LANES
from kreisel.study.building import build
from kreisel.study.ensemble.draws import Draws
from kreisel.study.ensemble.tile import Scratch, attitudes, readings
from kreisel.study.ensemble.work import Work
from kreisel.study.monte_carlo import monte_carlo, prepare

Array = npt.NDArray[np.float64]

SCENARIO = """
rate_hz = 200.0
trajectory = { kind = "lissajous", frequency = 0.1 }
environment = { field_N_uT = [0.0, 20.0, -44.0] }
imu = { sensor = "SENSOR" }
[[filter]]
kind = "dcm"
published = {}
"""

# White noise alone, as the figures asked for have it.
SENSOR = """
part = "white noise"
maker = ""
grade = "industrial"
datasheet = "none"
[values]
gyro_noise_deg_per_s_rthz = { value = 0.01, source = "made up" }
accel_noise_ug_rthz = { value = 200.0, source = "made up" }
mag_noise_uT_rthz = { value = 0.05, source = "made up" }
"""


class Case:
    """One scenario, its truth and its ideal readings."""

    def __init__(self, samples: int, folder: str) -> None:
        path = os.path.join(folder, "white.toml")
        with open(path, "w", encoding="utf-8") as out:
            out.write(SENSOR)
        text = SCENARIO.replace("SENSOR", path)
        self.scenario = replace(Scenario.from_toml(f"duration = {(samples - 1) / 200.0}\n{text}"))
        parts = build(self.scenario)
        motion = parts.trajectory.sample(parts.t)
        (imu,) = parts.imus
        self.truth, self.ideal = motion.at(imu.mount), imu.ideal(motion)
        noisy = imu.record(motion, 1).measured
        self.noises = [np.asarray(x) for x in (noisy.gyro_noise, noisy.accel_noise, noisy.mag_noise_uT)]

    def noisy(self, rng: np.random.Generator) -> list[Array]:
        ideal = (self.ideal.gyro, self.ideal.accel, self.ideal.mag_uT)
        return [
            x + s * rng.standard_normal(x.shape)
            for x, s in zip(ideal, self.noises, strict=True)
            if x is not None
        ]


def by_loop(case: Case, runs: int, errors: bool) -> None:
    rng, filter = np.random.default_rng(1), DcmFilter.as_published()
    for _ in range(runs):
        gyro, accel, mag = case.noisy(rng)
        estimate = run(filter, ImuRecording(case.ideal.t, gyro, accel, mag))
        if errors:
            attitude_errors(case.truth, estimate).summary()


def by_numpy(case: Case, runs: int, errors: bool) -> Array:
    """The published step over all runs at once, one sample after the other; R or the statistics of its errors."""
    angles = np.zeros((len(case.ideal), 3, runs) if errors else (1, 3, runs))
    rng = np.random.default_rng(1)
    t, up_weight, north_weight = case.ideal.t, 0.01, 0.01
    R = np.broadcast_to(case.truth.R_NB[0], (runs, 3, 3)).copy()
    ideal = [case.ideal.gyro, case.ideal.accel, case.ideal.mag_uT]
    for k in range(1, len(t)):
        gyro, accel, mag = (
            x[k] + s * rng.standard_normal((runs, 3)) for x, s in zip(ideal, case.noises, strict=True)
        )
        up, east = R[:, 2], R[:, 0]
        a = accel / np.sqrt(np.einsum("ri,ri->r", accel, accel))[:, None]
        level = np.cross(mag, a)
        level /= np.sqrt(np.einsum("ri,ri->r", level, level))[:, None]
        turn = -(t[k] - t[k - 1]) * gyro
        turn = turn + up_weight * np.cross(up, a) + north_weight * np.cross(east, level)
        turn /= 1.0 + up_weight + north_weight
        up = up + np.cross(turn, up)
        east = east + np.cross(turn, east)
        askew = 0.5 * np.einsum("ri,ri->r", up, east)[:, None]
        up, east = up - askew * east, east - askew * up
        up /= np.sqrt(np.einsum("ri,ri->r", up, up))[:, None]
        east /= np.sqrt(np.einsum("ri,ri->r", east, east))[:, None]
        R[:, 2], R[:, 0], R[:, 1] = up, east, np.cross(up, east)
        if errors:
            angles[k] = angles_of(R @ case.truth.R_NB[k].T)
    return statistics(np.degrees(np.abs(angles))) if errors else R


def angles_of(E: Array) -> tuple[Array, Array, Array]:
    """Total, heading and inclination (runs,) of rotations (runs, 3, 3)."""
    x, y, z = E[:, 2, 1] - E[:, 1, 2], E[:, 0, 2] - E[:, 2, 0], E[:, 1, 0] - E[:, 0, 1]
    total = np.arctan2(np.sqrt(x * x + y * y + z * z), np.einsum("rii->r", E) - 1.0)
    return (
        total,
        np.arctan2(z, E[:, 0, 0] + E[:, 1, 1]),
        np.arctan2(np.hypot(E[:, 0, 2], E[:, 1, 2]), E[:, 2, 2]),
    )


def statistics(x: Array) -> Array:
    """RMSE, mean, median, 95th percentile and largest of magnitudes (n, ...) over the first axis."""
    median, p95 = np.percentile(x, (50.0, 95.0), axis=0)
    return np.array([np.sqrt(np.mean(x * x, axis=0)), x.mean(axis=0), median, p95, x.max(axis=0)])


def ours(work: Work) -> None:
    for number in work.blocks:
        work(number)


def ours_without_errors(work: Work, scratch: Scratch) -> None:
    draws = Draws(work.scenario)
    stage = work.stage(draws, 0)
    (seen,), (filter,) = stage.seen, stage.filters
    for first in range(0, work.runs - LANES + 1, LANES):
        runs = [draws.of(run) for run in range(first, first + LANES)]
        read = readings(scratch, seen, runs)
        for _ in attitudes(scratch, seen, [([each.filters[0] for each in runs], filter)], read):
            pass


def seconds(do: Callable[[], object], clock: Callable[[], float]) -> float:
    begun = clock()
    do()
    return clock() - begun


def compare(case: Case, runs: int, rounds: int) -> None:
    """Each way against ours that makes the same."""
    runs -= runs % LANES
    work, scratch = prepare(case.scenario, runs), Scratch()
    by_loop(case, 1, True)
    bare: dict[str, Callable[[], object]] = {
        "ours": lambda: ours_without_errors(work, scratch),
        "loop": lambda: by_loop(case, runs, False),
        "NumPy": lambda: by_numpy(case, runs, False),
    }
    told: dict[str, Callable[[], object]] = {
        "ours": lambda: ours(work),
        "loop": lambda: by_loop(case, runs, True),
        "NumPy": lambda: by_numpy(case, runs, True),
    }
    for title, ways in (("noise and filter", bare), ("noise, filter and statistics", told)):
        print(title)
        measure(ways, runs, runs * len(case.ideal), rounds)


def measure(ways: dict[str, Callable[[], object]], runs: int, samples: int, rounds: int) -> None:
    ways["ours"]()
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(rounds):
        for name, do in ways.items():
            times[name].append(seconds(do, process_time))
    for name, found in times.items():
        ratio = np.median(np.array(found) / np.array(times["ours"]))
        speed = f"{1e9 * min(found) / samples:7.1f} ns/sample {runs / min(found):8.0f} runs/CPU-second"
        print(f"  {name:<6} {speed}  x {ratio:.2f}")


def threads(case: Case, runs: int, rounds: int) -> None:
    gains = []
    for _ in range(rounds):
        one, two = (
            seconds(lambda n=n: monte_carlo(case.scenario, runs, threads=n), perf_counter)  # type: ignore[misc]
            for n in (1, 2)
        )
        gains.append(one / two)
    print(f"two threads against one, wall clock: {np.median(gains):.2f} (best {max(gains):.2f})")


def main() -> None:
    import tempfile

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--threads", action="store_true", help="two threads against one instead")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        case = Case(args.samples, folder)
        (threads if args.threads else compare)(case, args.runs, args.rounds)


if __name__ == "__main__":
    main()
