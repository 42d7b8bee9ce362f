"""Turns gyro, accelerometer and magnetometer into attitude by a direction cosine matrix: the tutorial's step, cured.

`DcmFilter()` is the default; `DcmFilter.as_published(...)` is the step of Starlino's tutorial (document 002) to the
letter, and `PublishedStep` has a switch for the cure of each of its three weaknesses:

1. The accelerometer says nothing about rotation around the vertical, yet the weighted mean divides the gyro's part
   there by (s_g + s_a): ten turns at s_a = 0.01 lose 36 degrees. `observed` weighs only what a sensor sees.
2. The first-order step leaves the group of rotations. `exact` turns by Exp.
3. Weights per step mean another filter at another sampling rate. `rate_hz` makes time constants of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal, get_args

import numpy as np

from kreisel.data.checks import choice, rotations, shaped
from kreisel.estimate.answers import Columns
from kreisel.estimate.filters.dcm import layout as at
from kreisel.estimate.filters.dcm import published, published_lanes, step, step_lanes
from kreisel.estimate.filters.dcm.covariance import GRAVITY
from kreisel.maths.kernels import LANES
from kreisel.maths.vectors import Array

Mode = Literal["auto", "9", "6", "gyro"]

# What first samples leave open, rad: tilt by acceleration, heading by tilt and iron.
_FIRST_TILT, _FIRST_HEADING = math.radians(20.0), math.radians(60.0)

# The same for an attitude that was given.
_GIVEN_TILT, _GIVEN_HEADING = math.radians(2.0), math.radians(5.0)

# s: rows are made orthonormal once in a window, and ten thousand roundings between are 1e-12 at worst.
_LONGEST_WINDOW = 10.0


@dataclass(frozen=True, slots=True)
class PublishedStep:
    """The tutorial's step: weights per sample of what the three sensors say, and its three cures, all off.

    Raises ValueError for a negative weight and for a gyro without weight.
    """

    weight_gyro: float = 1.0
    weight_accel: float = 0.01
    weight_mag: float = 0.01
    observed: bool = False  # a weight counts only around the axes that its sensor observes
    exact: bool = False  # the axes are turned by Exp(dtheta), not moved by dtheta x r
    rate_hz: float = (
        0.0  # > 0: the weights are those of this sampling rate, other rates keep its time constants
    )

    def __post_init__(self) -> None:
        if not (self.weight_gyro > 0.0 and self.weight_accel >= 0.0 and self.weight_mag >= 0.0):
            raise ValueError(
                f"weights must be > 0 for the gyro and >= 0 for the others; got "
                f"{self.weight_gyro}, {self.weight_accel}, {self.weight_mag}."
            )


@dataclass(frozen=True, slots=True)
class DcmFilter:
    """The DCM filter; every default lies on a plateau (docs/decisions says how wide).

    The two times are those of the corrections once bias and scale are settled: a second-order Butterworth filter
    for the inclination, a first-order one for the heading. Both are faster at the start.
    Raises ValueError for an unknown mode, a window above 10 s and a number that is negative or not finite.
    """

    mode: Mode = (
        "auto"  # "auto": "9" where there is a magnetometer, else "6"; "gyro": nothing after the start
    )
    declination: float = 0.0  # rad, magnetic north east of true north
    accel_time: float = 5.0  # s
    mag_time: float = 60.0  # s
    travel_spread: float = (
        1.0  # m/s of velocity that a body keeps in its own axes; 0: it stays about its place
    )
    travel_time: float = 10.0  # s, for which it keeps it
    window: float = 0.2  # s, over which samples are summed before they correct anything
    hold: float = 0.25  # s, longest gap of the gyro that is bridged by its latest sample
    coning: bool = False  # gyro samples are means of a rate whose axis turns (fast motion at 50 Hz and less)
    gyro_noise: float = math.radians(0.1)  # rad/s/sqrt(Hz), with what vibration adds
    rate_noise: float = 3e-4  # 1/sqrt(Hz), noise that grows with the rate
    bias_spread: float = math.radians(0.5)  # rad/s, at the start
    bias_drift: float = math.radians(0.005)  # rad/s/sqrt(s)
    scale_spread: float = 0.004  # 1, of gyro scale and misalignment
    scale_drift: float = 1e-5  # 1/sqrt(s)
    field_spread: float = 0.02  # 1, of the field's norm, how even the field of a room is
    field_release: float = 3.0  # s, for which a disturbance is still believed near
    field_memory: float = 20.0  # s, over which the reference of norm and dip is learned
    rest_gyro: float = math.radians(1.0)  # rad/s, scatter of the gyro at rest
    rest_accel: float = 0.3  # m/s^2, scatter of the accelerometer at rest
    published: PublishedStep | None = None  # the tutorial's step, for which the lines above but four are idle

    def __post_init__(self) -> None:
        choice("mode", self.mode, get_args(Mode))
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, float | int) and not math.isfinite(value):
                raise ValueError(f"{field.name} must be finite; got {value}.")
            if isinstance(value, float | int) and field.name != "declination" and value < 0.0:
                raise ValueError(f"{field.name} must not be negative; got {value}.")
        if self.window > _LONGEST_WINDOW:
            raise ValueError(f"window must be at most {_LONGEST_WINDOW:g} s; got {self.window}.")

    @classmethod
    def as_published(
        cls,
        weight_gyro: float = 1.0,
        weight_accel: float = 0.01,
        weight_mag: float = 0.01,
        mode: Mode = "auto",
    ) -> DcmFilter:
        """The tutorial's step to the letter, with its weights per sample."""
        return cls(mode=mode, published=PublishedStep(weight_gyro, weight_accel, weight_mag))

    @property
    def needs_mag(self) -> bool:
        """Whether a recording without a magnetometer is refused."""
        return self.mode == "9"

    @property
    def learns_bias(self) -> bool:
        """Whether gyro_bias can be anything but zero."""
        return self.published is None

    def start(self, R_NS: Array | None = None) -> Array:
        """A fresh state, whose attitude is R_NS (3, 3) or waits for the first samples."""
        state = np.zeros(at.PUBLISHED_STATE if self.published else at.STATE)
        state[at.R_NS] = state[at.R_NS + 4] = state[at.R_NS + 8] = 1.0
        state[at.CALM] = state[at.FLAGS] = at.HELD
        if R_NS is not None:
            state[at.R_NS : at.R_NS + 9] = nearest_to_given(R_NS).ravel()
            state[at.CALM] = state[at.FLAGS] = 0.0
            state[at.LEVELLED] = state[at.NORTHED] = 1.0
        if not self.published:
            P = np.diag(np.square(self._first_sigmas(R_NS is not None)))
            state[at.COVARIANCE : at.COVARIANCE + at.ERRORS**2] = P.ravel()
        return state

    def _first_sigmas(self, given: bool) -> list[float]:
        tilt, heading = (_GIVEN_TILT, _GIVEN_HEADING) if given else (_FIRST_TILT, _FIRST_HEADING)
        velocity = self._velocity_noise()
        constants = [self.bias_spread] * 3 + [self.scale_spread] * 9
        return [tilt, tilt, heading, velocity, velocity, *[self.travel_spread] * 3, *constants]

    def _velocity_noise(self) -> float:
        """The noise of "velocity is zero" for which the steady filter's frequency is 1 / accel_time."""
        return GRAVITY * self.gyro_noise * self.accel_time**2

    def parameters(self) -> Array:
        """The tuning as the flat array that the kernels read."""
        own = self._published_parameters() if self.published else self._default_parameters()
        own |= {
            at.START_NORTH: float(self.mode != "6"),
            at.DECLINATION: math.cos(self.declination),
            at.DECLINATION + 1: math.sin(self.declination),
            at.HOLD: self.hold,
        }
        return np.array([own[i] for i in range(len(own))])

    def _published_parameters(self) -> dict[int, float]:
        weights = self.published or PublishedStep()
        return {
            at.WEIGHT_GYRO: weights.weight_gyro,
            at.WEIGHT_ACCEL: 0.0 if self.mode == "gyro" else weights.weight_accel,
            at.WEIGHT_MAG: 0.0 if self.mode in ("gyro", "6") else weights.weight_mag,
            at.OBSERVED: float(weights.observed),
            at.EXACT: float(weights.exact),
            at.RATE_HZ: weights.rate_hz,
        }

    def _default_parameters(self) -> dict[int, float]:
        return {
            at.DOF: {"auto": 9.0, "9": 9.0, "6": 6.0, "gyro": 0.0}[self.mode],
            at.CONING: 1.0 / 12.0 if self.coning else 0.0,
            at.WINDOW: self.window,
            at.GYRO_NOISE: self.gyro_noise,
            at.RATE_NOISE: self.rate_noise,
            at.BIAS_DRIFT: self.bias_drift,
            at.SCALE_DRIFT: self.scale_drift,
            at.VELOCITY_NOISE: self._velocity_noise(),
            # For which the steady filter's time constant is mag_time.
            at.HEADING_NOISE: self.gyro_noise * self.mag_time,
            at.FIELD_SPREAD: self.field_spread,
            at.FIELD_RELEASE: self.field_release,
            at.FIELD_MEMORY: self.field_memory,
            at.REST_GYRO: self.rest_gyro,
            at.REST_ACCEL: self.rest_accel,
            at.TRAVEL_SPREAD: self.travel_spread,
            at.TRAVEL_TIME: self.travel_time,
            # What has this time constant counts once in twice that time.
            at.TILT_TIME: 2.0 * self.accel_time,
        }

    def update(self, state: Array, parameters: Array, sample: Array, dt: float) -> None:
        """Move `state` in place over the `dt` seconds that end with `sample`: gyro, accel, mag (9,)."""
        (published if self.published else step).update(state, parameters, sample, dt)

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
        (published if self.published else step).batch(state, parameters, t, gyro, accel, mag, out)

    @property
    def lanes(self) -> int:
        """How many recordings `batch_of_lanes` takes abreast: one by one with two of the published step's cures."""
        return 1 if self.published and (self.published.exact or self.published.rate_hz) else LANES

    def batch_of_lanes(
        self, states: Array, parameters: Array, dt: Array, readings: Array, answers: Array
    ) -> None:
        """The steps of `batch` for LANES states (LANES, STATE) with the same bits; see `LaneFilter`."""
        (published_lanes if self.published else step_lanes).batch_of_lanes(
            states, parameters, dt, readings, answers
        )

    def batch_of_rows(
        self,
        states: Array,
        parameters: Array,
        dt: Array,
        gyro: Array,
        accel: Array,
        mag: Array,
        out: Columns,
    ) -> None:
        """The same of recordings (lanes, n, 3) that lie one after the other."""
        (published_lanes if self.published else step_lanes).batch_of_rows(
            states, parameters, dt, gyro, accel, mag, out
        )


def nearest_to_given(R_NS: Array) -> Array:
    """The rotation that a first attitude (3, 3) stands for where it is one to six digits only.

    Raises ValueError for another shape and for what is no rotation.
    """
    left, _, right = np.linalg.svd(rotations("R_NS", shaped("R_NS", R_NS, (3, 3))))
    return np.asarray(left @ right)


FILTER = DcmFilter

STATE_VERSION = 2
"""Raised whenever places of the state change their meaning: streams saved before are then refused."""
