"""Turns IMU samples into attitude by the DCM filter, ours, and by vqf's C++, and compares the time they take.

Run: .venv/bin/python benchmarks/bench_dcm.py [samples]     (one thread; default 4000 a sequence, 256 sequences)

Limit of a single sequence: each step waits for the one before. The published step's longest chain is some thirty
additions and multiplications of 3 and 4 cycles, one root and one division that follow each other: 100 cycles, 34 ns at
3 GHz, and its 250 operations take as long on three units. Of sixteen sequences abreast, eight to a vector, the
operations are the limit: 250 / 8 / 2 a cycle, 2 roots and 2 divisions, some 25 cycles or 8 ns. What goes in and out is
72 and 75 bytes a sample, 20 ns more from and to main memory.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

import numpy as np
from vqf import VQF

from kreisel import DcmFilter, ImuRecording, Stream, run
from kreisel.estimate.abreast import SAMPLES, TOLD
from kreisel.estimate.abreast import steps as between
from kreisel.estimate.answers import Columns
from kreisel.estimate.batch import run_batch
from kreisel.estimate.filters import AttitudeFilter
from kreisel.maths.kernels import argument
from kreisel.maths.rotations import exp_so3

ROUNDS = 15
RATE_HZ = 286.0
SEQUENCES = 256
STREAMED = 2000
FILTERS = {"published step": DcmFilter.as_published(1.0, 0.01, 0.01), "default": DcmFilter()}

Readings = tuple[np.ndarray, np.ndarray, np.ndarray]


def readings(n: int, seed: int = 1) -> Readings:
    """A hand that tumbles a phone: gyro, accelerometer and magnetometer with noise."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) / RATE_HZ
    frequencies, phases = rng.uniform(0.1, 0.7, (3, 3)), rng.uniform(0.0, 2.0 * np.pi, (3, 3))
    gyro = 1.5 * np.sin(2.0 * np.pi * frequencies * t[:, None, None] + phases).mean(axis=2)
    R = [np.eye(3)]
    for step in exp_so3(gyro[1:] / RATE_HZ):
        R.append(R[-1] @ step)
    to_S = np.array(R).transpose(0, 2, 1)
    truth = gyro, to_S @ [0.0, 0.0, 9.81], to_S @ [0.0, 18.0, -44.0]
    gyro, accel, mag = (x + rng.normal(0.0, s, (n, 3)) for x, s in zip(truth, (0.01, 0.1, 0.3), strict=True))
    return gyro, accel, mag


def stepping(filter: AttitudeFilter, t: np.ndarray, data: Readings) -> Callable[[], None]:
    """The steps alone, into memory that is there."""
    out, inputs = Columns.room_for(filter, (len(t),)), [argument(x) for x in (t, *data)]
    return lambda: filter.batch(filter.start(), filter.parameters(), *inputs, out)


def abreast(filter: DcmFilter, t: np.ndarray, data: Readings) -> Callable[[], None]:
    """The steps of SEQUENCES alone, as many at a time as there are lanes, into memory that is there."""
    count = filter.lanes
    readings = np.repeat(np.concatenate(data, axis=1)[:, :, None], count, axis=2)
    dt, answers = between(t), np.empty((len(t), TOLD, count))

    def steps() -> None:
        for _ in range(SEQUENCES // count):
            states = np.stack([filter.start()] * count)
            for first in range(0, len(t), SAMPLES):
                rows = slice(first, first + SAMPLES)
                filter.batch_of_lanes(states, filter.parameters(), dt[rows], readings[rows], answers[rows])

    return steps


def streaming(filter: AttitudeFilter, data: Readings) -> Callable[[], None]:
    rows = [list(x[:STREAMED]) for x in data]

    def feed() -> None:
        stream = Stream(filter)
        for gyro, accel, mag in zip(*rows, strict=True):
            stream.update(gyro, accel, mag, dt=1.0 / RATE_HZ)

    return feed


def vqfs_stream(data: Readings) -> Callable[[], None]:
    rows = [list(x[:STREAMED]) for x in data]

    def feed() -> None:
        filter = VQF(1.0 / RATE_HZ)
        for gyro, accel, mag in zip(*rows, strict=True):
            filter.update(gyro, accel, mag)

    return feed


def seconds(work: Callable[[], object]) -> float:
    """Of this process alone, the system's work for it included: other programs on the machine do not count."""
    started = time.process_time()
    work()
    return time.process_time() - started


def compare(
    name: str,
    ours: Callable[[], object],
    samples: int,
    theirs: Callable[[], object],
    n: int,
    rounds: int = ROUNDS,
) -> None:
    """Pairs that ran one after the other; the median of their ratios, and the least time of each."""
    ours()
    theirs()
    pairs = [(seconds(ours) / samples, seconds(theirs) / n) for _ in range(rounds)]
    ratio = statistics.median(b / a for a, b in pairs)
    a, b = (min(pair[k] for pair in pairs) * 1e9 for k in range(2))
    print(f"{name:<42}{a:10.1f}{b:10.1f}{b / a:10.2f}{ratio:10.2f}")


def main() -> None:
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 4000
    t, data = np.arange(n) / RATE_HZ, readings(n)
    recording = ImuRecording(t, data[0], data[1], mag_uT=data[2])
    many = [argument(np.stack([x] * SEQUENCES)) for x in data]

    def vqf() -> object:
        return VQF(1.0 / RATE_HZ).updateBatch(*data)

    def vqf_of_many() -> object:
        return [vqf() for _ in range(SEQUENCES)]

    print(f"{'one thread, ns a sample':<42}{'ours':>10}{'vqf':>10}{'of least':>10}{'of pairs':>10}")
    for name, filter in FILTERS.items():
        compare(f"{name}, steps alone", stepping(filter, t, data), n, vqf, n)
        compare(f"{name}, run()", lambda f=filter: run(f, recording), n, vqf, n)
    whole = SEQUENCES * n
    for name, filter in FILTERS.items():
        if filter.lanes > 1:
            compare(f"{name}, {SEQUENCES} sequences, steps alone", abreast(filter, t, data), whole, vqf, n)
    for name, filter in FILTERS.items():
        work = lambda f=filter: run_batch(f, t, *many, threads=1)  # noqa: E731
        compare(f"{name}, run_batch() of {SEQUENCES}", work, n * SEQUENCES, vqf_of_many, n * SEQUENCES, 5)
    for name, filter in FILTERS.items():
        compare(f"{name}, Stream.update()", streaming(filter, data), STREAMED, vqfs_stream(data), STREAMED)


if __name__ == "__main__":
    main()
