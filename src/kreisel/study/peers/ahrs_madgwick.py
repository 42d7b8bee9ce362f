"""Turns readings into attitude by Madgwick's gradient descent as the package ahrs has it.

Its quaternions take the sensor to an earth of north, west, up.
"""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.rotations import matrix_from_quat_wxyz

PACKAGE = "ahrs"
SETTINGS = "ahrs.filters.Madgwick, defaults (gain 0.041)"

# East is minus west.
_ENU_FROM_NWU = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def estimate(gyro: Array, accel: Array, mag_uT: Array, step: float) -> Array:
    """R_NS (n, 3, 3)."""
    from ahrs.filters import Madgwick

    filter = Madgwick(gyr=gyro, acc=accel, mag=mag_uT, Dt=step)
    return np.asarray(_ENU_FROM_NWU @ matrix_from_quat_wxyz(filter.Q))
