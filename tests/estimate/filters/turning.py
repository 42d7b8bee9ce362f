"""Turns a rate profile into the exact attitude and perfect readings of a body that only turns."""

import numpy as np
import numpy.typing as npt

from kreisel.data.recording import ImuRecording
from kreisel.maths.rotations import exp_so3

Array = npt.NDArray[np.float64]

GRAVITY = 9.80665
FIELD = np.array([0.0, 18.0, -44.0])  # uT in N: north and steeply down, as in central Europe


def turning(
    t: Array, gyro: Array, R_0: Array | None = None, field: Array = FIELD
) -> tuple[ImuRecording, Array]:
    """The recording and R_NS (n, 3, 3), where gyro[k] is the constant rate from t[k-1] to t[k]."""
    R = np.empty((len(t), 3, 3))
    R[0] = np.eye(3) if R_0 is None else R_0
    steps = exp_so3(gyro[1:] * np.diff(t)[:, None])
    for k in range(1, len(t)):
        R[k] = R[k - 1] @ steps[k - 1]
    up = R.transpose(0, 2, 1) @ np.array([0.0, 0.0, GRAVITY])
    return ImuRecording(t, gyro, up, mag_uT=R.transpose(0, 2, 1) @ field), R


def tumbling(t: Array, rng: np.random.Generator, rate: float = 1.5) -> Array:
    """Smooth rates (n, 3) around all axes, in rad/s, as a hand makes them."""
    frequencies, phases = rng.uniform(0.1, 0.7, (3, 3)), rng.uniform(0.0, 2.0 * np.pi, (3, 3))
    return rate * np.sin(2.0 * np.pi * frequencies * t[:, None, None] + phases).mean(axis=2)


def angles_deg(R: Array, R_true: Array) -> tuple[Array, Array, Array]:
    """Total, heading and inclination error (n,) in degrees, of R_est = Exp(dtheta_N) R_true."""
    E = R @ R_true.swapaxes(-1, -2)
    heading = np.arctan2(E[..., 1, 0] - E[..., 0, 1], E[..., 0, 0] + E[..., 1, 1])
    inclination = np.arctan2(np.hypot(E[..., 0, 2], E[..., 1, 2]), E[..., 2, 2])
    sine = np.linalg.norm(E - E.swapaxes(-1, -2), axis=(-2, -1)) / np.sqrt(8.0)
    total = np.arctan2(sine, 0.5 * (np.trace(E, axis1=-2, axis2=-1) - 1.0))
    return np.degrees(total), np.degrees(np.abs(heading)), np.degrees(inclination)
