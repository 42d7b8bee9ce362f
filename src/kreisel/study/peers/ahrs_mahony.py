"""Turns readings into attitude by Mahony's complementary filter as the package ahrs has it.

Its quaternions take the sensor to an earth of east, north, up: as ours.
"""

from __future__ import annotations

from kreisel.data.checks import Array
from kreisel.maths.rotations import matrix_from_quat_wxyz

PACKAGE = "ahrs"
SETTINGS = "ahrs.filters.Mahony, defaults (k_P 1, k_I 0.3)"


def estimate(gyro: Array, accel: Array, mag_uT: Array, step: float) -> Array:
    """R_NS (n, 3, 3)."""
    from ahrs.filters import Mahony

    filter = Mahony(gyr=gyro, acc=accel, mag=mag_uT, Dt=step)
    return matrix_from_quat_wxyz(filter.Q)
