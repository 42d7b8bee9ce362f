"""Presets at rest: the intervals of N, B and K read back hold what the datasheet states, as often as they say.

A fast part of benchmarks/bench_coverage.py, which takes all presets.
"""

from __future__ import annotations

import numpy as np

from kreisel import Imu, ImuRecording, allan, rest
from kreisel.simulate.presets import load

SEED = 41


def read_back(name: str, rate: float, readings: int, together: int, seed: int) -> dict:
    """Noise of gyroscope and accelerometer from readings at `rate`, averaged so many at a time."""
    measured = Imu.from_preset(name).record(rest().sample(np.arange(readings) / rate), seed).measured
    mean = {s: getattr(measured, s).reshape(-1, together, 3).mean(axis=1) for s in ("gyro", "accel")}
    record = ImuRecording(t=measured.t[::together], **mean)
    return {sensor: allan(record, sensor) for sensor in mean}


def held(term, value) -> list[bool]:
    return ((term.low <= value) & (value <= term.high)).tolist()


def test_white_noise_of_sensors_with_a_word_length_and_with_a_low_pass() -> None:
    print("seed", SEED)
    covered = []
    for k, name in enumerate(["bmi088", "icm42688p", "mti1", "hg1700"]):
        rate = 2000.0
        for draw in range(3):
            found = read_back(name, rate, 10_000, 40, SEED + 10 * k + draw)
            for sensor, triad in zip(("gyro", "accel"), load(name).triads()[:2], strict=True):
                # The least significant bit makes white noise of step^2 / 12 in every reading.
                white = np.sqrt(triad.noise.white_noise**2 + np.asarray(triad.step) ** 2 / 12.0 / rate)
                covered += held(found[sensor].N, white)
    # Of 72 at 95 %, 61 or fewer have 1 in 1000 of all chances.
    assert sum(covered) > 61, covered


def test_flicker_and_walk_of_an_hour() -> None:
    print("seed", SEED)
    covered = []
    for k, name in enumerate(["adis16470", "mti300", "tundra-t20"]):
        for draw in range(2):
            found = read_back(name, 20.0, 72_000, 10, SEED + 10 * k + draw)
            for sensor, triad in zip(("gyro", "accel"), load(name).triads()[:2], strict=True):
                covered += held(found[sensor].B, triad.noise.bias_instability)
                covered += held(found[sensor].K, triad.noise.bias_random_walk)
    # As above; where there is no walk, its interval begins at zero but for one record in a thousand.
    assert sum(covered) > 61 and len(covered) == 72, covered
