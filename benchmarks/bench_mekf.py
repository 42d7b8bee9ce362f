"""Turns IMU samples into attitude by the error-state filter, its smoother and vqf's C++, and compares time and memory.

Run: .venv/bin/python benchmarks/bench_mekf.py [samples]     (one thread but for the last rows; default 20000)

Limit: a window of 0.1 s takes some 30 us, most of it the covariance of 27 errors: P <- F P F^T touches five rows twice
(some 6000 multiplications) and each of three to six observations all 729 places. A sample takes 30 ns more.
"""

from __future__ import annotations

import os
import sys
import time
import tracemalloc

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

import numpy as np
from bench_dcm import RATE_HZ, STREAMED, compare, readings, stepping, streaming, vqfs_stream
from vqf import VQF, offlineVQF

from kreisel import ImuRecording, MekfFilter, run, smooth
from kreisel.estimate.batch import run_all
from kreisel.estimate.smooth import smooth_all

MANY = 16


def seconds_of_wall(work) -> float:
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def print_threads(name: str, of_all) -> None:
    """How much faster all cores are than one, at the best of three rounds."""
    one, all_cores = (min(seconds_of_wall(lambda k=k: of_all(k)) for _ in range(3)) for k in (1, None))
    print(
        f"{name:<42}{one:8.3f} s on one thread,{all_cores:8.3f} s on all cores, ratio {one / all_cores:.2f}"
    )


def print_memory(name: str, work, samples: int) -> None:
    """The most that is held at once, answers included, above what was there before."""
    work()
    tracemalloc.start()
    kept = work()
    _, most = tracemalloc.get_traced_memory()
    now, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del kept
    print(f"{name:<42}{most / samples:8.0f} bytes a sample at most,{now / samples:8.0f} kept")


def main() -> None:
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 20_000
    data = readings(n)
    t = np.arange(n) / RATE_HZ
    recording, filter = ImuRecording(t, data[0], data[1], mag_uT=data[2]), MekfFilter()

    def vqf() -> object:
        return VQF(1.0 / RATE_HZ).updateBatch(*data)

    def offline() -> object:
        return offlineVQF(*data, 1.0 / RATE_HZ)

    print(f"{'one thread, ns a sample':<42}{'ours':>10}{'vqf':>10}{'of least':>10}{'of pairs':>10}")
    compare("mekf, steps alone", stepping(filter, t, data), n, vqf, n)
    compare("mekf, run()", lambda: run(filter, recording), n, vqf, n)
    compare("mekf, smooth()", lambda: smooth(filter, recording), n, vqf, n)
    compare("mekf, smooth(), against offlineVQF", lambda: smooth(filter, recording), n, offline, n, 5)
    compare("mekf, Stream.update()", streaming(filter, data), STREAMED, vqfs_stream(data), STREAMED)
    print_threads(f"run_all() of {MANY}", lambda k: run_all(filter, [recording] * MANY, threads=k))
    print_threads(f"smooth_all() of {MANY}", lambda k: smooth_all(filter, [recording] * MANY, threads=k))
    hour = readings(3600 * 50)
    long = ImuRecording(np.arange(len(hour[0])) / 50.0, hour[0], hour[1], mag_uT=hour[2])
    print_memory("run(), an hour at 50 Hz", lambda: run(filter, long), len(long))
    print_memory("smooth(), an hour at 50 Hz", lambda: smooth(filter, long), len(long))


if __name__ == "__main__":
    main()
