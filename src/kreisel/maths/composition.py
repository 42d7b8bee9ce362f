"""Turns a curve, and a clock that says how far along it a body is, into the motion of that body in time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.tangent import Attitude

Array = npt.NDArray[np.float64]


def composed(curve: Array, clock: Array) -> Array:
    """Derivatives (k, n, 3) in time of curve(clock(t)), k = 3 to 5: position, velocity, acceleration ...

    curve: (k, n, 3), its derivatives by the clock's reading u; clock: (k, n), u and its derivatives in time.
    Source: Faa di Bruno's formula, written out.
    """
    du, ddu = clock[1, :, None], clock[2, :, None]
    out = [curve[0], curve[1] * du, curve[2] * du**2 + curve[1] * ddu]
    if len(curve) > 3:
        dddu = clock[3, :, None]
        out.append(curve[3] * du**3 + 3.0 * curve[2] * du * ddu + curve[1] * dddu)
    if len(curve) > 4:
        bends = curve[2] * (3.0 * ddu**2 + 4.0 * du * dddu)
        out.append(curve[4] * du**4 + 6.0 * curve[3] * du**2 * ddu + bends + curve[1] * clock[4, :, None])
    return np.stack(out)


def turned_by(attitude: Attitude, clock: Array) -> Attitude:
    """Attitude of rates in time from one of rates by the clock's reading; clock: (3 or more, n), as above."""
    du, ddu = clock[1, :, None], clock[2, :, None]
    return Attitude(
        attitude.R_NB,
        attitude.omega_NB_B * du,
        attitude.alpha_NB_B * du**2 + attitude.omega_NB_B * ddu,
    )
