"""Turns a place on the Earth, and a date, into gravity, the Earth's rate and its magnetic field, in N."""

from __future__ import annotations

from datetime import date, datetime

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# WGS 84. Source: NGA.STND.0036_1.0.0_WGS84 (2014), tables 3.1, 3.3, 3.6 and 4.1.
SEMI_MAJOR = 6378137.0  # m
FLATTENING = 1.0 / 298.257223563
EARTH_RATE = 7.292115e-5  # rad/s
ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
GRAVITY_AT_EQUATOR = 9.7803253359  # m/s^2
SOMIGLIANA = 1.931852652458e-3
CENTRIFUGAL_RATIO = 3.449786506841e-3  # omega^2 a^2 b / GM

FIRST_YEAR, LAST_YEAR = 2010, 2029
"""Years that the magnetic models cover: five for each."""


def normal_gravity(latitude: float, height: float) -> float:
    """Gravity of the WGS 84 ellipsoid, m/s^2, centrifugal part included.

    latitude: rad, geodetic. height: m above the ellipsoid; good to 1.5e-6 m/s^2 below 20 km and 1.6e-4 at 100 km.
    The Earth's own gravity differs from it by some 3e-4 m/s^2, near mountains and mines by more.
    Source: NGA.STND.0036_1.0.0_WGS84 (2014), equations 4-1 (Somigliana) and 4-3; Groves 2013, eq. 2.134 and 2.139.
    """
    s = np.sin(latitude) ** 2
    on_the_ellipsoid = GRAVITY_AT_EQUATOR * (1.0 + SOMIGLIANA * s) / np.sqrt(1.0 - ECCENTRICITY_SQUARED * s)
    h = height / SEMI_MAJOR
    slope = 1.0 + FLATTENING + CENTRIFUGAL_RATIO - 2.0 * FLATTENING * s
    return float(on_the_ellipsoid * (1.0 - 2.0 * slope * h + 3.0 * h * h))


def earth_rate(latitude: float) -> Array:
    """Rate of the Earth (3,) in N (east, north, up), rad/s. latitude: rad, geodetic."""
    return EARTH_RATE * np.array([0.0, np.cos(latitude), np.sin(latitude)])


def magnetic_field_uT(latitude: float, longitude: float, height: float, day: date) -> Array:
    """Earth's main field (3,) in N (east, north, up), microtesla, by the World Magnetic Model of that day.

    latitude, longitude: rad, geodetic. height: m above the ellipsoid, from -1000 to 850 000. The model leaves out
    rocks, buildings and the day's weather in space: some 0.15 uT, and indoors far more.
    Raises ValueError for a day that no model at hand was made for.
    Source: NOAA/NCEI and BGS, The World Magnetic Model 2025; its coefficients come with pygeomag.
    """
    from pygeomag import GeoMag

    if not FIRST_YEAR <= day.year <= LAST_YEAR:
        raise ValueError(
            f"no magnetic model covers {day.isoformat()}: the World Magnetic Models at hand are for {FIRST_YEAR} to "
            f"{LAST_YEAR}. Give a day in these years, or the field itself (field_N_uT)."
        )
    place = float(np.rad2deg(latitude)), float(np.rad2deg(longitude)), height / 1000.0
    field = GeoMag(base_year=datetime(day.year, 1, 1)).calculate(*place, _decimal_year(day))
    return np.array([field.y, field.x, -field.z]) * 1e-3


def _decimal_year(day: date) -> float:
    start, end = date(day.year, 1, 1), date(day.year + 1, 1, 1)
    return day.year + (day - start).days / (end - start).days
