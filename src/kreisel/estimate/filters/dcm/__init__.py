"""Gyro, accelerometer and magnetometer into attitude by a direction cosine matrix: the tutorial's step, and its cure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kreisel.estimate.filters.dcm import cured, published, window
from kreisel.estimate.filters.dcm import state as at
from kreisel.estimate.filters.dcm.vectors import Array

Mode = Literal["auto", "9", "6", "gyro"]

# What the first samples leave open: tilt by an acceleration of 1 m/s^2, heading by iron nearby.
_START_TILT = math.radians(20.0)
_START_HEADING = math.radians(60.0)
_GRAVITY = 9.80665


@dataclass(frozen=True, slots=True)
class PublishedStep:
    """The weights of the tutorial's step, and a switch for the cure of each of its three weaknesses."""

    weight_gyro: float = 1.0
    weight_accel: float = 0.01
    weight_mag: float = 0.01
    observed: bool = False  # a weight counts only around the axes that its sensor observes
    exact: bool = False  # rotate by Exp(dtheta), which stays on the group, rather than by dtheta x r
    rate_hz: float | None = None  # the weights are those of this rate; others keep its time constants


@dataclass(frozen=True, slots=True)
class DcmFilter:
    mode: Mode = "auto"
    declination: float = 0.0
    accel_time: float = 5.0
    mag_time: float = 60.0
    window: float = 0.2
    gyro_noise: float = math.radians(0.1)
    bias_spread: float = math.radians(0.5)
    bias_drift: float = math.radians(0.005)
    scale_spread: float = 0.004
    scale_drift: float = 1e-5
    rate_noise: float = 3e-4
    field_spread: float = 0.02
    field_release: float = 3.0
    field_memory: float = 20.0
    rest_gyro: float = math.radians(1.0)
    rest_accel: float = 0.3
    hold: float = 0.1
    published: PublishedStep | None = None

    def parameters(self) -> Array:
        common = [
            float(self.mode in ("auto", "9", "gyro")),
            math.cos(self.declination),
            math.sin(self.declination),
            self.hold,
        ]
        p = self.published
        if p:
            m6 = self.mode
            return np.array(
                [
                    *common,
                    p.weight_gyro,
                    0.0 if self.mode == "gyro" else p.weight_accel,
                    0.0 if self.mode in ("gyro", "6") else p.weight_mag,
                    float(p.observed),
                    float(p.exact),
                    p.rate_hz or 0.0,
                ]
            )
        return np.array(
            [
                *common,
                {"auto": 9.0, "9": 9.0, "6": 6.0, "gyro": 0.0}[self.mode],
                self.window,
                self.gyro_noise,
                self.bias_drift,
                self.scale_drift,
                self.rate_noise,
                _GRAVITY * self.gyro_noise * self.accel_time**2,
                self.gyro_noise * self.mag_time,
                self.field_spread,
                self.field_release,
                self.field_memory,
                self.rest_gyro,
                self.rest_accel,
            ]
        )

    def start(self, R_NS: Array | None = None) -> Array:
        state = np.zeros(at.COMMON if self.published else at.SIZE)
        state[at.R : at.R + 9] = np.eye(3).ravel() if R_NS is None else np.ravel(R_NS)
        if R_NS is not None:
            state[at.LEVELLED] = state[at.NORTHED] = 1.0
        else:
            state[at.CALM] = at.HELD
        if not self.published:
            v = _GRAVITY * self.gyro_noise * self.accel_time**2
            sigmas = [_START_TILT] * 2 + [_START_HEADING] + [v] * 2 + [self.bias_spread] * 3 + [self.scale_spread] * 9
            state[at.COVARIANCE : at.COVARIANCE + at.ERRORS**2] = np.diag(np.square(sigmas)).ravel()
            state[at.CANDIDATE + 2] = 1e6
        return state

    @property
    def kernels(self) -> Any:
        return published if self.published else cured
