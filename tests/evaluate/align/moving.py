"""A body that turns and moves every way, and IMUs on it whose faults are known."""

from __future__ import annotations

from functools import cache

import numpy as np

from kreisel.data.motion import Mount
from kreisel.data.recording import ImuRecording
from kreisel.maths.rotations import exp_so3
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.effects.scale_factor import ScaleFactor
from kreisel.simulate.effects.turn_on_bias import TurnOnBias
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.sampled import SampledTrajectory

PATH = (lambda t: 0.8 * np.cos(2.0 * t), lambda t: 0.5 * np.sin(3.0 * t), lambda t: 0.3 * np.cos(5.0 * t))
TURNS = (lambda t: 0.8 * np.cos(4.0 * t), lambda t: 0.8 * np.sin(3.0 * t), lambda t: 0.9 * np.cos(2.2 * t))
T = np.arange(0.6, 10.6, 0.01)


def still(t):
    """A coordinate that never changes."""
    return 0.0 * t


def along(position, angles, noise_m=0.0, rng=None) -> SampledTrajectory:
    """Twelve seconds of three functions of time and three angles, sampled at 100 Hz; 1 mm of noise goes with 5 mrad."""
    t = np.arange(0.0, 12.0, 0.01)
    motion = FunctionTrajectory(position, angles).sample(t)
    p, R = motion.p_NB, motion.R_NB
    if rng is not None:
        p = p + noise_m * rng.normal(size=p.shape)
        R = R @ exp_so3(5.0 * noise_m * rng.normal(size=p.shape))
    return SampledTrajectory(t, p, R)


@cache
def every_way() -> SampledTrajectory:
    """Turns about all axes, splines through samples: as exact as the recordings made on it."""
    return along(PATH, TURNS)


class Truth:
    """Faults drawn at random: any rotation, a lever arm of decimetres, clocks up to 0.4 s apart."""

    def __init__(self, rng: np.random.Generator, latency: float | None = None) -> None:
        self.R_BS = exp_so3(rng.uniform(-np.pi, np.pi) * _direction(rng))
        self.lever_arm = 0.1 * rng.normal(size=3)
        self.gyro_bias, self.accel_bias = 0.02 * rng.normal(size=3), 0.1 * rng.normal(size=3)
        self.gyro_scale, self.accel_scale = 1.0 + 0.01 * rng.normal(size=(2, 3))
        drawn = rng.uniform(0.0, 0.01)
        self.latency = drawn if latency is None else latency
        self.accel_clock = rng.uniform(-0.4, 0.4)
        self.gyro_clock = self.accel_clock + self.latency
        self.drift = 1e-4 * rng.normal()
        self.tilt = np.zeros(2)

    def recording(self, *noises, rng: int = 0) -> ImuRecording:
        """What an IMU with these faults reads; `noises` are effects of the gyro and of the accelerometer."""
        gyro, accel = noises or ((), ())
        imu = Imu(
            Mount(self.lever_arm, self.R_BS),
            gyro_effects=(ScaleFactor(self.gyro_scale - 1.0), TurnOnBias(fixed=self.gyro_bias), *gyro),
            accel_effects=(ScaleFactor(self.accel_scale - 1.0), TurnOnBias(fixed=self.accel_bias), *accel),
            clock=Clock(offset=self.accel_clock, rate_offset=self.drift, gyro=Sampling(latency=self.latency)),
        )
        return imu.record(every_way().sample(T), rng).measured


def _direction(rng: np.random.Generator) -> np.ndarray:
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)
