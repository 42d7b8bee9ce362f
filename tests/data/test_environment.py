"""Surroundings at a place: gravity down, magnetic field by the map, declination explicit."""

from __future__ import annotations

from datetime import date

import numpy as np
import pytest

from kreisel import Environment


def test_a_place_has_its_gravity_field_and_declination() -> None:
    seattle = Environment.at(47.6205, -122.3493, 0.0, date(2025, 4, 2))
    # NOAA's calculator has 15.07 deg east there in 2025.25, to two digits.
    assert np.rad2deg(seattle.declination) == pytest.approx(15.07, abs=0.01)
    assert seattle.g_N[:2].tolist() == [0.0, 0.0] and -9.81 < seattle.g_N[2] < -9.80


def test_without_a_horizontal_field_there_is_no_declination() -> None:
    assert Environment().declination is None
    assert Environment(field_N_uT=[0.0, 0.0, -50.0]).declination is None
    assert Environment(field_N_uT=[5.0, 5.0, -50.0]).declination == pytest.approx(np.pi / 4.0)


def test_places_and_days_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match=r"latitude_deg must be one number, from -90 to 90, deg; got 91"):
        Environment.at(91.0, 0.0, 0.0, date(2026, 1, 1))
    with pytest.raises(ValueError, match="no magnetic model covers 1999-01-01"):
        Environment.at(48.0, 11.0, 0.0, date(1999, 1, 1))
    with pytest.raises(TypeError, match=r"day must be a datetime\.date"):
        Environment.at(48.0, 11.0, 0.0, 2026.5)
