"""Times counter-based normals against NumPy's generators, on one thread.

    python benchmarks/bench_random.py

The limit: a pair of normals of 53 bits needs one Philox4x32-10 block, which is twenty products of 32-bit words and
some sixty logical operations; "integers alone" is what the machine makes of it. On top come a logarithm (one
division, fifteen products), a root, and a sine with a cosine (sixteen products). Each figure is the best of many runs.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np

from kreisel.maths.random import philox, stream

SAMPLES, CHANNELS = 4096, 3
NUMBERS = SAMPLES * CHANNELS


def million_per_second(work: Callable[[], object], runs: int = 500) -> float:
    work()
    best = np.inf
    for _ in range(runs):
        start = perf_counter()
        work()
        best = min(best, perf_counter() - start)
    return float(NUMBERS / best / 1e6)


def main() -> None:
    ours = stream(1, 0, "imu/gyro", "white_noise")
    words, a = np.array([1, 2, 3], dtype=np.uint64), np.empty(NUMBERS // 2, dtype=np.uint64)
    b = np.empty_like(a)
    counter_based, default = np.random.Generator(np.random.Philox(1)), np.random.default_rng(1)
    works: dict[str, Callable[[], object]] = {
        "integers alone": lambda: philox(words, np.uint64(0), np.uint64(0), a, b),
        "uniforms": lambda: ours.uniforms(0, SAMPLES, CHANNELS),
        "normals": lambda: ours.normals(0, SAMPLES, CHANNELS),
        "normals, NumPy Philox": lambda: counter_based.standard_normal((SAMPLES, CHANNELS)),
        "normals, NumPy PCG64": lambda: default.standard_normal((SAMPLES, CHANNELS)),
    }
    for name, work in works.items():
        print(f"{name:<24} {million_per_second(work):7.1f} million/s")


if __name__ == "__main__":
    main()
