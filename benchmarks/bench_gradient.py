"""Times the fused gradient kernel against plain NumPy, pair by pair on one thread, and against copying.

    python benchmarks/bench_gradient.py

Limit: 56 bytes in and 192 out a sample take 11 ns at the speed of a warm copy (23 GB/s), and three times that
where the outputs are fresh memory the system has yet to map. Three sines and cosines take 37 ns from libm and
9 as SIMD; the other 100 operations and 60 moves 10 to 20. So 30 ns are expected in the cache and 60 outside.

Both turn positions and Euler angles (n, 3) into v, a, R, omega, alpha and specific force. A line of the table
is the median of pairs that ran one after the other, so that a busy machine slows both. "copy" moves as many
bytes into fresh memory as the inputs and outputs have; "memory" is the peak above inputs and outputs, each
measured in a process of its own.
"""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
import numpy.typing as npt

from kreisel.maths.gradient import gradient_motion

Array = npt.NDArray[np.float64]
Motion = tuple[Array, ...]
G_N = np.array([0.0, 0.0, -9.80665])
# t, s, phi in; v, a, R, omega, alpha, f out.
DOUBLES_IN, DOUBLES_OUT = 7, 24


def numpy_gradient(x: Array, t: Array) -> Array:
    slope = np.empty_like(x)
    spans = (t[2:] - t[:-2]).reshape(-1, *[1] * (x.ndim - 1))
    np.subtract(x[2:], x[:-2], out=slope[1:-1])
    slope[1:-1] /= spans
    slope[0] = (x[1] - x[0]) / (t[1] - t[0])
    slope[-1] = (x[-1] - x[-2]) / (t[-1] - t[-2])
    return slope


def numpy_matrices(phi: Array) -> Array:
    sx, sy, sz = np.sin(phi).T
    cx, cy, cz = np.cos(phi).T
    R = np.empty((len(phi), 3, 3))
    R[:, 0, 0], R[:, 0, 1], R[:, 0, 2] = cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx
    R[:, 1, 0], R[:, 1, 1], R[:, 1, 2] = sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx
    R[:, 2, 0], R[:, 2, 1], R[:, 2, 2] = -sy, cy * sx, cy * cx
    return R


def literal_motion(t: Array, s: Array, phi: Array, g_N: Array) -> Motion:
    """The same six arrays with the document's formulas written down as they stand: Rz Ry Rx, dR/dt, R^-1."""
    one, nil = np.ones(len(t)), np.zeros(len(t))
    (cx, cy, cz), (sx, sy, sz) = np.cos(phi.T), np.sin(phi.T)
    Rx, Ry, Rz = (
        np.moveaxis(np.array(rows), -1, 0)
        for rows in (
            [[one, nil, nil], [nil, cx, -sx], [nil, sx, cx]],
            [[cy, nil, sy], [nil, one, nil], [-sy, nil, cy]],
            [[cz, -sz, nil], [sz, cz, nil], [nil, nil, one]],
        )
    )
    v = numpy_gradient(s, t)
    a = numpy_gradient(v, t)
    R = Rz @ Ry @ Rx
    R_inverse = np.linalg.inv(R)
    Omega = R_inverse @ numpy_gradient(R, t)
    omega = np.stack([Omega[:, 2, 1], Omega[:, 0, 2], Omega[:, 1, 0]], axis=1)
    return v, a, R, omega, numpy_gradient(omega, t), (R_inverse @ (a - g_N)[:, :, None])[:, :, 0]


def numpy_motion(t: Array, s: Array, phi: Array, g_N: Array) -> Motion:
    """The same six arrays, as somebody who knows NumPy would write them."""
    v = numpy_gradient(s, t)
    a = numpy_gradient(v, t)
    R = numpy_matrices(phi)
    Omega = R.transpose(0, 2, 1) @ numpy_gradient(R, t)
    omega = np.stack([Omega[:, 2, 1], Omega[:, 0, 2], Omega[:, 1, 0]], axis=1)
    return v, a, R, omega, numpy_gradient(omega, t), np.einsum("nji,nj->ni", R, a - g_N)


def inputs(n: int) -> tuple[Array, Array, Array, Array]:
    t = np.arange(n) * 1e-3
    t[1::2] += 2e-4  # uneven steps
    angle = 2.0 * np.pi * t
    s = np.stack([0.8 * np.cos(angle), 0.8 * np.sin(angle), 0.3 * np.cos(3.0 * angle)], axis=1)
    return t, s, s[:, ::-1].copy(), G_N


def seconds(work: Callable[[], object]) -> float:
    start = perf_counter()
    result = work()
    passed = perf_counter() - start
    del result  # outside the clock, but before the next one allocates
    return passed


def race(n: int, pairs: int) -> tuple[float, float, float, float, float]:
    """Medians over pairs: ns per sample of NumPy and of the kernel, literal/kernel, NumPy/kernel, copy/kernel."""
    given = inputs(n)
    moved = np.zeros(n * (DOUBLES_IN + DOUBLES_OUT) // 2)
    works = (
        lambda: literal_motion(*given),
        lambda: numpy_motion(*given),
        lambda: gradient_motion(*given),
        moved.copy,
    )
    literal, plain, fused, copy = np.array([[seconds(w) for w in works] for _ in range(pairs + 1)][1:]).T
    ratios = [float(np.median(x / fused)) for x in (literal, plain, copy)]
    return float(np.median(plain)) / n * 1e9, float(np.median(fused)) / n * 1e9, *ratios


def peak_bytes(which: str, n: int) -> float:
    """Peak bytes per sample above inputs and outputs, in a fresh process."""
    done = subprocess.run(
        [sys.executable, __file__, which, str(n)], capture_output=True, text=True, check=True
    )
    return float(done.stdout)


def measure_peak(which: str, n: int) -> None:
    motion = {"fused": gradient_motion, "numpy": numpy_motion}[which]
    motion(*inputs(1000))
    given = inputs(n)
    # ru_maxrss never falls, but building the inputs takes less than the outputs will.
    before = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
    result = motion(*given)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print((peak - before) / n - sum(x.nbytes for x in result) / n)


def main() -> None:
    # Memory first: a peak is inherited by the processes that measure it.
    for which in ("fused", "numpy"):
        print(
            f"memory above inputs and outputs at 1e7 samples, {which}: {peak_bytes(which, 10_000_000):.0f} B/sample"
        )
    print("   samples   NumPy ns   fused ns   literal/fused   NumPy/fused   copy/fused")
    for n, pairs in ((1_000, 400), (10_000, 100), (100_000, 15), (1_000_000, 7), (10_000_000, 1)):
        plain, fused, literal, ratio, copy = race(n, pairs)
        print(f"{n:10d} {plain:10.0f} {fused:10.1f} {literal:15.1f} {ratio:13.1f} {copy:12.2f}")


if __name__ == "__main__":
    if len(sys.argv) == 3:
        measure_peak(sys.argv[1], int(sys.argv[2]))
    else:
        main()
