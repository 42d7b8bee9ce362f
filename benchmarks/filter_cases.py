"""Turns numbers into recordings that attitude filters meet: random motions, three grades of sensors, magnets.

Nothing here was fitted to a filter: amplitudes are those of hands, gaits, cars and quadrotors, noise is that of
presets, and
what calibration leaves is stated beside it. Every recording is a function of three names and one number.
"""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np

from kreisel import (
    Environment,
    HardSoftIron,
    Imu,
    ImuRecording,
    Misalignment,
    Motion,
    Mount,
    SampledTrajectory,
    ScaleFactor,
    TurnOnBias,
    WhiteNoise,
)
from kreisel.maths.rotations import exp_so3, matrix_from_euler

SECONDS = 90.0
DENSE_HZ = 60.0  # of the poses behind a motion, whose fastest wave has 3 Hz
G = 9.80665

Array = np.ndarray


class Case(NamedTuple):
    recording: ImuRecording
    truth: Motion  # of the sensor


def waves(rng: np.random.Generator, s: Array, columns: int, low: float, high: float, count: int = 6) -> Array:
    """(n, columns) sums of sinusoids between two frequencies, Hz, of mean square one."""
    f, phase = rng.uniform(low, high, (2, count, columns))[0], rng.uniform(0.0, 2.0 * np.pi, (count, columns))
    return np.sin(2.0 * np.pi * f * s[:, None, None] + phase).sum(axis=1) * np.sqrt(2.0 / count)


def pauses(rng: np.random.Generator, t: Array) -> Array:
    """Time that stands still now and then: rest phases of 2 to 8 s, entered and left within 0.7 s."""
    active = np.ones_like(t)
    at = rng.choice([-1.0, rng.uniform(5.0, 20.0)])
    while at < t[-1]:
        length = rng.uniform(2.0, 8.0)
        active *= 1.0 - smooth((t - at) / 0.7) * smooth((at + length - t) / 0.7)
        at += length + rng.uniform(5.0, 40.0)
    return np.concatenate([[0.0], np.cumsum(0.5 * (active[1:] + active[:-1])) * (t[1] - t[0])])


def smooth(x: Array) -> Array:
    """From 0 to 1 with three smooth derivatives."""
    x = np.clip(x, 0.0, 1.0)
    return x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3)


