"""What surrounds the body: gravity and the magnetic field in the navigation frame N."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import date

import numpy as np

from kreisel.data.checks import Array, finite, scalar, shaped

STANDARD_GRAVITY = 9.80665
"""m/s^2; BIPM, SI brochure, conventional value of the acceleration due to gravity."""


@dataclass(frozen=True, slots=True, eq=False)
class Environment:
    """Surroundings of the body, in N (east, north, up)."""

    g_N: Array = field(default_factory=lambda: np.array([0.0, 0.0, -STANDARD_GRAVITY]))  # (3,) m/s^2
    field_N_uT: Array | None = None  # (3,) microtesla; None where nobody asks for a magnetometer
    omega_IN_N: Array = field(default_factory=lambda: np.zeros(3))  # (3,) rad/s at which N turns; 0: inertial

    @classmethod
    def at(
        cls, latitude_deg: float, longitude_deg: float, height_m: float, day: date, *, turning: bool = False
    ) -> Environment:
        """Gravity and, by the World Magnetic Model, the magnetic field at a place on a day; the place is N's origin.

        latitude_deg, longitude_deg: geodetic, WGS 84, north and east positive. height_m: above the ellipsoid.
        turning: N turns with the Earth. Without, N is inertial and gravity, centrifugal part included, the same.
        Raises ValueError for a place that is none and a day that no magnetic model covers.
        """
        from kreisel.maths.earth import earth_rate, magnetic_field_uT, normal_gravity

        latitude = float(np.deg2rad(scalar("latitude_deg", latitude_deg, "deg", -90.0, 90.0)))
        longitude = float(np.deg2rad(scalar("longitude_deg", longitude_deg, "deg", -180.0, 360.0)))
        height = scalar("height_m", height_m, "m", -1000.0, 100_000.0)
        if not isinstance(day, date):
            raise TypeError(
                f"day must be a datetime.date, such as date(2026, 5, 1); got {type(day).__name__}."
            )
        g_N = np.array([0.0, 0.0, -normal_gravity(latitude, height)])
        omega_IN_N = earth_rate(latitude) if turning else np.zeros(3)
        return cls(g_N, magnetic_field_uT(latitude, longitude, height, day), omega_IN_N)

    @property
    def declination(self) -> float | None:
        """How far magnetic north lies east of true north, rad; None without a field or where it is vertical."""
        if self.field_N_uT is None or not self.field_N_uT[:2].any():
            return None
        return float(np.arctan2(self.field_N_uT[0], self.field_N_uT[1]))

    def __post_init__(self) -> None:
        for name in ("g_N", "omega_IN_N"):
            object.__setattr__(self, name, finite(name, shaped(name, getattr(self, name), (3,))))
        if self.field_N_uT is not None:
            field_N_uT = finite("field_N_uT", shaped("field_N_uT", self.field_N_uT, (3,)))
            object.__setattr__(self, "field_N_uT", field_N_uT)
