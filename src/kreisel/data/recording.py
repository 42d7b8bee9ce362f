"""What an IMU delivers: time stamps, rates, specific forces and, where there is one, the magnetic field."""

from __future__ import annotations

from dataclasses import dataclass

from kreisel.data.checks import Array, increasing, per_axis, same_length, shaped
from kreisel.data.tables import Tabular

_SIGMAS = {"gyro_sigma": "rad/s", "accel_sigma": "m/s^2", "mag_sigma_uT": "uT"}


@dataclass(frozen=True, slots=True, eq=False)
class ImuRecording(Tabular):
    """What an IMU delivers, in sensor axes S. A NaN row is a missing sample."""

    t: Array  # (n,) s after t0_ns, strictly increasing
    gyro: Array  # (n, 3) rad/s, omega_NS_S, right-handed
    accel: Array  # (n, 3) m/s^2, specific force; +g up at rest
    mag_uT: Array | None = None  # (n, 3) microtesla; NaN rows where the magnetometer has no sample
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""
    # Standard deviation of the white noise in one sample, one or per axis, (3,) once inside; None: not known.
    gyro_sigma: Array | None = None  # rad/s
    accel_sigma: Array | None = None  # m/s^2
    mag_sigma_uT: Array | None = None  # microtesla

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "gyro", shaped("gyro", self.gyro, ("n", 3)))
        put(self, "accel", shaped("accel", self.accel, ("n", 3)))
        if self.mag_uT is not None:
            put(self, "mag_uT", shaped("mag_uT", self.mag_uT, ("n", 3)))
        put(self, "t0_ns", int(self.t0_ns))
        for name, unit in _SIGMAS.items():
            if getattr(self, name) is not None:
                put(self, name, per_axis(name, getattr(self, name), unit, 0.0))
        same_length(self.t, gyro=self.gyro, accel=self.accel, mag_uT=self.mag_uT)

    def __len__(self) -> int:
        return len(self.t)
