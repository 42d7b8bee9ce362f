"""Turns the motion of a body into what an IMU mounted on it reads."""

from __future__ import annotations

from dataclasses import dataclass, field

from kreisel.data.checks import instance
from kreisel.data.environment import Environment
from kreisel.data.motion import Motion, Mount
from kreisel.data.recording import ImuRecording
from kreisel.maths.kinematics import specific_force


@dataclass(frozen=True, slots=True)
class Imu:
    """An inertial measurement unit at a place on the body."""

    mount: Mount = field(default_factory=Mount)
    environment: Environment = field(default_factory=Environment)

    def __post_init__(self) -> None:
        instance("mount", self.mount, Mount, "Write Mount(p_BS=[x, y, z]).")
        instance("environment", self.environment, Environment, "Write Environment(...).")

    def ideal(self, motion: Motion) -> ImuRecording:
        """What a perfect IMU at the mount reads at the times of `motion`; with a field around it, a magnetometer too.

        Source: document 000, eq. (9), with the specific force R_SN (a_N - g_N) for its a_S.
        """
        instance("motion", motion, Motion, "A trajectory's sample(t) gives one.")
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
