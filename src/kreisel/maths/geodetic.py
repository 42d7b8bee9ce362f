"""Turns latitude, longitude and height into metres east, north and up of a place."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.earth import ECCENTRICITY_SQUARED, SEMI_MAJOR

Array = npt.NDArray[np.float64]


def earth_centred(latitude: Array, longitude: Array, height: Array) -> Array:
    """Positions (n, 3) m, Earth-centred and Earth-fixed, x through Greenwich, z through the north pole.

    latitude, longitude: (n,) rad, geodetic; height: (n,) m above the WGS 84 ellipsoid.
    Source: NGA.STND.0036_1.0.0_WGS84 (2014), equation 4-14.
    """
    across = SEMI_MAJOR / np.sqrt(1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)
    level = (across + height) * np.cos(latitude)
    up = (across * (1.0 - ECCENTRICITY_SQUARED) + height) * np.sin(latitude)
    return np.stack([level * np.cos(longitude), level * np.sin(longitude), up], axis=-1)


def local_axes(latitude: float, longitude: float) -> Array:
    """East, north and up (3, 3) at a place, as rows in Earth-centred components."""
    (sin_lat, cos_lat), (sin_lon, cos_lon) = ((np.sin(x), np.cos(x)) for x in (latitude, longitude))
    return np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )


def local_position(latitude: Array, longitude: Array, height: Array) -> Array:
    """Positions (n, 3) m in N: east, north and up of the first place, on the plane that touches the Earth there.

    Exact, not a flat map: the same height 10 km away lies 8 m below that plane.
    """
    there = earth_centred(latitude, longitude, height)
    return np.asarray((there - there[0]) @ local_axes(latitude[0], longitude[0]).T)
