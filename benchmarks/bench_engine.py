"""Times a study on Dask workers of this machine against the same study in threads of one process.

    python benchmarks/bench_engine.py [--seconds 6] [--pairs 3] [--threads 2]

The work is a tile of 16 runs: normals for six axes, and the published DCM step over them. There are as many as
take the given seconds in threads (60 for the figure in the README beside this file). Both times are of the whole
study, the start and the end of the workers included; pairs run one after the other. On a machine that is busy with
other work the ratio of processor times, of all processes together, says more than that of the clock.
"""

from __future__ import annotations

import argparse
import os

for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from time import perf_counter

import numpy as np

from kreisel import DcmFilter, run_batch, run_blocks
from kreisel.maths.random import stream

RUNS, SAMPLES = 16, 12_000


@dataclass(frozen=True)
class Tile:
    """Sixteen IMUs at rest for a minute at 200 Hz."""

    seed: int = 1

    def __call__(self, block: int) -> dict[str, np.ndarray]:
        gyro, accel = np.empty((2, RUNS, SAMPLES, 3))
        for k in range(RUNS):
            run = RUNS * block + k
            gyro[k] = 0.01 * stream(self.seed, run, "imu/gyro", "white").normals(0, SAMPLES)
            accel[k] = 0.1 * stream(self.seed, run, "imu/accel", "white").normals(0, SAMPLES)
        accel[..., 2] += 9.80665
        made = run_batch(DcmFilter.as_published(), np.arange(SAMPLES) * 0.005, gyro, accel, threads=1)
        return {"tilt": np.hypot(*made.R_NS[..., 2, :2].transpose(2, 0, 1))[:, ::100]}


def timed(blocks: int, threads: int, backend: str | None) -> tuple[float, float, float, float]:
    """Seconds of a study, processor seconds, seconds until its first block, and a sum over its bits."""
    start, used = perf_counter(), processor()
    results = run_blocks(Tile(), blocks, backend=backend, threads=threads)
    total, first = 0.0, 0.0
    for (_, arrays), now in stamped(results):
        first = first or now - start
        total += float(arrays["tilt"].view(np.uint64).sum() % 2**32)
    return perf_counter() - start, processor() - used, first, total


def processor() -> float:
    """Processor seconds of this process and of those that it started and that have ended."""
    return sum(os.times()[:4])


def stamped(results: Iterator[object]) -> Iterator[tuple[object, float]]:
    for result in results:
        yield result, perf_counter()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=6.0, help="how long a study takes in threads")
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    args = parser.parse_args()
    Tile()(0)
    trial = 8 * args.threads
    blocks = max(1, round(args.seconds / timed(trial, args.threads, None)[0] * trial))
    print(f"{blocks} blocks of {RUNS} runs of {SAMPLES} samples, {args.threads} threads or workers")
    ratios = []
    for _ in range(args.pairs):
        (here, used, _, bits), (there, used_there, first, same) = (
            timed(blocks, args.threads, backend) for backend in (None, "dask")
        )
        assert bits == same, "other bits"
        ratios.append((there / here, used_there / used))
        print(
            f"threads {here:6.2f} s, processor {used:6.2f} s   dask {there:6.2f} s, processor {used_there:6.2f} s, "
            f"first block after {first:4.1f} s   ratios {ratios[-1][0]:.2f} {ratios[-1][1]:.2f}",
            flush=True,
        )
    print("median ratios {:.2f} {:.2f}".format(*map(median, zip(*ratios, strict=True))))


if __name__ == "__main__":
    main()
