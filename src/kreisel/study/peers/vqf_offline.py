"""Turns readings into attitude by VQF's offline variant, which also looks ahead: Laidig and Seel 2023.

Its earth is east, north, up and its quaternions take the sensor there: as ours.
"""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.rotations import matrix_from_quat_wxyz

PACKAGE = "vqf"
SETTINGS = "vqf.offlineVQF, 9D, defaults; sees the future"


def estimate(gyro: Array, accel: Array, mag_uT: Array, step: float) -> Array:
    """R_NS (n, 3, 3)."""
    from vqf import offlineVQF

    # Copies: the C++ behind it asks for arrays that may be written to.
    answer = offlineVQF(np.array(gyro), np.array(accel), np.array(mag_uT), step)
    return matrix_from_quat_wxyz(answer["quat9D"])
