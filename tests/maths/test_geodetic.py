"""Places on the ellipsoid, against facts of geodesy."""

import numpy as np
import pytest
from scipy.integrate import quad

from kreisel.maths.earth import ECCENTRICITY_SQUARED, FLATTENING, SEMI_MAJOR
from kreisel.maths.geodetic import earth_centred, local_axes, local_position


def degrees(*values):
    return np.deg2rad(np.array(values, dtype=float))


def test_equator_and_poles_are_the_axes_of_the_ellipsoid():
    found = earth_centred(degrees(0, 0, 90, -90), degrees(0, 90, 0, 45), np.array([0.0, 100.0, 0.0, 10.0]))
    b = SEMI_MAJOR * (1.0 - FLATTENING)
    expected = [[SEMI_MAJOR, 0, 0], [0, SEMI_MAJOR + 100.0, 0], [0, 0, b], [0, 0, -b - 10.0]]
    # The cosine of a right angle in floating point, times the Earth's radius: 4e-10 m.
    np.testing.assert_allclose(found, expected, atol=1e-8)


def test_every_place_lies_on_the_ellipsoid(rng):
    lat, lon = rng.uniform(-1.5, 1.5, 50), rng.uniform(-3.1, 3.1, 50)
    x, y, z = earth_centred(lat, lon, np.zeros(50)).T
    b = SEMI_MAJOR * (1.0 - FLATTENING)
    np.testing.assert_allclose((x**2 + y**2) / SEMI_MAJOR**2 + z**2 / b**2, 1.0, rtol=1e-14)


def test_height_is_along_the_vertical(rng):
    lat, lon = rng.uniform(-1.5, 1.5), rng.uniform(-3.1, 3.1)
    low, high = earth_centred(np.full(2, lat), np.full(2, lon), np.array([0.0, 1000.0]))
    np.testing.assert_allclose((high - low) / 1000.0, local_axes(lat, lon)[2], atol=1e-12)
    np.testing.assert_allclose(local_axes(lat, lon) @ local_axes(lat, lon).T, np.eye(3), atol=1e-15)


def test_a_degree_along_the_meridian_has_its_length():
    # Points every 1/1000 degree: chords fall short of the arc by less than 1e-11 of it.
    lat = np.deg2rad(np.linspace(47.0, 48.0, 1001))
    way = earth_centred(lat, np.zeros(1001), np.zeros(1001))
    e2 = ECCENTRICITY_SQUARED
    arc, _ = quad(lambda x: SEMI_MAJOR * (1.0 - e2) / (1.0 - e2 * np.sin(x) ** 2) ** 1.5, lat[0], lat[-1])
    assert np.linalg.norm(np.diff(way, axis=0), axis=1).sum() == pytest.approx(arc, rel=1e-9)


def test_east_north_and_up_of_the_first_place():
    lat, lon, up = (
        degrees(47.0, 47.0, 47.0001, 47.0),
        degrees(8.0, 8.0001, 8.0, 8.0),
        np.array([400.0, 400.0, 400.0, 410.0]),
    )
    found = local_position(lat, lon, up)
    # 111 178 m a degree of latitude, 76 061 of longitude at 47 degrees and 400 m.
    np.testing.assert_allclose(found, [[0, 0, 0], [7.606, 0, 0], [0, 11.118, 0], [0, 0, 10]], atol=1e-3)


def test_the_horizon_drops():
    found = local_position(degrees(47.0, 47.0), degrees(8.0, 8.0 + 10.0 / 76.03), np.zeros(2))
    # d^2 / 2 R over 10 km with R = 6390 km.
    assert found[1, 2] == pytest.approx(-(1e4**2) / 2.0 / 6.39e6, rel=2e-3)
