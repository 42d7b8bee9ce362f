"""Turns readings and what was expected of them into the part of the motion that both show.

Least squares takes what it differentiates for the truth. Where a body never turns about an axis, noisy poses still
give it rates about it, and through these lever arms and turns of the sensor that are none; so derivatives are taken
of the confirmed part of the motion alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kreisel.data.checks import Array

# Share of a component's power that must be motion; of less, half and more would be noise of the trajectory.
_MOTION = 0.5

# RMS, rad/s and m/s^2: too little to tell anything by.
_TINY = {"gyro": 1e-3, "accel": 1e-2}


class Confirmed(NamedTuple):
    """Projectors (3, 3) in B, to be applied from the right to rows."""

    rate: Array
    force: Array
    change: Array  # of the force: about its mean

    @property
    def rank(self) -> tuple[int, ...]:
        """How many directions each of them leaves."""
        return tuple(round(float(np.trace(projector))) for projector in self)


ALL = Confirmed(np.eye(3), np.eye(3), np.eye(3))


def confirmed(read: Mapping[str, Array], seen: Mapping[str, Array]) -> Confirmed:
    """What `read` and `seen` have in common: rates ("gyro") and forces ("accel") (n, 3) in B."""
    force, expected = read["accel"], seen["accel"]
    tiny = _TINY["accel"]
    return Confirmed(
        rate=_common(read["gyro"], seen["gyro"], _TINY["gyro"]),
        force=_common(force, expected, tiny),
        change=_common(force - force.mean(axis=0), expected - expected.mean(axis=0), tiny),
    )


def _common(read: Array, seen: Array, tiny: float) -> Array:
    """Projector onto those principal axes of `seen` along which `read` varies with it.

    Their errors are independent: the mean of read times seen holds the motion alone, that of seen times seen the
    motion and the errors of the trajectory. The ratio of the two is 1 where there is motion and 0 where there are
    errors only.
    """
    values, axes = np.linalg.eigh(seen.T @ seen / len(seen))
    common = np.mean((read @ axes) * (seen @ axes), axis=0)
    kept = axes[:, common > _MOTION * (values + tiny**2)]
    return np.asarray(kept @ kept.T)
