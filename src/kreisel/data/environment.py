"""What surrounds the body: gravity, the magnetic field and what disturbs it, and the rate at which N turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import date
from typing import Protocol, runtime_checkable

import numpy as np

from kreisel.data.cards import Shown
from kreisel.data.checks import Array, finite, instance, scalar, shaped

STANDARD_GRAVITY = 9.80665
"""m/s^2; BIPM, SI brochure, conventional value of the acceleration due to gravity."""

# uT, strength of the field anywhere on the Earth with some room; and what other units are in microtesla.
_EARTHS_FIELD = (18.0, 75.0)
_OTHER_UNITS = {"tesla": 1e6, "millitesla": 1e3, "gauss": 1e2, "nanotesla": 1e-3}


@runtime_checkable
class Disturbance(Protocol):
    """Something in the world that changes the magnetic field along a path; a frozen value."""

    @property
    def span(self) -> tuple[float, float]:
        """First and last time at which it acts, s; infinite where it always did or will."""
        ...

    def added_N_uT(self, t: Array, p_NS: Array) -> Array:
        """Field (n, 3), microtesla in N, that it adds at times t (n,) s and places p_NS (n, 3) m.

        Raises ValueError, with time and place, where a sensor cannot be.
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Environment(Shown):
    """Surroundings of the body, in N (east, north, up)."""

    g_N: Array = field(default_factory=lambda: np.array([0.0, 0.0, -STANDARD_GRAVITY]))  # (3,) m/s^2
    field_N_uT: Array | None = None  # (3,) microtesla; None where nobody asks for a magnetometer
    omega_IN_N: Array = field(default_factory=lambda: np.zeros(3))  # (3,) rad/s at which N turns; 0: inertial
    disturbances: Sequence[Disturbance] = ()  # of the magnetic field; field_N_uT is the field without them

    @classmethod
    def at(
        cls,
        latitude_deg: float,
        longitude_deg: float,
        height_m: float,
        day: date | None = None,
        *,
        turning: bool = False,
    ) -> Environment:
        """Gravity at a place and, by the World Magnetic Model, the magnetic field there on a day.

        The place is the origin of N. latitude_deg, longitude_deg: geodetic, WGS 84, north and east positive.
        height_m: above the ellipsoid. day: None for no magnetic field.
        turning: N turns with the Earth. Without, N is inertial; gravity is the same, its centrifugal part included.
        Raises ValueError for a place that is none and a day that no magnetic model covers.
        """
        from kreisel.maths.earth import earth_rate, magnetic_field_uT, normal_gravity

        latitude = float(np.deg2rad(scalar("latitude_deg", latitude_deg, "deg", -90.0, 90.0)))
        longitude = float(np.deg2rad(scalar("longitude_deg", longitude_deg, "deg", -180.0, 360.0)))
        height = scalar("height_m", height_m, "m", -1000.0, 100_000.0)
        if day is not None:
            instance("day", day, date, "Write date(2026, 5, 1).")
            day = date(day.year, day.month, day.day)  # of a datetime, too
        field_N_uT = None if day is None else magnetic_field_uT(latitude, longitude, height, day)
        g_N = np.array([0.0, 0.0, -normal_gravity(latitude, height)])
        return cls(g_N, field_N_uT, earth_rate(latitude) if turning else np.zeros(3))

    @property
    def declination(self) -> float | None:
        """How far magnetic north lies east of true north, rad, where nothing disturbs the field.

        None without a field, or where it is vertical.
        """
        if self.field_N_uT is None or not self.field_N_uT[:2].any():
            return None
        return float(np.arctan2(self.field_N_uT[0], self.field_N_uT[1]))

    def disturbance_N_uT(self, t: Array, p_NS: Array) -> Array:
        """What all disturbances add to the field, (n, 3) microtesla, at times t (n,) s and places p_NS (n, 3) m."""
        total = np.zeros((len(t), 3))
        for disturbance in self.disturbances:
            total += disturbance.added_N_uT(t, p_NS)
        return total

    def __post_init__(self) -> None:
        put = object.__setattr__
        for name in ("g_N", "omega_IN_N"):
            put(self, name, finite(name, shaped(name, getattr(self, name), (3,))))
        _downwards(self.g_N)
        if self.field_N_uT is not None:
            put(self, "field_N_uT", finite("field_N_uT", shaped("field_N_uT", self.field_N_uT, (3,))))
            _in_microtesla("field_N_uT", self.field_N_uT)
        put(self, "disturbances", tuple(self.disturbances))
        for k, disturbance in enumerate(self.disturbances):
            instance(f"disturbances[{k}]", disturbance, Disturbance, "Write Dipole(...), say.")
        if self.disturbances and self.field_N_uT is None:
            raise ValueError(
                "disturbances need a magnetic field to disturb; give field_N_uT, microtesla in N."
            )


def _downwards(g_N: Array) -> None:
    """Refuse gravity that points up: what an accelerometer at rest reads, or a vector in axes whose z is down."""
    if g_N[2] > 0.0 and g_N[2] >= np.linalg.norm(g_N[:2]):
        raise ValueError(
            f"g_N must point down, and z of N is up: (0, 0, -{g_N[2]:.6g}); got {g_N.tolist()}. "
            "An accelerometer at rest reads +g up, but gravity itself pulls down."
        )


def _in_microtesla(name: str, field: Array) -> None:
    """Refuse a field that would be the Earth's, 20 to 70 microtesla, in another unit."""
    strength = float(np.linalg.norm(field))
    for unit, factor in _OTHER_UNITS.items():
        if _EARTHS_FIELD[0] <= strength * factor <= _EARTHS_FIELD[1]:
            raise ValueError(
                f"{name} must be in microtesla; {strength:.4g} uT is not the Earth's field, {strength:.4g} {unit} "
                f"is. Multiply it by {factor:g}."
            )
