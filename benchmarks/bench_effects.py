"""Times the error model of an IMU against the same written in plain NumPy.

    python benchmarks/bench_effects.py

White noise, random walk, Gauss-Markov, scale, misalignment, range and quantisation on six axes. "effects" is the
chain alone, with every error term kept over time; "record" is all of `Imu.record`, which works out the ideal
readings at the mount too. Plain NumPy is written as a careful user would: whole arrays, one generator, the recursion
as a loop or through `scipy.signal.lfilter`; it keeps no error terms. All take turns, on one
thread: times are the best of all rounds, ratios the median of those within a round.
"""

from __future__ import annotations

import os

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"

import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from time import perf_counter

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from kreisel import (
    BiasRandomWalk,
    Environment,
    GaussMarkov,
    Imu,
    Misalignment,
    Motion,
    Mount,
    Quantisation,
    Range,
    ScaleFactor,
    WhiteNoise,
    rest,
)
from kreisel.maths.random import stream
from kreisel.simulate.chain import BLOCK, sense
from kreisel.simulate.clock import steps
from kreisel.simulate.context import Context

Array = npt.NDArray[np.float64]

SAMPLES, RATE = 200_000, 200.0
DENSITY, WALK, SIGMA, TIME_CONSTANT, SCALE, LIMIT, STEP = 1e-3, 1e-5, 1e-3, 100.0, 0.01, 35.0, 1e-3
CROSSED = np.array([[1.0, 0.001, -0.002], [0.003, 1.0, 0.001], [0.002, -0.001, 1.0]])

EFFECTS = (
    Misalignment(CROSSED),
    ScaleFactor(error=SCALE),
    BiasRandomWalk(density=WALK),
    GaussMarkov(sigma=SIGMA, time_constant=TIME_CONSTANT),
    WhiteNoise(density=DENSITY),
    Range(limit=LIMIT),
    Quantisation(step=STEP),
)


def by_loop(decay: float, kicks: Array) -> Array:
    """The Gauss-Markov recursion as NumPy alone has it: sample by sample."""
    out = np.empty_like(kicks)
    x = np.zeros(kicks.shape[1])
    for k, kick in enumerate(kicks):
        x = out[k] = decay * x + kick
    return out


def by_lfilter(decay: float, kicks: Array) -> Array:
    """The same by SciPy's compiled filter."""
    return np.asarray(lfilter([1.0], [1.0, -decay], kicks, axis=0))


Recursion = Callable[[float, Array], Array]


def in_plain_numpy(ideal: Array, dt: float, rng: np.random.Generator, recursion: Recursion) -> Array:
    """The same model of one sensor, whole arrays at a time."""
    decay = np.exp(-dt / TIME_CONSTANT)
    kicks = rng.standard_normal(ideal.shape)
    kicks[1:] *= np.sqrt(1.0 - decay * decay)
    wandering = SIGMA * recursion(decay, kicks)
    walking = WALK * np.sqrt(dt) * np.cumsum(rng.standard_normal(ideal.shape), axis=0)
    noise = DENSITY / np.sqrt(dt) * rng.standard_normal(ideal.shape)
    reading = (1.0 + SCALE) * (ideal @ CROSSED.T) + walking + wandering + noise
    return STEP * np.rint(np.clip(reading, -LIMIT, LIMIT) / STEP)


SURROUNDINGS, MOUNT = Environment(), Mount()


def contexts(sensor: str, motion: Motion, force: Array) -> Iterator[Context]:
    dt = steps(motion.t)
    for first in range(0, len(motion), BLOCK):
        rows = slice(first, min(first + BLOCK, len(motion)))
        yield Context(sensor, first, motion.t[rows], dt[rows], force[rows], SURROUNDINGS, MOUNT, motion, rows)


def chain(motion: Motion, gyro: Array, accel: Array) -> None:
    for sensor, ideal in (("gyro", gyro), ("accel", accel)):
        sense(EFFECTS, ideal, contexts(sensor, motion, accel), partial(stream, 1, 0, f"imu/{sensor}"))


def chain_with_errors(motion: Motion, gyro: Array, accel: Array) -> None:
    for sensor, ideal in (("gyro", gyro), ("accel", accel)):
        errors = {effect.name: np.zeros_like(ideal) for effect in EFFECTS}
        blocks = contexts(sensor, motion, accel)
        sense(EFFECTS, ideal, blocks, partial(stream, 1, 0, f"imu/{sensor}"), errors)


def plain(gyro: Array, accel: Array, bits: type[np.random.BitGenerator], recursion: Recursion) -> None:
    rng = np.random.Generator(bits(1))
    for ideal in (gyro, accel):
        in_plain_numpy(ideal, 1.0 / RATE, rng, recursion)


def all_times(works: dict[str, Callable[[], object]], runs: int = 21) -> dict[str, list[float]]:
    times: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(runs):
        for name, work in works.items():
            start = perf_counter()
            work()
            times[name].append(perf_counter() - start)
    return times


def memory_above_output(imu: Imu, motion: Motion) -> float:
    tracemalloc.start()
    recorded = imu.record(motion, 1)
    kept, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del recorded
    return (peak - kept) / len(motion)


def main() -> None:
    motion = rest().sample(np.arange(SAMPLES) / RATE)
    imu = Imu(gyro_effects=EFFECTS, accel_effects=EFFECTS)
    ideal = imu.ideal(motion)
    gyro, accel = ideal.gyro, ideal.accel
    works: dict[str, Callable[[], object]] = {
        "effects": lambda: chain(motion, gyro, accel),
        "effects with errors": lambda: chain_with_errors(motion, gyro, accel),
        "record": lambda: imu.record(motion, 1),
        "ideal": lambda: imu.ideal(motion),
        "plain NumPy, PCG64": lambda: plain(gyro, accel, np.random.PCG64, by_loop),
        "NumPy and SciPy's lfilter, PCG64": lambda: plain(gyro, accel, np.random.PCG64, by_lfilter),
        "NumPy and SciPy's lfilter, Philox": lambda: plain(gyro, accel, np.random.Philox, by_lfilter),
    }
    times = all_times(works)
    for name, seconds in times.items():
        ratio = np.median(np.array(seconds) / np.array(times["effects"]))
        print(f"{name:<60} {1e9 * min(seconds) / SAMPLES:7.0f} ns/sample  {ratio:5.2f} x effects")
    print(f"memory of record above its output: {memory_above_output(imu, motion):.0f} bytes/sample")


if __name__ == "__main__":
    main()
