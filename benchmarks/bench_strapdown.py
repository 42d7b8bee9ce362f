"""Turns ideal recordings back into motion by kreisel's integration and by the usual schemes, and compares errors.

Run: .venv/bin/python benchmarks/bench_strapdown.py     (one thread)

The other schemes hold rate and specific force over a step: as sampled at its start ("euler"), as the mean of both
ends ("mean"), and the mean with the coning and sculling terms of the two samples ("coning": the rate taken as
linear). Limit: between samples a motion is known as far as ten of them show it. Case B is smooth at 200 Hz, and the
method's own sixth order is left; case A bends within 40 ms, eight samples, and 2e-5 m are left.
"""

from __future__ import annotations

import os
import statistics
import time

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kreisel import (
    FunctionTrajectory,
    Imu,
    ImuIncrements,
    ImuRecording,
    Mount,
    coning,
    integrate,
    lissajous,
    round_trip,
)

MOUNT = Mount([-0.075, -0.075, 0.025])
ROUNDS = 7


def case_b() -> FunctionTrajectory:
    w = 2.0 * np.pi
    place = [lambda t: 0.8 * np.cos(w * t), lambda t: 0.8 * np.sin(w * t), lambda t: 0.3 * np.cos(3 * w * t)]
    turn = [lambda t: 0.8 * np.cos(w * t), lambda t: 0.8 * np.sin(w * t), lambda t: 0.3 * np.cos(w * t)]
    return FunctionTrajectory(place, turn)


def held(recording: ImuRecording, rate: np.ndarray, force: np.ndarray) -> ImuIncrements:
    h = np.diff(recording.t)[:, None]
    turn, push = h * rate, h * force
    dv = push + 0.5 * np.cross(turn, push)
    return ImuIncrements(recording.t, turn, dv, 0.5 * h * push + np.cross(turn, push) * h / 6.0)


def euler(recording: ImuRecording) -> ImuIncrements:
    return held(recording, recording.gyro[:-1], recording.accel[:-1])


def mean(recording: ImuRecording) -> ImuIncrements:
    w, f = recording.gyro, recording.accel
    return held(recording, 0.5 * (w[1:] + w[:-1]), 0.5 * (f[1:] + f[:-1]))


def with_coning(recording: ImuRecording) -> ImuIncrements:
    plain, w, f = mean(recording), recording.gyro, recording.accel
    h = np.diff(recording.t)[:, None]
    turn = plain.dtheta + h * h / 12.0 * np.cross(w[:-1], w[1:])
    sculling = np.cross(w[:-1], f[1:]) - np.cross(w[1:], f[:-1])
    return replace(plain, dtheta=turn, dv=plain.dv + h * h / 12.0 * sculling)


SCHEMES: dict[str, Callable[[ImuRecording], ImuRecording | ImuIncrements]] = {
    "euler": euler,
    "mean": mean,
    "coning": with_coning,
    "kreisel": lambda recording: recording,
}


def accuracy() -> None:
    imu = Imu(MOUNT)
    print("largest error over 5 s: position m, velocity m/s, attitude rad")
    for name, path in (("A", lissajous()), ("B", case_b())):
        for rate in (200, 1000):
            motion = path.sample(np.arange(5 * rate + 1) / rate)
            ideal, truth = imu.ideal(motion), motion.at(MOUNT)
            made = {scheme: make(ideal) for scheme, make in SCHEMES.items()}
            made["increments"] = imu.increments(motion)
            made["increments without dp"] = replace(imu.increments(motion), dp=None)
            for scheme, recording in made.items():
                e = round_trip(recording, truth)
                worst = [float(x.max()) for x in (e.position, e.velocity, e.attitude)]
                print(f"  case {name} at {rate:4d} Hz, {scheme:22s}", *(f"{x:8.1e}" for x in worst))


def limit() -> None:
    """What two motions with the same dtheta and dv at 200 Hz may lie apart, both as smooth as case A.

    Case A's tangent is singular where speed is zero, 0.64 + 0.81 sin^2(6 pi t) = 0, next at t = +-0.042 s i. Of the
    functions analytic in that strip and below 1 m/s there, zero at every stamp, the largest is a product of tanh.
    """
    t, strip = np.arange(1001) / 200.0, np.arcsinh(0.8 / 0.9) / (6.0 * np.pi)
    places, weights = np.polynomial.legendre.leggauss(20)
    inside = 0.5 * (t[0] + t[1]) + 0.5 * (t[1] - t[0]) * places
    unseen = np.prod(np.tanh(np.pi * (inside[:, None] - t) / (4.0 * strip)), axis=1)
    apart = abs(0.5 * (t[1] - t[0]) * (weights @ unseen))
    print(f"not in dtheta and dv of case A at 200 Hz: {apart:.1e} m for every m/s")


def speed(n: int = 200_000) -> None:
    motion = coning().sample(np.arange(n) / 1000.0)
    for name, recording in (("rates", Imu().ideal(motion)), ("increments", Imu().increments(motion))):
        integrate(recording, motion)
        seconds = []
        for _ in range(ROUNDS):
            begun = time.perf_counter()
            integrate(recording, motion)
            seconds.append(time.perf_counter() - begun)
        print(f"{name}: {1e6 * statistics.median(seconds) / n:.2f} us a sample (median of {ROUNDS})")


if __name__ == "__main__":
    accuracy()
    limit()
    speed()
