"""Makes a trial whose truth is known: a sensor that lies askew, then turns about all axes in a clean field."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kreisel.data.attitude import Reference
from kreisel.data.environment import Environment
from kreisel.data.trial import Trial
from kreisel.maths.rotations import quat_wxyz_from_matrix
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory

RATE_HZ = 100.0
FIELD_N_UT = np.array([0.0, 20.0, -43.0])  # magnetic north along y: central Europe


def _still(t):
    return 0.0 * t


def _begun(t):
    """Seconds since the sensor began to turn: smooth, nothing before 2 s."""
    return np.where(t > 2.0, (t - 2.0) ** 3 / (1.0 + (t - 2.0) ** 2), 0.0 * t)


ANGLES = (
    lambda t: 0.4 + 0.7 * np.sin(0.9 * _begun(t)),
    lambda t: -0.3 + 0.5 * np.sin(0.7 * _begun(t)),
    lambda t: 1.9 + 0.5 * _begun(t),
)


def turning_trial(seconds: float = 15.0, name: str = "01_turning") -> Trial:
    """Noise-free readings; the samples of the motion count."""
    motion = FunctionTrajectory([_still] * 3, ANGLES).sample(np.arange(int(seconds * RATE_HZ)) / RATE_HZ)
    recording = Imu(environment=Environment(field_N_uT=FIELD_N_UT)).ideal(motion)
    return Trial(recording, Reference(motion.t, motion.R_NB, motion.t >= 2.0), name)


def write_broad(path: Path, trial: Trial) -> None:
    """`trial` as the benchmark's own files have it."""
    from scipy.io import savemat

    imu, reference = trial.recording, trial.reference
    variables = {"imu_gyr": imu.gyro, "imu_acc": imu.accel, "imu_mag": imu.mag_uT}
    variables |= {"opt_quat": quat_wxyz_from_matrix(reference.R_NS), "movement": reference.counts}
    savemat(path, variables | {"sampling_rate": RATE_HZ})
