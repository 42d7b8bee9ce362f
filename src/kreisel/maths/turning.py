"""Turns motion in a frame that rotates steadily into what sensors feel of it and into axes that stand still, and back.

N turns at omega_IN_N against inertial axes I, as a place on the Earth does. The origin of N moves with it, and what
holds it there, the centrifugal part of gravity at the origin, is inside g_N, as it is inside every plumb line. With
the mass attraction the same all along the path, a body at p, v, a in N has

    f = R_SN (a + 2 omega x v + omega x (omega x p) - g_N),    gyro = omega_NS_S + R_SN omega.

Of the centrifugal term only what differs from the origin is left: counting it whole would count it twice.
Source: Groves 2013, eq. 5.36 (velocity in Earth axes) with 2.133 (gravity is attraction plus centrifugal).

A rate of zero leaves everything untouched, to the bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.magnus import GAUSS, increments
from kreisel.maths.rotations import exp_so3

Array = npt.NDArray[np.float64]


class State(NamedTuple):
    """Place, velocity and attitude of S, in N or in I, by the letter X."""

    p_XS: Array  # (..., 3) m
    v_XS: Array  # (..., 3) m/s
    R_XS: Array  # (..., 3, 3)


def felt_rate(omega_NS_S: Array, R_NS: Array, omega_IN_N: Array) -> Array:
    """omega_IS_S (n, 3), what a gyroscope measures where S turns in N at omega_NS_S (n, 3)."""
    return omega_NS_S + omega_IN_N @ R_NS if omega_IN_N.any() else omega_NS_S


def felt_acceleration(a_NS: Array, v_NS: Array, p_NS: Array, omega_IN_N: Array) -> Array:
    """a_NS (n, 3) with the Coriolis and the centrifugal term: in N, against inertial axes at its origin."""
    return a_NS + _of_the_frame(v_NS, p_NS, omega_IN_N) if omega_IN_N.any() else a_NS


def rates_in_N(omega_IS_S: Array, alpha_IS_S: Array, R_NS: Array, omega_IN_N: Array) -> tuple[Array, Array]:
    """omega_NS_S and alpha_NS_S (n, 3) where a gyroscope measures omega_IS_S with the slope alpha_IS_S."""
    if not omega_IN_N.any():
        return omega_IS_S, alpha_IS_S
    frame = omega_IN_N @ R_NS
    omega_NS_S = omega_IS_S - frame
    return omega_NS_S, alpha_IS_S + np.cross(omega_NS_S, frame)


def acceleration_in_N(felt: Array, v_NS: Array, p_NS: Array, omega_IN_N: Array) -> Array:
    """a_NS (n, 3) of what `felt_acceleration` gives."""
    return felt - _of_the_frame(v_NS, p_NS, omega_IN_N) if omega_IN_N.any() else felt


def _of_the_frame(v_NS: Array, p_NS: Array, omega_IN_N: Array) -> Array:
    return np.asarray(np.cross(omega_IN_N, 2.0 * v_NS + np.cross(omega_IN_N, p_NS)))


def standing_still(t: Array, state: State, omega_IN_N: Array) -> State:
    """A state in N at t (n,) s in the axes that stand still where N is at t[0]; both have the origin of N."""
    if not omega_IN_N.any():
        return state
    R_IN = _turn(t, omega_IN_N)
    velocity = state.v_XS + np.cross(omega_IN_N, state.p_XS)
    return State(_turned(R_IN, state.p_XS), _turned(R_IN, velocity), R_IN @ state.R_XS)


def turning_along(t: Array, state: State, omega_IN_N: Array) -> State:
    """The way back: a state in those axes in N."""
    if not omega_IN_N.any():
        return state
    R_NI = np.swapaxes(_turn(t, omega_IN_N), -1, -2)
    p = _turned(R_NI, state.p_XS)
    return State(p, _turned(R_NI, state.v_XS) - np.cross(omega_IN_N, p), R_NI @ state.R_XS)


def falls(t: Array, g_N: Array, omega_IN_N: Array) -> tuple[Array, Array]:
    """Velocity and place, each (n - 1, 3), that gravity adds between t (n,) s, in those axes, where it turns."""
    step = np.diff(t)[:, None]
    if not omega_IN_N.any():
        return step * g_N, 0.5 * step * step * g_N
    steady = np.broadcast_to(np.concatenate([omega_IN_N, g_N]), (len(step), len(GAUSS), 6))
    # A steady push in axes that turn steadily, as a sensor's: one exponential, exact at any step.
    _, dv, dp = increments(step[:, 0], steady)
    R_IN = _turn(t, omega_IN_N)[:-1]
    return _turned(R_IN, dv), _turned(R_IN, dp)


def _turn(t: Array, omega_IN_N: Array) -> Array:
    """R_IN (n, 3, 3)."""
    return exp_so3((t - t[:1])[:, None] * omega_IN_N)


def _turned(R: Array, v: Array) -> Array:
    return np.asarray(np.einsum("nij,nj->ni", R, v))
