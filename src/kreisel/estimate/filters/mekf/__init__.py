"""Turns gyro, accelerometer and magnetometer into attitude by a multiplicative error-state Kalman filter."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal, get_args

import numpy as np

from kreisel.data.checks import choice, finite, rotations, shaped
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf import step
from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.maths.vectors import Array

Mode = Literal["auto", "9", "6", "gyro"]

# What first samples leave open, rad: tilt by acceleration, heading by tilt and iron.
_FIRST_TILT, _FIRST_HEADING = math.radians(20.0), math.radians(60.0)

# The same for an attitude that was given.
_GIVEN_TILT, _GIVEN_HEADING = math.radians(2.0), math.radians(5.0)


# m/s/sqrt(Hz): noise of the velocity before any has been seen.
_FIRST_ROAMING = 0.4


@dataclass(frozen=True, slots=True)
class MekfFilter:
    """The error-state filter."""

    mode: Mode = "auto"
    declination: float = 0.0
    window: float = 0.1
    hold: float = 0.25
    coning: bool = False
    gyro_noise: float = math.radians(0.05)
    rate_noise: float = 5e-4
    bias_spread: float = math.radians(0.5)
    bias_drift: float = math.radians(0.01)
    scale_spread: float = 0.004
    scale_drift: float = 1e-5
    velocity_least: float = 0.35
    velocity_most: float = 2.0
    travel_spread: float = 1.0
    travel_time: float = 10.0
    accel_spread: float = 0.03
    field_spread: float = 0.015
    field_time: float = 10.0
    field_noise: float = 0.03
    field_release: float = 2.0
    field_memory: float = 20.0
    lag_spread: float = 0.003
    span: float = 0.5
    tail: float = 4.0

    rest_gyro: float = math.radians(1.0)
    rest_accel: float = 0.3

    @property
    def needs_mag(self) -> bool:
        """Whether a recording without a magnetometer is refused."""
        return self.mode == "9"

    def start(self, R_NS: Array | None = None) -> Array:
        """A fresh state, whose attitude is R_NS (3, 3) or waits for the first samples."""
        state = np.zeros(at.STATE)
        state[at.R_NS : at.R_NS + 9] = np.eye(3).ravel()
        state[at.CALM] = state[at.FLAGS] = at.HELD
        if R_NS is not None:
            known = rotations("R_NS", finite("R_NS", shaped("R_NS", R_NS, (3, 3))))
            state[at.R_NS : at.R_NS + 9] = known.ravel()
            state[at.CALM] = state[at.FLAGS] = 0.0
            state[at.LEVELLED] = state[at.NORTHED] = 1.0
        sigmas = self._first_sigmas(R_NS is not None)
        state[at.COVARIANCE : at.COVARIANCE + at.ERRORS**2] = np.diag(np.square(sigmas)).ravel()
        state[at.SIGMA : at.SIGMA + 3] = sigmas[:3]
        state[at.SPREAD] = sigmas[at.D] ** 2
        state[at.MEAN_FORCE + 2] = GRAVITY
        state[at.ROAMING] = _FIRST_ROAMING**2
        return state

    def _first_sigmas(self, given: bool) -> list[float]:
        tilt, heading = (_GIVEN_TILT, _GIVEN_HEADING) if given else (_FIRST_TILT, _FIRST_HEADING)
        constants = [self.bias_spread] * 3 + [self.scale_spread] * 9
        here = [self.field_spread, *[self.accel_spread] * 3, self.lag_spread, 0.0, 0.0]
        return [tilt, tilt, heading, 0.5, 0.5, *[1.0] * 3, *constants, *here]

    def parameters(self) -> Array:
        """The tuning as the flat array that the kernels read."""
        own = {
            at.START_NORTH: float(self.mode != "6"),
            at.DECLINATION: math.cos(self.declination),
            at.DECLINATION + 1: math.sin(self.declination),
            at.HOLD: self.hold,
            at.DOF: {"auto": 9.0, "9": 9.0, "6": 6.0, "gyro": 0.0}[self.mode],
            at.CONING: 1.0 / 12.0 if self.coning else 0.0,
            at.WINDOW: self.window,
            at.GYRO_NOISE: self.gyro_noise,
            at.RATE_NOISE: self.rate_noise,
            at.BIAS_DRIFT: self.bias_drift,
            at.SCALE_DRIFT: self.scale_drift,
            at.VELOCITY_NOISE: self.velocity_least,
            at.VELOCITY_NOISE + 1: self.velocity_most,
            at.TRAVEL_SPREAD: self.travel_spread,
            at.TRAVEL_TIME: self.travel_time,
            at.ACCEL_SPREAD: self.accel_spread,
            at.FIELD_SPREAD: self.field_spread,
            at.FIELD_TIME_CONSTANT: self.field_time,
            at.FIELD_NOISE: self.field_noise,
            at.FIELD_RELEASE: self.field_release,
            at.FIELD_MEMORY: self.field_memory,
            at.TAIL: self.tail,
            at.SPAN_LENGTH: self.span,
            at.LAG_SPREAD: self.lag_spread,
            at.REST_GYRO: self.rest_gyro,
            at.REST_ACCEL: self.rest_accel,
        }
        return np.array([own[i] for i in range(at.PARAMETERS)])

    def update(self, state: Array, parameters: Array, sample: Array, dt: float) -> None:
        """Move `state` in place over the `dt` seconds that end with `sample`: gyro, accel, mag (9,)."""
        step.update(state, parameters, sample, dt)

    def batch(
        self,
        state: Array,
        parameters: Array,
        t: Array,
        gyro: Array,
        accel: Array,
        mag: Array,
        first: int,
        answers: Array,
    ) -> None:
        """The same through the samples from `first` on, as many as answers has rows."""
        step.batch(state, parameters, t, gyro, accel, mag, first, answers)


FILTER = MekfFilter

STATE_VERSION = 1
"""Raised whenever places of the state change their meaning: streams saved before are then refused."""
