"""Turns a cone's half angle and rate into classic coning motion at a fixed place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array, finite_number, increasing, shaped
from kreisel.data.motion import Motion
from kreisel.maths.kinematics import quaternion_motion


@dataclass(frozen=True)
class Coning:
    """A body whose z axis runs round a cone about the vertical while it does not turn about it on the whole.

    half_angle: rad, of the cone; rate: rad/s, at which the z axis goes round, counter-clockwise.

    The attitude is a rotation by half_angle about a level axis that turns at `rate`. The gyro reads a
    constant -2 rate sin^2(half_angle / 2) about z although the attitude comes back after every round:
    integrating the rates as if rotations commuted turns that into drift.
    Source: Savage, Strapdown Analytics, ch. 7.
    """

    half_angle: float = 0.1
    rate: float = 10.0

    def __post_init__(self) -> None:
        finite_number("half_angle", self.half_angle)
        finite_number("rate", self.rate)

    @property
    def span(self) -> tuple[float, float]:
        """It goes on for ever."""
        return (-np.inf, np.inf)

    def sample(self, t: Array) -> Motion:
        """Motion at times t (n,) s, increasing."""
        times = increasing("t", shaped("t", t, ("n",)))
        c, s = np.cos(0.5 * self.half_angle), np.sin(0.5 * self.half_angle)
        x, y = s * np.cos(self.rate * times), s * np.sin(self.rate * times)
        zero, rest = np.zeros(len(times)), np.zeros((len(times), 3))
        q = np.stack([np.full(len(times), c), x, y, zero], axis=1)
        dq = self.rate * np.stack([zero, -y, x, zero], axis=1)
        ddq = -(self.rate**2) * np.stack([zero, x, y, zero], axis=1)
        return Motion(times, rest, rest, rest, *quaternion_motion(q, dq, ddq), name="coning")


def coning(half_angle: float = 0.1, rate: float = 10.0) -> Coning:
    """Coning motion at the origin: `half_angle` rad, `rate` rad/s."""
    return Coning(half_angle, rate)


def example() -> Coning:
    """Half angle 0.1 rad at 10 rad/s."""
    return coning()
