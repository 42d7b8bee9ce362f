"""Turns poses into rates and accelerations by kreisel's spline route and by SciPy's splines, and compares.

Run: .venv/bin/python benchmarks/bench_spline.py [samples]     (one thread; default 200000)

The other side is the usual practice: CubicSpline for positions, RotationSpline for attitude. Limit: a spline
of degree 9 solves a banded system (19 diagonals) per column and sums ten products per value; expected from
operation counts, and measured, is 2 to 3 us a sample for both signals and two derivatives, against 6.8 us that
RotationSpline takes for its iteration alone.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
import tracemalloc

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

import numpy as np

from kreisel import SampledTrajectory

ROUNDS = 7


def poses(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t = np.arange(n) / 200.0
    angle = 2.0 * np.pi * t
    p = np.stack([0.8 * np.cos(angle), 0.8 * np.sin(angle), 0.3 * np.cos(3.0 * angle)], axis=1)
    half = 0.4 * np.sin(angle)
    q = np.stack([np.cos(half), 0.6 * np.sin(half), 0.8 * np.sin(half), np.zeros(n)], axis=1)
    return t, p, q


def ours(t: np.ndarray, p: np.ndarray, q: np.ndarray) -> None:
    SampledTrajectory(t, p, q, "spline", order="wxyz").sample()


def scipys(t: np.ndarray, p: np.ndarray, q: np.ndarray) -> None:
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import Rotation, RotationSpline

    position = CubicSpline(t, p)
    attitude = RotationSpline(t, Rotation.from_quat(q, scalar_first=True))
    for k in range(3):
        position(t, k)
        attitude(t, k)


def copying(t: np.ndarray, p: np.ndarray, q: np.ndarray) -> None:
    """As many bytes as go in and come out: 8 numbers in, 24 out."""
    np.copy(np.broadcast_to(t[:, None], (len(t), 32)))


def seconds(function, data) -> float:
    started = time.perf_counter()
    function(*data)
    return time.perf_counter() - started


def peak_bytes(n: int) -> float:
    """Peak of what the whole route allocates above its outputs (24 numbers a sample), per sample."""
    data = poses(n)
    tracemalloc.start()
    trajectory = SampledTrajectory(*data, "spline", order="wxyz")
    trajectory.sample()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / n - 24 * 8


def main() -> None:
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 200_000
    data = poses(n)
    ours(*poses(100))
    rows = [[seconds(f, data) for f in (ours, scipys, copying)] for _ in range(ROUNDS)]
    ratio = statistics.median(b / a for a, b, _ in rows)
    share = statistics.median(c / a for a, _, c in rows)
    a, b = (statistics.median(r[k] for r in rows) / n * 1e9 for k in range(2))
    print(f"spline route          {a:8.0f} ns/sample   {share:.1%} of the speed of copying the same bytes")
    print(f"CubicSpline + RotationSpline {b:8.0f} ns/sample   ratio {ratio:.1f} (median of {ROUNDS} pairs)")
    print(f"memory above inputs and outputs: {peak_bytes(n):.0f} bytes a sample")


if __name__ == "__main__":
    main()
