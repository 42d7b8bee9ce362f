"""Turns gyro, accelerometer and magnetometer into attitude by a multiplicative error-state Kalman filter.

Twenty-seven errors share one covariance: attitude, velocity and the velocity that a body keeps in its own axes, gyro
bias, gyro
scale and misalignment, accelerometer bias, what turns the magnetic field here and now, and by how much the
accelerometer's
samples are older than the gyro's. What a body's accelerations can be is learned as it moves; surprises count by
Student's t.
The answer knows how well it knows: `AttitudeHistory.sigma`. `kreisel.smooth` looks at a whole recording with the same
filter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import get_args

import numpy as np

from kreisel.data.checks import choice
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters.dcm import Mode, nearest_to_given
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf import smooth, step
from kreisel.estimate.filters.mekf.begin import begin
from kreisel.maths.vectors import Array

# What first samples leave open, rad: tilt by acceleration, heading by tilt and iron.
_FIRST_TILT, _FIRST_HEADING = math.radians(20.0), math.radians(60.0)

# The same for an attitude that was given.
_GIVEN_TILT, _GIVEN_HEADING = math.radians(2.0), math.radians(5.0)

# m/s: velocity before any was seen, and what of it a body keeps in its own axes.
_FIRST_VELOCITY, _FIRST_TRAVEL = 0.5, 1.0


@dataclass(frozen=True, slots=True)
class MekfFilter:
    """The error-state filter; every default lies on a plateau (docs/decisions/0050 says how wide).

    Raises ValueError for an unknown mode and for a number that is negative or not finite.
    """

    mode: Mode = (
        "auto"  # "auto": "9" where there is a magnetometer, else "6"; "gyro": nothing after the start
    )
    declination: float = 0.0  # rad, magnetic north east of true north
    window: float = 0.1  # s, over which samples are summed before they correct anything
    span: float = 0.5  # s, over which velocity is averaged before it corrects anything
    hold: float = 0.25  # s, longest gap of the gyro that is bridged by its latest sample
    coning: bool = False  # gyro samples are means of a rate whose axis turns (fast motion at 50 Hz and less)
    gyro_noise: float = math.radians(0.05)  # rad/s/sqrt(Hz), with what vibration adds
    rate_noise: float = 5e-4  # 1/sqrt(Hz), noise that grows with the rate
    bias_spread: float = math.radians(0.7)  # rad/s, at the start
    bias_drift: float = math.radians(0.01)  # rad/s/sqrt(s)
    scale_spread: float = 0.004  # 1, of gyro scale and misalignment
    scale_drift: float = 1e-5  # 1/sqrt(s)
    accel_spread: float = 0.03  # m/s^2, of the accelerometer's bias
    lag_spread: float = 0.003  # s, by which samples of the accelerometer may be older than those of the gyro
    velocity_least: float = 0.35  # m/s/sqrt(Hz), noise of the velocity of a body that hardly moves
    velocity_most: float = 2.0  # m/s/sqrt(Hz), of one that does
    travel_spread: float = 1.0  # m/s of velocity that a body keeps in its own axes
    travel_time: float = 10.0  # s, for which it keeps it
    field_spread: float = 0.015  # 1, of the field's norm, how even the field of a room is
    field_time: float = 10.0  # s, for which it stays uneven in the same way; less where the body turns
    field_noise: float = 0.03  # 1/sqrt(Hz), of the field's norm
    field_release: float = 2.0  # s, for which a disturbance is still believed near
    field_memory: float = 20.0  # s, over which the reference of norm and dip is learned
    tail: float = 4.0  # degrees of freedom of Student's t, by which surprises count
    rest_gyro: float = math.radians(1.0)  # rad/s, scatter of the gyro at rest
    rest_accel: float = 0.3  # m/s^2, scatter of the accelerometer at rest

    def __post_init__(self) -> None:
        choice("mode", self.mode, get_args(Mode))
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, float | int) and not math.isfinite(value):
                raise ValueError(f"{field.name} must be finite; got {value}.")
            if isinstance(value, float | int) and field.name != "declination" and value < 0.0:
                raise ValueError(f"{field.name} must not be negative; got {value}.")

    @property
    def needs_mag(self) -> bool:
        """Whether a recording without a magnetometer is refused."""
        return self.mode == "9"

    @property
    def learns_bias(self) -> bool:
        """Whether gyro_bias can be anything but zero."""
        return True

    @property
    def sigma(self) -> int:
        """Where the state has the standard deviations of the attitude about N axes, rad."""
        return at.SIGMA

    def start(self, R_NS: Array | None = None) -> Array:
        """A fresh state, whose attitude is R_NS (3, 3) or waits for the first samples."""
        state = np.zeros(at.STATE)
        begin(state, self.parameters())
        if R_NS is not None:
            state[at.R_NS : at.R_NS + 9] = nearest_to_given(R_NS).ravel()
            state[at.CALM] = state[at.FLAGS] = 0.0
            state[at.LEVELLED] = state[at.NORTHED] = 1.0
            for i, sigma in enumerate((_GIVEN_TILT, _GIVEN_TILT, _GIVEN_HEADING)):
                state[at.COVARIANCE + i * (at.ERRORS + 1)] = sigma**2
                state[at.SIGMA + i] = sigma
        return state

    def _first_sigmas(self) -> list[float]:
        moving = [_FIRST_VELOCITY] * 2 + [_FIRST_TRAVEL] * 3
        constants = [self.bias_spread] * 3 + [self.scale_spread] * 9
        return [
            *[_FIRST_TILT, _FIRST_TILT, _FIRST_HEADING, *moving, *constants],
            *[self.field_spread, *[self.accel_spread] * 3, self.lag_spread, 0.0, 0.0],
        ]

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
            at.SPAN_LENGTH: self.span,
            at.GYRO_NOISE: self.gyro_noise,
            at.RATE_NOISE: self.rate_noise,
            at.BIAS_DRIFT: self.bias_drift,
            at.SCALE_DRIFT: self.scale_drift,
            at.ACCEL_SPREAD: self.accel_spread,
            at.VELOCITY_NOISE: self.velocity_least,
            at.VELOCITY_NOISE + 1: self.velocity_most,
            at.TRAVEL_SPREAD: self.travel_spread,
            at.TRAVEL_TIME: self.travel_time,
            at.FIELD_SPREAD: self.field_spread,
            at.FIELD_TIME_CONSTANT: self.field_time,
            at.FIELD_NOISE: self.field_noise,
            at.FIELD_RELEASE: self.field_release,
            at.FIELD_MEMORY: self.field_memory,
            at.TAIL: self.tail,
            at.REST_GYRO: self.rest_gyro,
            at.REST_ACCEL: self.rest_accel,
        }
        own |= {at.FIRST_SIGMA + i: sigma for i, sigma in enumerate(self._first_sigmas())}
        return np.array([own[i] for i in range(len(own))])

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
        out: Columns,
    ) -> None:
        """The same through all samples, t (n,) s and the others (n, 3), the first with dt = 0; fills `out`."""
        step.batch(state, parameters, t, gyro, accel, mag, out)

    def smoothed(
        self, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns, R_NS: Array | None = None
    ) -> None:
        """Fill `out` with answers that each know all samples."""
        smooth.smoothed(self.start(R_NS), self.parameters(), t, gyro, accel, mag, out)


FILTER = MekfFilter

STATE_VERSION = 4
"""Raised whenever places of the state change their meaning: streams saved before are then refused."""
