"""Turns data in other worlds (NED/FRD, NWU, ROS, MATLAB) into ours, ENU/FLU, and back, by name.

A world is a pair of axes, one for N and one for B and S, and the sign of its accelerometer. All of them
differ by swapped and mirrored axes only, so that going there and back gives the same bits. A quaternion
q_NB in any of these worlds describes the matrix R_NB of that world, and so do its Euler angles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.checks import Array, choice
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.data.tables import CONSTANTS
from kreisel.data.trajectory import Poses

Data = TypeVar(
    "Data", bound=Poses | Motion | ImuRecording | ImuIncrements | AttitudeHistory | Reference | Mount
)


@dataclass(frozen=True, slots=True)
class Axes:
    """Our component k is `sign[k]` times their component `order[k]`."""

    order: tuple[int, int, int] = (0, 1, 2)
    sign: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def to_ours(self, v: Array, axis: int = -1) -> Array:
        """Components in our axes of vectors whose components in theirs lie along `axis`."""
        moved = np.moveaxis(v, axis, -1)[..., self.order] * np.array(self.sign)
        return np.ascontiguousarray(np.moveaxis(moved, -1, axis))

    def to_theirs(self, v: Array, axis: int = -1) -> Array:
        """The way back, to the bit."""
        moved = np.moveaxis(v, axis, -1) * np.array(self.sign)
        return np.ascontiguousarray(np.moveaxis(moved[..., np.argsort(self.order)], -1, axis))


@dataclass(frozen=True, slots=True)
class World:
    """How others lay their axes and sign their accelerometer."""

    text: str  # one line for help and docs
    nav: Axes = Axes()  # N
    body: Axes = Axes()  # B, and S of a sensor that is not turned against it
    accel_sign: float = 1.0  # of the accelerometer against specific force


_NED = Axes((1, 0, 2), (1.0, 1.0, -1.0))
_FRD = Axes(sign=(1.0, -1.0, -1.0))

WORLDS = MappingProxyType(
    {
        "enu-flu": World(
            "ours: N east, north, up; B forward, left, up; at rest the accelerometer reads +g up"
        ),
        "ned-frd": World(
            "aerospace: N north, east, down; B forward, right, down; at rest (0, 0, -g)", _NED, _FRD
        ),
        "nwu": World("N north, west, up; B forward, left, up", Axes((1, 0, 2), (-1.0, 1.0, 1.0))),
        # REP-103 lays ENU and FLU, REP-145 has the accelerometer read +g up at rest: nothing to turn.
        "ros": World("REP-103 and REP-145: the same axes and signs as ours"),
        # imuSensor forms g - a, the negative of specific force: at rest it reads (0, 0, +9.81) on z down.
        # Its quaternions rotate frames: rotateframe(q, v) = conj(q) v q takes v_N to v_B, so q is q_NB.
        # Source: MathWorks documentation of imuSensor, linaccel and rotateframe.
        "matlab": World("MATLAB's toolboxes: NED and FRD with g - a as the accelerometer", _NED, _FRD, -1.0),
    }
)
"""The worlds by the names `--frame` takes."""


def to_enu_flu(data: Data, world: str) -> Data:
    """`data` of another world in ours; ValueError with the nearest name where there is no such world."""
    other = WORLDS[choice("world", world, tuple(WORLDS))]
    return _turned(data, other.nav.to_ours, other.body.to_ours, other.accel_sign)


def from_enu_flu(data: Data, world: str) -> Data:
    """`data` of ours in another world. Its fields keep their names: R_NB then maps FRD to NED, say."""
    other = WORLDS[choice("world", world, tuple(WORLDS))]
    return _turned(data, other.nav.to_theirs, other.body.to_theirs, other.accel_sign)


def _turned(
    data: Data, nav: Callable[[Array, int], Array], body: Callable[[Array, int], Array], accel_sign: float
) -> Data:
    if isinstance(data, ImuRecording):
        mag_uT = None if data.mag_uT is None else body(data.mag_uT, -1)
        accel = body(data.accel, -1) * accel_sign
        sigmas = _sizes(data, dict.fromkeys(("gyro_sigma", "accel_sigma", *CONSTANTS), body))
        return replace(data, gyro=body(data.gyro, -1), accel=accel, mag_uT=mag_uT, **sigmas)
    if isinstance(data, ImuIncrements):
        dp = None if data.dp is None else body(data.dp, -1) * accel_sign
        return replace(data, dtheta=body(data.dtheta, -1), dv=body(data.dv, -1) * accel_sign, dp=dp)
    if isinstance(data, Motion):
        return replace(
            data,
            p_NB=nav(data.p_NB, -1),
            v_NB=nav(data.v_NB, -1),
            a_NB=nav(data.a_NB, -1),
            R_NB=body(nav(data.R_NB, -2), -1),
            omega_NB_B=body(data.omega_NB_B, -1),
            alpha_NB_B=body(data.alpha_NB_B, -1),
            **_sizes(data, {"theta_sigma": body, "a_sigma": nav, "omega_sigma": body, "alpha_sigma": body}),
        )
    if isinstance(data, Mount):
        return replace(data, p_BS=body(data.p_BS, -1), R_BS=body(body(data.R_BS, -2), -1))
    if isinstance(data, Reference):
        return replace(data, R_NS=body(nav(data.R_NS, -2), -1))
    if isinstance(data, AttitudeHistory):
        return replace(data, **_attitude_fields(data, nav, body))
    R_NB = None if data.R_NB is None else body(nav(data.R_NB, -2), -1)
    v_NB = None if data.v_NB is None else nav(data.v_NB, -1)
    return replace(data, p_NB=nav(data.p_NB, -1), R_NB=R_NB, v_NB=v_NB)


def _attitude_fields(
    data: AttitudeHistory, nav: Callable[[Array, int], Array], body: Callable[[Array, int], Array]
) -> dict[str, Any]:
    return {
        "R_NS": body(nav(data.R_NS, -2), -1),
        "gyro_bias": None if data.gyro_bias is None else body(data.gyro_bias, -1),
        "a_N": None if data.a_N is None else nav(data.a_N, -1),
        **_sizes(data, {"sigma": nav}),
    }


def _sizes(data: Any, turns: dict[str, Callable[[Array, int], Array]]) -> dict[str, Any]:
    """Standard deviations, which have an axis but no sign."""
    known = {name: getattr(data, name) for name in turns}
    return {name: None if x is None else np.abs(turns[name](x, -1)) for name, x in known.items()}
