"""Turns readings into attitude by x-io's Fusion, the revised filter of Madgwick's thesis of 2010, chapter 7.

It takes deg/s and g. Its quaternions take the sensor to an earth that can be chosen: east, north, up.
"""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.maths.rotations import matrix_from_quat_wxyz

PACKAGE = "imufusion"
SETTINGS = "imufusion.Ahrs, defaults (gain 0.5, no rejection)"


def estimate(gyro: Array, accel: Array, mag_uT: Array, step: float) -> Array:
    """R_NS (n, 3, 3)."""
    import imufusion

    settings = imufusion.AhrsSettings()
    settings.sample_rate = 1.0 / step
    settings.convention = imufusion.CONVENTION_ENU
    filter = imufusion.Ahrs()
    filter.set_settings(settings)
    quat_wxyz = np.empty((len(gyro), 4))
    for k, sample in enumerate(zip(np.rad2deg(gyro), accel / STANDARD_GRAVITY, mag_uT, strict=True)):
        filter.update(*sample)
        quat_wxyz[k] = filter.get_quaternion()
    # Its single precision leaves them 1e-6 off unit length.
    return matrix_from_quat_wxyz(quat_wxyz / np.linalg.norm(quat_wxyz, axis=1, keepdims=True))
