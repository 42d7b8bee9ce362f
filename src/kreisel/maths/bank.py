"""Turns the attitude of a body without roll into that of one that banks into its turns."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.tangent import Attitude

Array = npt.NDArray[np.float64]


def banked(attitude: Attitude, force: Array) -> Attitude:
    """`attitude` rolled about its x axis until the specific force has no component along y, and points to +z.

    force: (3, n, 3) m/s^2, m/s^3, m/s^4 in N: specific force a - g and two derivatives.
    In a steady level turn tan(roll) = v^2 / (g r): the turn is co-ordinated, a ball in a dish stays in its middle.
    Where a body falls freely no roll is better than another; it is 0 there.
    """
    R, omega, alpha = attitude
    f, df, ddf = (np.einsum("nji,nj->ni", R, derivative) for derivative in force)
    # Seen from the turning body: d/dt (R^T f) = R^T f' - omega x R^T f.
    once = df - np.cross(omega, f)
    twice = ddf - 2.0 * np.cross(omega, df) + np.cross(omega, np.cross(omega, f)) - np.cross(alpha, f)
    return rolled(attitude, *_roll(f, once, twice))


def _roll(f: Array, df: Array, ddf: Array) -> tuple[Array, Array, Array]:
    """phi = atan2(-f_y, f_z) (n,) and two derivatives."""
    y, z = f[:, 1], f[:, 2]
    squared = y * y + z * z
    safe = np.where(squared > 0.0, squared, np.inf)
    rate = (y * df[:, 2] - z * df[:, 1]) / safe
    change = (y * ddf[:, 2] - z * ddf[:, 1]) / safe - 2.0 * rate * (y * df[:, 1] + z * df[:, 2]) / safe
    return np.arctan2(-y, z), rate, change


def rolled(attitude: Attitude, phi: Array, dphi: Array, ddphi: Array) -> Attitude:
    """`attitude` turned about its own x axis by phi (n,) rad, with the rates that this adds."""
    c, s = np.cos(phi), np.sin(phi)
    R, omega, alpha = (part.copy() for part in attitude)
    R[:, :, 1] = c[:, None] * attitude.R_NB[:, :, 1] + s[:, None] * attitude.R_NB[:, :, 2]
    R[:, :, 2] = c[:, None] * attitude.R_NB[:, :, 2] - s[:, None] * attitude.R_NB[:, :, 1]
    for turned, vector in ((omega, attitude.omega_NB_B), (alpha, attitude.alpha_NB_B)):
        turned[:, 1] = c * vector[:, 1] + s * vector[:, 2]
        turned[:, 2] = c * vector[:, 2] - s * vector[:, 1]
    # The rolled axes see the old rate turn backwards: - phi' e_x x omega.
    alpha[:, 1] += dphi * omega[:, 2]
    alpha[:, 2] -= dphi * omega[:, 1]
    omega[:, 0] += dphi
    alpha[:, 0] += ddphi
    return Attitude(R, omega, alpha)
