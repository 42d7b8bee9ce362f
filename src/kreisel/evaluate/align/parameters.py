"""Turns what may differ between an IMU and its simulated twin into a vector that least squares can move, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from kreisel.data.checks import Array, choice
from kreisel.maths.rotations import exp_so3

SIZES = {
    "rotation": 3,
    "lever_arm": 3,
    "gyro_bias": 3,
    "accel_bias": 3,
    "gyro_scale": 3,
    "accel_scale": 3,
    "gyro_clock": 1,
    "accel_clock": 1,
    "drift": 1,
    "tilt": 2,
}
"""Every parameter that can be estimated and how many numbers it has."""

UNITS = {
    "rotation": "rad",
    "lever_arm": "m",
    "gyro_bias": "rad/s",
    "accel_bias": "m/s^2",
    "gyro_scale": "",
    "accel_scale": "",
    "gyro_clock": "s",
    "accel_clock": "s",
    "drift": "",
    "tilt": "rad",
}

# A parameter known no better than this, in its unit, is not known: it would spoil any use of it.
USELESS = {
    "rotation": 0.1,
    "lever_arm": 0.1,
    "gyro_bias": 0.1,
    "accel_bias": 1.0,
    "gyro_scale": 0.1,
    "accel_scale": 0.1,
    "gyro_clock": 0.05,
    "accel_clock": 0.05,
    "drift": 1e-3,
    "tilt": 0.1,
}

# Not in it: scale, for noise in the poses looks like a sensor that reads too little; drift and tilt, which
# recordings of a minute hardly show.
DEFAULT = ("rotation", "lever_arm", "gyro_bias", "accel_bias", "gyro_clock", "accel_clock")

# What only a moving body shows.
NEED_MOTION = frozenset(SIZES) - {"gyro_bias", "accel_bias"}


@dataclass(frozen=True, slots=True, eq=False)
class Parameters:
    """Everything that stands between a trajectory and the readings of an IMU on it."""

    R_BS: Array = field(default_factory=lambda: np.eye(3))  # (3, 3)
    lever_arm: Array = field(default_factory=lambda: np.zeros(3))  # (3,) m, p_BS
    gyro_bias: Array = field(default_factory=lambda: np.zeros(3))  # (3,) rad/s
    accel_bias: Array = field(default_factory=lambda: np.zeros(3))  # (3,) m/s^2
    gyro_scale: Array = field(default_factory=lambda: np.ones(3))  # (3,)
    accel_scale: Array = field(default_factory=lambda: np.ones(3))  # (3,)
    gyro_clock: Array = field(default_factory=lambda: np.zeros(1))  # (1,) s, by which stamps are ahead
    accel_clock: Array = field(default_factory=lambda: np.zeros(1))  # (1,) s
    drift: Array = field(default_factory=lambda: np.zeros(1))  # (1,) by which the IMU's clock runs fast
    tilt: Array = field(default_factory=lambda: np.zeros(2))  # (2,) rad about x and y of N, of true up

    def moved(self, slots: Mapping[str, slice], step: Array) -> Parameters:
        """The parameters in `slots` moved by their parts of `step`; the rotation by Exp on its right."""
        changes = {name: getattr(self, name) + step[s] for name, s in slots.items() if name != "rotation"}
        if "rotation" in slots:
            changes["R_BS"] = self.R_BS @ exp_so3(step[slots["rotation"]])
        return replace(self, **changes)


def slots_of(names: Sequence[str]) -> dict[str, slice]:
    """Where each named parameter stands in the vector, in a fixed order; ValueError for a name that is none."""
    asked = {choice("estimate", name, tuple(SIZES)) for name in names}
    slots, at = {}, 0
    for name, size in SIZES.items():
        if name in asked:
            slots[name] = slice(at, at + size)
            at += size
    return slots


def useless(slots: Mapping[str, slice]) -> Array:
    """`USELESS` for each number of the vector."""
    return np.concatenate([np.zeros(0), *(np.full(SIZES[name], USELESS[name]) for name in slots)])
