"""Turns the motion of a body into what an IMU mounted on it reads."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.maths.kinematics import specific_force
from kreisel.maths.rotations import log_so3


@dataclass(frozen=True, slots=True)
class Imu:
    """An inertial measurement unit at a place on the body."""

    mount: Mount = field(default_factory=Mount)
    environment: Environment = field(default_factory=Environment)

    def ideal(self, motion: Motion) -> ImuRecording:
        """What a perfect IMU at the mount reads at the times of `motion`; with a field around it, a magnetometer too.

        Source: document 000, eq. (9), with the specific force R_SN (a_N - g_N) for its a_S.
        """
        at_sensor = motion.at(self.mount)
        field_N_uT = self.environment.field_N_uT
        return ImuRecording(
            t=motion.t,
            gyro=at_sensor.omega_NB_B,
            accel=specific_force(at_sensor.a_NB, at_sensor.R_NB, self.environment.g_N),
            # R_SN field, row by row.
            mag_uT=None if field_N_uT is None else field_N_uT @ at_sensor.R_NB,
            t0_ns=motion.t0_ns,
            name=self.mount.name,
        )

    def increments(self, motion: Motion) -> ImuIncrements:
        """What a perfect IMU at the mount adds up between the times of `motion`: coning and sculling are in it.

        From attitude, velocity and position at both ends of each interval, not from rates: as exact as these.
        """
        at_sensor = motion.at(self.mount)
        step, g_N = np.diff(motion.t)[:, None], self.environment.g_N
        p, v, R = at_sensor.p_NB, at_sensor.v_NB, at_sensor.R_NB
        v_gain = np.diff(v, axis=0) - step * g_N
        p_gain = np.diff(p, axis=0) - step * v[:-1] - 0.5 * step * step * g_N
        R_back = np.swapaxes(R[:-1], -1, -2)
        return ImuIncrements(
            t=motion.t,
            dtheta=log_so3(R_back @ R[1:]),
            dv=np.einsum("nij,nj->ni", R_back, v_gain),
            dp=np.einsum("nij,nj->ni", R_back, p_gain),
            t0_ns=motion.t0_ns,
            name=self.mount.name,
        )
