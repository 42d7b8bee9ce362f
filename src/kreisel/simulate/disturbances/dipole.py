"""Turns the moment of a magnet or a piece of iron and its place into the field around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kreisel.data.checks import Array, vector

# mu_0 / 4 pi in uT m^3 / (A m^2), to 6e-10 (CODATA 2018).
_STRENGTH = 0.1

# uT; no magnet has more at its surface. The dipole's formula ends where it gives more: there the magnet begins.
_STRONGEST = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class Dipole:
    """A magnetic dipole at rest in N: a loudspeaker has about 1 A m^2, a car 100 and more.

    p_ND: (3,) m in N, its place. moment_N: (3,) A m^2 in N, from its south to its north pole.
    Its field falls with the third power of the distance: 1 A m^2 gives 0.2 uT on its axis at 1 m, 25 uT at 0.2 m.
    Source: Jackson, Classical Electrodynamics, 3rd ed., eq. 5.56.
    """

    p_ND: Sequence[float]
    moment_N: Sequence[float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "p_ND", vector("p_ND", self.p_ND, "m in N"))
        object.__setattr__(self, "moment_N", vector("moment_N", self.moment_N, "A m^2 in N"))

    @property
    def span(self) -> tuple[float, float]:
        """It is always there."""
        return -np.inf, np.inf

    def added_N_uT(self, t: Array, p_NS: Array) -> Array:
        """(n, 3) microtesla in N at times t (n,) s and places p_NS (n, 3) m.

        Raises ValueError, with place and time, for a sensor that runs into the magnet.
        """
        moment = np.asarray(self.moment_N)
        if not moment.any():
            return np.zeros_like(p_NS)
        away = p_NS - np.asarray(self.p_ND)
        distance = np.linalg.norm(away, axis=1)
        self._check_clear(t, p_NS, distance)
        direction = away / distance[:, None]
        along = (direction @ moment)[:, None] * direction
        return np.asarray(_STRENGTH * (3.0 * along - moment) / distance[:, None] ** 3)

    def _check_clear(self, t: Array, p_NS: Array, distance: Array) -> None:
        moment = float(np.linalg.norm(self.moment_N))
        clear = (2.0 * _STRENGTH * moment / _STRONGEST) ** (1.0 / 3.0)
        if len(t) and distance.min() < clear:
            k = int(np.argmin(distance))
            raise ValueError(
                f"p_ND {np.asarray(self.p_ND).tolist()} m is on the path: at t = {t[k]:.6g} s the sensor is at "
                f"{np.round(p_NS[k], 6).tolist()} m, {distance[k]:.3g} m away, inside any magnet of {moment:.4g} "
                f"A m^2. Place the dipole {clear:.2g} m or more from the path."
            )


DISTURBANCE = Dipole


def example() -> Dipole:
    """A loudspeaker a metre to the north."""
    return Dipole(p_ND=(0.0, 1.0, 0.0), moment_N=(1.0, 0.0, -0.5))
