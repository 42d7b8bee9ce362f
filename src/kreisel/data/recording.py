"""What an IMU delivers: time stamps, rates, specific forces and, where there is one, the magnetic field."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from kreisel.data.checks import Array, increasing, per_axis, same_length, shaped
from kreisel.data.tables import Tabular

_NOISES = {"gyro_noise": "rad/s", "accel_noise": "m/s^2", "mag_noise_uT": "uT"}

SOURCE = "kreisel.read gives one; of what Imu.record made take .measured."
"""Where a recording comes from, for errors about what is none."""


@dataclass(frozen=True, slots=True, eq=False)
class ImuRecording(Tabular):
    """What an IMU delivers, in sensor axes S. A NaN row is a missing sample.

    Ideal readings of a motion that was found behind noise know how uncertain they are.
    """

    t: Array  # (n,) s after t0_ns, strictly increasing
    gyro: Array  # (n, 3) rad/s, omega_NS_S, right-handed
    accel: Array  # (n, 3) m/s^2, specific force; +g up at rest
    mag_uT: Array | None = None  # (n, 3) microtesla; NaN rows where the magnetometer has no sample
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""
    gyro_sigma: Array | None = None  # (n, 3) rad/s, standard error
    accel_sigma: Array | None = None  # (n, 3) m/s^2, standard error
    # Standard deviation of the white noise in one sample, one or per axis, (3,) once inside; None: not known.
    gyro_noise: Array | None = None  # rad/s
    accel_noise: Array | None = None  # m/s^2
    mag_noise_uT: Array | None = None  # microtesla

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "gyro", shaped("gyro", self.gyro, ("n", 3)))
        put(self, "accel", shaped("accel", self.accel, ("n", 3)))
        for name in ("mag_uT", "gyro_sigma", "accel_sigma"):
            if getattr(self, name) is not None:
                put(self, name, shaped(name, getattr(self, name), ("n", 3)))
        put(self, "t0_ns", int(self.t0_ns))
        columns = ("gyro", "accel", "mag_uT", "gyro_sigma", "accel_sigma")
        same_length(self.t, **{name: getattr(self, name) for name in columns})
        for name, unit in _NOISES.items():
            if getattr(self, name) is not None:
                put(self, name, per_axis(name, getattr(self, name), unit, 0.0))

    def __len__(self) -> int:
        return len(self.t)

    def rows(self, rows: slice) -> ImuRecording:
        """The same recording at some of its samples only."""
        columns = ("t", "gyro", "accel", "mag_uT", "gyro_sigma", "accel_sigma")
        whole: dict[str, Any] = {name: getattr(self, name) for name in columns}
        return replace(self, **{name: x[rows] for name, x in whole.items() if x is not None})
