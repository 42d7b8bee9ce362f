"""Turns noisy poses into readings by smoothing, and says how good they are, how honest, and at what cost.

Run: .venv/bin/python benchmarks/bench_smooth.py [coverage|correlated|rates|cost] [draws or poses]     (one thread)

Cases A and B of the tests (loop of figure 1, body along the path; the same path, body swaying), 5 s at 200 Hz, an IMU
off the centre of mass, 0.1 mm and 0.01 deg of noise. Goals: accelerometer RMS with the ends / inside 0.75 / 0.42 (A)
and 0.45 / 0.20 m/s^2 (B); 95 % intervals that cover 90 to 98 %; time per pose at 1e7 at most 1.5 times that at 1e5, and
at most 40 times that of the interpolating spline. Limit: with the motion's spectrum known a filter would leave what
white noise has below the frequency at which motion and noise are alike; "best" below is the best smoothness for the
truth, which nobody knows.
"""

from __future__ import annotations

import os
import resource
import sys
import time

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

import numpy as np

from kreisel import FunctionTrajectory, Imu, Motion, Mount, SampledTrajectory, lissajous
from kreisel.maths.rotations import exp_so3
from kreisel.maths.smoothing.blocks import Piece
from kreisel.maths.smoothing.likelihood import Choice
from kreisel.maths.smoothing.spline import SmoothSignal, smoothing_spline
from kreisel.maths.smoothing.system import Smoothness

IMU = Imu(Mount([-0.075, -0.075, 0.025]))
NOISE = 1e-4, np.deg2rad(0.01)


def case_b() -> FunctionTrajectory:
    w = 2.0 * np.pi
    place = [lambda t: 0.8 * np.cos(w * t), lambda t: 0.8 * np.sin(w * t), lambda t: 0.3 * np.cos(3 * w * t)]
    turn = [lambda t: 0.8 * np.cos(w * t), lambda t: 0.8 * np.sin(w * t), lambda t: 0.3 * np.cos(w * t)]
    return FunctionTrajectory(place, turn)


CASES = {"A": lissajous(), "B": case_b()}


def remembered(rng: np.random.Generator, n: int, memory: float, step: float) -> np.ndarray:
    """Noise (n, 3) of variance 1 whose correlation is exp(-dt / memory)."""
    x = rng.normal(size=(n, 3))
    if memory > 0.0:
        kept = np.exp(-step / memory)
        for k in range(1, n):
            x[k] = kept * x[k - 1] + np.sqrt(1.0 - kept**2) * x[k]
    return x


def noisy(truth: Motion, rng: np.random.Generator, memory: float = 0.0) -> SampledTrajectory:
    n, step = len(truth), float(truth.t[1] - truth.t[0])
    p = truth.p_NB + NOISE[0] * remembered(rng, n, memory, step)
    R = truth.R_NB @ exp_so3(NOISE[1] * remembered(rng, n, memory, step))
    return SampledTrajectory(truth.t, p, R, "smooth")


def rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def coverage(draws: int = 200) -> None:
    for name, path in CASES.items():
        truth = path.sample(np.arange(1001) / 200.0)
        exact = IMU.ideal(truth)
        found = [IMU.ideal(noisy(truth, np.random.default_rng(k)).sample()) for k in range(draws)]
        print(f"case {name}, {draws} draws, share of samples inside 95 % intervals:")
        for sensor in ("accel", "gyro"):
            errors = np.array([getattr(r, sensor) - getattr(exact, sensor) for r in found])
            inside = np.abs(errors) < 1.96 * np.array([getattr(r, f"{sensor}_sigma") for r in found])
            over_time = inside.mean(axis=(0, 2))
            print(
                f"  {sensor}: all {inside.mean():.3f}, axes {np.round(inside.mean(axis=(0, 1)), 3)}, "
                f"inside {inside[:, 50:-50].mean():.3f}, first and last ten {over_time[:10].mean():.3f} "
                f"{over_time[-10:].mean():.3f}, over time {np.round(np.quantile(over_time, (0.01, 0.99)), 3)}; "
                f"RMS with ends / inside {np.mean([rms(e) for e in errors]):.4f} / "
                f"{np.mean([rms(e[50:-50]) for e in errors]):.4f}"
            )


def best(signal: SmoothSignal, t: np.ndarray, exact: np.ndarray) -> float:
    """Least RMS error of a second derivative that any smoothness behind white noise leaves."""
    least = []
    for fit, column in zip(signal.fits, exact.T, strict=True):
        choices = [Choice(Smoothness(10.0**k), s / 200.0) for s in (1, 4) for k in np.arange(-4.0, 4.1, 0.25)]
        value = np.empty((3, len(t), 1))
        errors = []
        for choice in choices:
            Piece(fit.samples, choice)(t, 2, value)
            errors.append(rms(value[2, :, 0] - column))
        least.append(min(errors))
    return rms(np.array(least))