def hand(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """A thing that is turned and moved about a place, with breaks."""
    s = pauses(rng, t)
    p = rng.uniform(0.02, 0.3) * waves(rng, s, 3, 0.1, 1.0)
    return p, matrix_from_euler(rng.uniform(0.2, 1.2) * waves(rng, s, 3, 0.05, 0.4))


def sport(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """The same, fast: up to 15 rad/s and 3 g."""
    s = pauses(rng, t)
    p = rng.uniform(0.1, 0.3) * waves(rng, s, 3, 0.2, 1.6)
    return p, matrix_from_euler(rng.uniform(0.5, 1.2) * waves(rng, s, 3, 0.2, 0.9))


def table(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """Slow turns that leave the place alone."""
    s = pauses(rng, t)
    return np.zeros((len(t), 3)), matrix_from_euler(rng.uniform(0.5, 2.0) * waves(rng, s, 3, 0.01, 0.12))


def limb(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """A shank or a wrist of somebody who walks, turns and stands."""
    s = pauses(rng, t)
    step = rng.uniform(0.8, 1.2)
    yaw = 1.5 * waves(rng, s, 1, 0.01, 0.06)[:, 0]
    swing = rng.uniform(0.3, 0.7) * np.sin(2.0 * np.pi * step * s) + 0.1 * waves(rng, s, 1, 0.5, 2.0)[:, 0]
    R = matrix_from_euler(np.stack([0.1 * waves(rng, s, 1, 0.3, 1.5)[:, 0], swing, yaw], axis=1))
    hip = _along(yaw, rng.uniform(0.8, 1.6) * np.gradient(s, t), t)
    hip[:, 2] = 0.03 * np.sin(4.0 * np.pi * step * s)
    return hip + R @ np.array([0.0, 0.0, -rng.uniform(0.3, 0.7)]), R


def car(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """Corners of up to 4 m/s^2, traffic lights, a body that rolls and pitches a little."""
    s = pauses(rng, t)
    speed = rng.uniform(4.0, 12.0) * (1.0 + 0.4 * np.clip(waves(rng, s, 1, 0.01, 0.06)[:, 0], -1.5, 1.5))
    speed = speed * _stops(rng, t)
    turn = rng.uniform(0.5, 2.5) * waves(rng, t, 1, 0.01, 0.12)[:, 0] / (speed + 4.0) * smooth(speed / 2.0)
    yaw = np.cumsum(turn) * (t[1] - t[0]) + rng.uniform(-np.pi, np.pi)
    sway = 0.02 * waves(rng, t, 2, 0.1, 2.0) * smooth(speed / 2.0)[:, None]
    return _along(yaw, speed, t), matrix_from_euler(np.column_stack([sway, yaw]))


def quadrotor(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """Its thrust along its own up, so that the accelerometer sees hardly any tilt; drag of 0.3 / s."""
    grow = smooth((t - rng.uniform(-6.0, 6.0)) / 4.0)
    highest = rng.uniform(0.1, 0.3)
    # Of 1 m/s^2 or so, or 2 m where that is less.
    p = grow[:, None] * min(2.0, 0.05 / highest**2) * rng.uniform(0.3, 1.0) * waves(rng, t, 3, 0.02, highest)
    yaw = grow * rng.uniform(0.2, 2.0) * waves(rng, t, 1, 0.02, 0.2)[:, 0]
    return p, _leaning(t, p, yaw) @ exp_so3(grow[:, None] * 0.015 * waves(rng, t, 3, 0.5, 3.0))


def eight(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """A drone that takes off to lying eights of 8 to 25 s and up to 2 g, nose along the path: it leans, or a gimbal
    does not."""
    s = np.cumsum(smooth((t - rng.uniform(1.0, 6.0)) / 4.0)) * (t[1] - t[0])
    angle = 2.0 * np.pi * (s / rng.uniform(8.0, 25.0) + rng.random())
    p = np.stack([np.cos(angle), 0.5 * np.sin(2.0 * angle), 0.05 * np.cos(3.0 * angle)], axis=1)
    a = np.gradient(np.gradient(p, t, axis=0), t, axis=0)
    p *= rng.uniform(0.3, 2.0) * G / np.linalg.norm(a, axis=1).max()
    yaw = np.arctan2(np.cos(2.0 * angle), -np.sin(angle))
    level = matrix_from_euler(np.stack([0.0 * yaw, 0.0 * yaw, yaw], axis=1))
    R = _leaning(t, p, yaw) if rng.random() < 0.5 else level
    return p, R @ exp_so3(0.015 * waves(rng, t, 3, 0.5, 3.0))


def _leaning(t: Array, p: Array, yaw: Array) -> Array:
    """(n, 3, 3) attitudes whose up is the thrust that this path needs, against a drag of 0.3 / s."""
    v = np.gradient(p, t, axis=0)
    up = np.gradient(v, t, axis=0) + 0.3 * v + [0.0, 0.0, G]
    up /= np.linalg.norm(up, axis=1)[:, None]
    level = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1)
    y = np.cross(up, level)
    y /= np.linalg.norm(y, axis=1)[:, None]
    return np.stack([np.cross(y, up), y, up], axis=2)


def _stops(rng: np.random.Generator, t: Array) -> Array:
    """1 while driving, 0 at a red light, with 3 to 5 s of braking between."""
    at, go = rng.uniform(-10.0, 30.0), np.ones_like(t)
    while at < t[-1]:
        length, brake = rng.uniform(10.0, 20.0), rng.uniform(3.0, 5.0)
        go *= 1.0 - smooth((t - at) / brake) * smooth((at + length - t) / brake)
        at += length + rng.uniform(15.0, 40.0)
    return go


def _along(yaw: Array, speed: Array, t: Array) -> Array:
    """(n, 3) path of this heading and speed on level ground."""
    v = speed[:, None] * np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1)
    return np.cumsum(v, axis=0) * (t[1] - t[0])


MOTIONS = {made.__name__: made for made in (hand, sport, table, limb, car, quadrotor, eight)}

# Noise of a preset, then what calibration leaves: gyro scale, misalignment (1), accelerometer bias (m/s^2), gyro bias
# (rad/s), hard iron and noise of the magnetometer (uT).
GRADES = {
    "consumer": ("bmi088", 0.007, 0.005, 0.04, np.radians(0.3), 0.8, 0.5),
    "industrial": ("adis16448", 0.003, 0.001, 0.03, np.radians(0.1), 0.4, 0.3),
    "tactical": ("hg1700", 0.0005, 0.001, 0.01, np.radians(0.01), 0.2, 0.2),
}

# What the disturbances are: nothing; magnets in the room that come and go; magnets on the body that come and go.
FIELDS = ("clean", "room", "attached")


def sensor(grade: str, rng: np.random.Generator) -> Imu:
    preset, scale, lean, accel_bias, gyro_bias, iron, noise = GRADES[grade]
    bare = Imu.from_preset(preset)

    def calibrated(effects, bias):
        kept = [e for e in effects if not isinstance(e, TurnOnBias | ScaleFactor | Misalignment)]
        return [Misalignment(sigma=lean), ScaleFactor(sigma=scale), TurnOnBias(sigma=bias), *kept]

    dip, strength, east = np.radians(rng.uniform(-75.0, 75.0)), rng.uniform(30.0, 60.0), 0.0
    field = strength * np.array([east, np.cos(dip), -np.sin(dip)])
    return dataclasses.replace(
        bare,
        mount=Mount(R_BS=exp_so3(rng.normal(size=3))),
        gyro_effects=calibrated(bare.gyro_effects, gyro_bias),
        accel_effects=calibrated(bare.accel_effects, accel_bias),
        mag_effects=[
            HardSoftIron(rng.normal(0.0, iron, 3), np.eye(3) + rng.normal(0.0, 0.01, (3, 3))),
            WhiteNoise(noise / np.sqrt(50.0)),
        ],
        environment=Environment(field_N_uT=field),
    )


def magnets(rng: np.random.Generator, t: Array, field: str) -> tuple[Array, Array]:
    """(n, 3) microtesla in N, and in S: unevenness of rooms, and magnets for 3 to 25 s at a time."""
    in_N, in_S = 0.4 * waves(rng, t, 3, 0.005, 0.05), np.zeros((len(t), 3))
    at = rng.uniform(8.0, 25.0)
    while field != "clean" and at < t[-1]:
        length = rng.uniform(3.0, 25.0)
        shape = smooth((t - at) / 0.5) * smooth((at + length - t) / 0.5)
        magnet = rng.normal(size=3)
        magnet *= rng.choice([4.0, 10.0, 25.0, 60.0]) / np.linalg.norm(magnet)
        (in_N if field == "room" else in_S)[:] += shape[:, None] * magnet
        at += length + rng.uniform(3.0, 30.0)
    return in_N, in_S


def motion(kind: str, number: int, seconds: float = SECONDS) -> Motion:
    """One random motion; its sampling rate is drawn as well."""
    rng = np.random.default_rng([number, list(MOTIONS).index(kind)])
    dense = np.arange(round(seconds * DENSE_HZ) + 1) / DENSE_HZ
    p, R = MOTIONS[kind](rng, dense)
    rate = rng.choice([100.0, 200.0])
    t = np.arange(round(seconds * rate)) / rate
    return SampledTrajectory(dense, p, R, method="spline").sample(t)


def case(moved: Motion, kind: str, number: int, grade: str, field: str) -> Case:
    """The recording of one motion by one sensor among its magnets."""
    rng = np.random.default_rng([number, list(MOTIONS).index(kind), list(GRADES).index(grade), 7])
    imu = sensor(grade, rng)
    measured = imu.record(moved, int(rng.integers(2**31))).measured
    truth = moved.at(imu.mount)
    in_N, in_S = magnets(rng, moved.t, field)
    mag = measured.mag_uT + np.einsum("nji,nj->ni", truth.R_NB, in_N) + in_S
    # As sensors that integrate between samples read it; at 100 Hz an instant's rate is 5 ms ahead of it.
    gyro = np.array(measured.gyro)
    gyro[1:] = 0.5 * (gyro[1:] + gyro[:-1])
    return Case(
        dataclasses.replace(measured, gyro=gyro, mag_uT=mag, name=f"{kind}-{number}-{grade}-{field}"), truth
    )
