"""What an IMU delivers: time stamps, rates, specific forces and, where there is one, the magnetic field."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from kreisel.data.checks import Array, increasing, same_length, shaped

SOURCE = "kreisel.read gives one; of what Imu.record made take .measured."
"""Where a recording comes from, for errors about what is none."""


@dataclass(frozen=True, slots=True, eq=False)
class ImuRecording:
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

    def __len__(self) -> int:
        return len(self.t)

    def rows(self, rows: slice) -> ImuRecording:
        """The same recording at some of its samples only."""
        columns = ("t", "gyro", "accel", "mag_uT", "gyro_sigma", "accel_sigma")
        whole: dict[str, Any] = {name: getattr(self, name) for name in columns}
        return replace(self, **{name: x[rows] for name, x in whole.items() if x is not None})
