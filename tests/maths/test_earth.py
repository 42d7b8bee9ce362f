"""Gravity, Earth's rate and magnetic field agree with published values."""

from __future__ import annotations

from datetime import date

import mpmath
import numpy as np
import pytest

from kreisel.maths.earth import EARTH_RATE, earth_rate, magnetic_field_uT, normal_gravity


def level_ellipsoid(latitude, height):
    """Normal gravity (m/s^2) in 30 digits: the slope of the potential that WGS 84's four constants define.

    Shares nothing with the formulas under test. Source: Heiskanen and Moritz, Physical Geodesy (1967), section 2-7;
    constants of NGA.STND.0036_1.0.0_WGS84, table 3.1.
    """
    a, GM, omega = mpmath.mpf(6378137), mpmath.mpf("3.986004418e14"), mpmath.mpf("7.292115e-5")
    b = a * (1 - 1 / mpmath.mpf("298.257223563"))
    E = mpmath.sqrt(a * a - b * b)

    def q(u):
        return ((1 + 3 * u * u / E**2) * mpmath.atan(E / u) - 3 * u / E) / 2

    def potential(x, z):
        rest = x * x + z * z - E * E
        u = mpmath.sqrt(rest / 2 * (1 + mpmath.sqrt(1 + 4 * E * E * z * z / rest**2)))
        swelling = (omega * a) ** 2 / 2 * q(u) / q(b) * ((z / u) ** 2 - mpmath.mpf(1) / 3)
        return GM / E * mpmath.atan(E / u) + swelling + (omega * x) ** 2 / 2

    s, c = mpmath.sin(latitude), mpmath.cos(latitude)
    normal = a * a / mpmath.sqrt((a * c) ** 2 + (b * s) ** 2)
    x, z = (normal + height) * c, (normal * (b / a) ** 2 + height) * s
    slope = mpmath.diff(lambda x: potential(x, z), x), mpmath.diff(lambda z: potential(x, z), z)
    return float(mpmath.hypot(*slope))


def test_the_constants_are_those_of_the_standard() -> None:
    # NGA.STND.0036, table 3.6, to its last digit; the ellipsoid itself agrees with it.
    for latitude, printed in ((0.0, 9.7803253359), (np.pi / 2.0, 9.8321849379)):
        assert normal_gravity(latitude, 0.0) == pytest.approx(printed, abs=5e-11)
        with mpmath.workdps(30):
            assert level_ellipsoid(latitude, 0.0) == pytest.approx(printed, abs=5e-11)


@pytest.mark.parametrize(
    ("height", "tolerance"),
    # The series in height ends after its second term; the third is 4 (h / a)^3 g: 1e-6 at 20 km, 1.5e-4 at 100 km.
    [(0.0, 1e-11), (-400.0, 5e-8), (8849.0, 8e-7), (20_000.0, 1.5e-6), (100_000.0, 1.6e-4)],
)
def test_gravity_is_the_slope_of_the_potential(height: float, tolerance: float) -> None:
    with mpmath.workdps(30):
        for latitude in np.deg2rad([0.0, 21.0, 45.0, 68.0, 90.0]):
            exact = level_ellipsoid(latitude, height)
            assert normal_gravity(latitude, height) == pytest.approx(exact, abs=tolerance)


def test_the_earth_turns_about_its_axis() -> None:
    np.testing.assert_allclose(earth_rate(np.pi / 2.0), [0.0, 0.0, EARTH_RATE], atol=1e-20)
    np.testing.assert_allclose(earth_rate(0.0), [0.0, EARTH_RATE, 0.0], atol=1e-20)


# Test values that NCEI publishes with each model: latitude and longitude, deg; height, km; north, east, down, nT.
# WMM2025_TEST_VALUES.txt, WMM2020testvalues.pdf, WMM2015v2testvalues.pdf and WMM2010testvalues.pdf.
PUBLISHED = {
    date(2025, 1, 1): [
        (80, 0, 0, 6521.6, 145.9, 54791.5),
        (0, 120, 0, 39677.8, -109.6, -10580.2),
        (-80, 240, 0, 6117.5, 15751.9, -52022.5),
        (80, 0, 100, 6216.0, 92.4, 52598.8),
        (0, 120, 100, 37688.6, -96.2, -10152.1),
        (-80, 240, 100, 5907.6, 14780.3, -49540.7),
    ],
    date(2027, 7, 2): [
        (80, 0, 0, 6500.8, 294.5, 54869.4),
        (0, 120, 0, 39701.6, -167.4, -10381.8),
        (-80, 240, 0, 6200.7, 15730.3, -51783.7),
        (80, 0, 100, 6196.7, 233.8, 52670.5),
        (0, 120, 100, 37711.5, -148.7, -9969.8),
        (-80, 240, 100, 5984.0, 14760.1, -49317.7),
    ],
    date(2020, 1, 1): [(80, 0, 0, 6570.4, -146.3, 54606.0), (-80, 240, 100, 5744.9, 14799.5, -49969.4)],
    date(2022, 7, 2): [(80, 0, 0, 6529.9, 1.1, 54713.4), (-80, 240, 100, 5815.0, 14803.0, -49755.3)],
    date(2015, 1, 1): [(80, 0, 0, 6636.6, -451.9, 54408.9), (-80, 240, 100, 5612.2, 14789.3, -50385.8)],
    date(2017, 7, 2): [(0, 120, 0, 39569.4, 252.3, -11067.9), (-80, 240, 100, 5674.9, 14793.1, -50179.5)],
    date(2010, 1, 1): [(80, 0, 0, 6649.5, -714.6, 54346.2), (-80, 240, 100, 5484.3, 14762.8, -50834.8)],
    date(2012, 7, 1): [(0, 120, 100, 37448.1, 559.7, -11044.2), (-80, 240, 0, 5713.6, 15731.8, -53184.3)],
}


@pytest.mark.parametrize("day", PUBLISHED, ids=str)
def test_the_field_is_that_of_the_published_test_values(day: date) -> None:
    # Printed to a tenth of a nanotesla; the middle of a year, x.5, is up to half a day off, at 90 nT a year.
    tolerance = 1e-4 if day.month == 1 else 2.5e-4
    for latitude, longitude, height, north, east, down in PUBLISHED[day]:
        field = magnetic_field_uT(*np.deg2rad([latitude, longitude]), 1000.0 * height, day)
        np.testing.assert_allclose(field, 1e-3 * np.array([east, north, -down]), atol=tolerance)


def test_every_year_of_every_model_answers_and_others_are_refused() -> None:
    # Munich: 48 uT and slowly growing, through five models.
    strength = [
        np.linalg.norm(magnetic_field_uT(0.84, 0.2, 500.0, date(y, 12, 31))) for y in range(2010, 2030)
    ]
    assert (np.abs(np.diff(strength)) < 0.1).all() and 47.0 < strength[0] < strength[-1] < 50.0
    for day in (date(2009, 12, 31), date(2030, 1, 1)):
        with pytest.raises(ValueError, match=f"no magnetic model covers {day}"):
            magnetic_field_uT(0.84, 0.2, 500.0, day)
