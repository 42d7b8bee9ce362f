"""Gravity, Earth's rate and magnetic field agree with published values."""

from __future__ import annotations

from datetime import date

import numpy as np
import pytest

from kreisel.maths.earth import EARTH_RATE, earth_rate, magnetic_field_uT, normal_gravity


def test_gravity_at_the_equator_and_at_the_pole_is_that_of_the_standard() -> None:
    # NGA.STND.0036, table 3.6, to its last digit.
    assert normal_gravity(0.0, 0.0) == pytest.approx(9.7803253359, abs=5e-11)
    assert normal_gravity(np.pi / 2.0, 0.0) == pytest.approx(9.8321849379, abs=5e-11)


def test_gravity_falls_with_height_as_it_does_from_outside_a_mass() -> None:
    # The free-air gradient at 45 deg is -3.0855e-6 1/s^2 (Torge and Mueller, Geodesy, section 3.5), to four digits.
    latitude = np.pi / 4.0
    assert normal_gravity(latitude, 1.0) - normal_gravity(latitude, 0.0) == pytest.approx(
        -3.0855e-6, rel=3e-4
    )


def test_the_earth_turns_about_its_axis() -> None:
    np.testing.assert_allclose(earth_rate(np.pi / 2.0), [0.0, 0.0, EARTH_RATE], atol=1e-20)
    np.testing.assert_allclose(earth_rate(0.0), [0.0, EARTH_RATE, 0.0], atol=1e-20)


@pytest.mark.parametrize(
    ("latitude_deg", "longitude_deg", "height", "day", "north_nT", "east_nT", "down_nT"),
    [
        # Test values that the model's makers publish with WMM2025.
        (80.0, 0.0, 0.0, date(2025, 1, 1), 6521.6, 145.9, 54791.5),
        (0.0, 120.0, 0.0, date(2025, 1, 1), 39677.8, -109.6, -10580.2),
        (-80.0, 240.0, 0.0, date(2025, 1, 1), 6117.5, 15751.9, -52022.5),
    ],
)
def test_the_field_is_that_of_the_published_test_values(
    latitude_deg, longitude_deg, height, day, north_nT, east_nT, down_nT
) -> None:
    field = magnetic_field_uT(*np.deg2rad([latitude_deg, longitude_deg]), height, day)
    # Published to a tenth of a nanotesla.
    np.testing.assert_allclose(field, 1e-3 * np.array([east_nT, north_nT, -down_nT]), atol=1e-4)


def test_every_year_of_every_model_answers_and_others_are_refused() -> None:
    # Munich: 48 uT and slowly growing, through five models.
    strength = [
        np.linalg.norm(magnetic_field_uT(0.84, 0.2, 500.0, date(y, 12, 31))) for y in range(2010, 2030)
    ]
    assert (np.abs(np.diff(strength)) < 0.1).all() and 47.0 < strength[0] < strength[-1] < 50.0
    for day in (date(2009, 12, 31), date(2030, 1, 1)):
        with pytest.raises(ValueError, match=f"no magnetic model covers {day}"):
            magnetic_field_uT(0.84, 0.2, 500.0, day)