def correlated(draws: int = 10) -> None:
    print(
        "correlated noise: acceleration of the centre RMS found / best for white noise, accelerometer RMS, coverage"
    )
    for name, path in CASES.items():
        truth = path.sample(np.arange(1001) / 200.0)
        exact = IMU.ideal(truth)
        for memory in (0.0, 0.005, 0.01, 0.02):
            rows = []
            for k in range(draws):
                trajectory = noisy(truth, np.random.default_rng(k), memory)
                motion = trajectory.sample()
                reading = IMU.ideal(motion)
                assert reading.accel_sigma is not None and reading.gyro_sigma is not None
                inside = [
                    np.mean(np.abs(reading.accel - exact.accel) < 1.96 * reading.accel_sigma),
                    np.mean(np.abs(reading.gyro - exact.gyro) < 1.96 * reading.gyro_sigma),
                ]
                signal = smoothing_spline(truth.t, trajectory.position)
                own = rms(motion.a_NB - truth.a_NB)
                rows.append(
                    [own, best(signal, truth.t, truth.a_NB), rms(reading.accel - exact.accel), *inside]
                )
            a, least, accel, *inside = np.mean(rows, axis=0)
            print(
                f"  case {name}, {1e3 * memory:3.0f} ms: {a:.3f} / {least:.3f} = {a / least:.2f}, accelerometer "
                f"{accel:.3f} m/s^2, covered {inside[0]:.3f}, gyro {inside[1]:.3f}"
            )


def rates(draws: int = 5) -> None:
    print("sampling rate of the poses: RMS of accelerometer m/s^2 and gyro rad/s, inside, and their coverage")
    for name, path in CASES.items():
        for rate in (20, 30, 50, 100, 200, 500):
            truth = path.sample(np.arange(5 * rate + 1) / rate)
            fine = path.sample(np.arange(0.25, 4.75, 0.0025))
            exact, rows = IMU.ideal(fine), []
            for k in range(draws):
                r = IMU.ideal(noisy(truth, np.random.default_rng(k)).sample(fine.t))
                assert r.accel_sigma is not None and r.gyro_sigma is not None
                a, g = r.accel - exact.accel, r.gyro - exact.gyro
                inside = np.mean(np.abs(a) < 1.96 * r.accel_sigma), np.mean(np.abs(g) < 1.96 * r.gyro_sigma)
                rows.append([rms(a), rms(g), *inside])
            a, g, *inside = np.mean(rows, axis=0)
            print(f"  case {name}, {rate:3d} Hz: {a:.3f}, {g:.4f}; covered {inside[0]:.3f}, {inside[1]:.3f}")


def poses(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng, t = np.random.default_rng(0), np.arange(n) / 200.0
    angle = 2.0 * np.pi * t
    p = np.stack([0.8 * np.cos(angle), 0.8 * np.sin(angle), 0.3 * np.cos(3.0 * angle)], axis=1)
    half = 0.4 * np.sin(angle)
    q = np.stack([np.cos(half), 0.6 * np.sin(half), 0.8 * np.sin(half), np.zeros(n)], axis=1)
    p += NOISE[0] * rng.normal(size=p.shape)
    q += 0.5 * NOISE[1] * rng.normal(size=q.shape)
    q /= np.linalg.norm(q, axis=1)[:, None]
    return t, p, q


def seconds(method: str, data: tuple[np.ndarray, np.ndarray, np.ndarray], step: int) -> float:
    """The fit, and the motion of all samples in parts of `step`, as memory allows."""
    started = time.perf_counter()
    trajectory = SampledTrajectory(*data, method, order="wxyz")
    for first in range(0, len(data[0]), step):
        trajectory.sample(data[0][first : first + step])
    return time.perf_counter() - started


def cost(most: int = 10_000_000) -> None:
    seconds("smooth", poses(1000), 1000)
    for n in [n for n in (1_000, 10_000, 100_000, 1_000_000, 10_000_000) if n <= most]:
        data = poses(n)
        rounds = 3 if n <= 100_000 else 1
        smooth, plain = (
            min(seconds(m, data, 1_000_000) for _ in range(rounds)) for m in ("smooth", "spline")
        )
        print(
            f"  {n:9d} poses: {1e6 * smooth / n:7.2f} us a pose, spline {1e6 * plain / n:6.2f}, "
            f"ratio {smooth / plain:5.1f}, "
            f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.1f} GB",
            flush=True,
        )


def main() -> None:
    parts = {"coverage": coverage, "correlated": correlated, "rates": rates, "cost": cost}
    names = [sys.argv[1]] if len(sys.argv) > 1 else list(parts)
    for name in names:
        parts[name](*(int(float(x)) for x in sys.argv[2:]))


if __name__ == "__main__":
    main()
