"""Turns readings into attitude by VQF, with magnetometer, in real time: Laidig and Seel 2023.

Its earth is east, north, up and its quaternions take the sensor there: as ours.
"""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.rotations import matrix_from_quat_wxyz

PACKAGE = "vqf"
SETTINGS = "vqf.VQF, 9D, defaults"


def estimate(gyro: Array, accel: Array, mag_uT: Array, step: float) -> Array:
    """R_NS (n, 3, 3)."""
    from vqf import VQF

    # Copies: the C++ behind it asks for arrays that may be written to.
    answer = VQF(step).updateBatch(np.array(gyro), np.array(accel), np.array(mag_uT))
    return matrix_from_quat_wxyz(answer["quat9D"])
