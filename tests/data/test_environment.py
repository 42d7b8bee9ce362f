"""Surroundings at a place: gravity down, magnetic field by the map, declination explicit."""

from __future__ import annotations

from datetime import date, datetime

import numpy as np
import pytest

from kreisel import Environment


def test_a_place_has_its_gravity_field_and_declination() -> None:
    antarctic = Environment.at(-80.0, 240.0, 0.0, date(2025, 1, 1))
    # WMM2025_TEST_VALUES.txt: 68.78 deg east, 54698.2 nT; no small angle, and not the one of north and south mixed up.
    assert np.rad2deg(antarctic.declination) == pytest.approx(68.78, abs=0.005)
    assert np.linalg.norm(antarctic.field_N_uT) == pytest.approx(54.6982, abs=1e-4)
    assert antarctic.g_N[:2].tolist() == [0.0, 0.0] and -9.832 < antarctic.g_N[2] < -9.830


def test_a_day_is_needed_for_the_field_alone() -> None:
    munich = Environment.at(48.0, 11.0, 500.0)
    assert munich.field_N_uT is None and munich.declination is None
    on_a_day = Environment.at(48.0, 11.0, 500.0, datetime(2026, 5, 1, 12, 30))
    np.testing.assert_array_equal(munich.g_N, on_a_day.g_N)
    np.testing.assert_array_equal(
        on_a_day.field_N_uT, Environment.at(48.0, 11.0, 500.0, date(2026, 5, 1)).field_N_uT
    )


def test_without_a_horizontal_field_there_is_no_declination() -> None:
    assert Environment().declination is None
    assert Environment(field_N_uT=[0.0, 0.0, -50.0]).declination is None
    assert Environment(field_N_uT=[5.0, 5.0, -50.0]).declination == pytest.approx(np.pi / 4.0)


def test_places_and_days_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match=r"latitude_deg must be one number, from -90 to 90, deg; got 91"):
        Environment.at(91.0, 0.0, 0.0, date(2026, 1, 1))
    with pytest.raises(ValueError, match="no magnetic model covers 1999-01-01"):
        Environment.at(48.0, 11.0, 0.0, date(1999, 1, 1))
    with pytest.raises(TypeError, match="day must be of type date; got float"):
        Environment.at(48.0, 11.0, 0.0, 2026.5)


@pytest.mark.parametrize(
    ("field", "said"),
    [
        ([0.0, 2e-5, -4.4e-5], "tesla is. Multiply it by 1e[+]06"),
        ([0.0, 0.2, -0.44], "gauss is. Multiply it by 100"),
        ([0.0, 2e4, -4.4e4], "nanotesla is. Multiply it by 0.001"),
    ],
)
def test_the_earths_field_in_another_unit_is_refused_with_its_name(field, said) -> None:
    with pytest.raises(ValueError, match=f"field_N_uT must be in microtesla.*{said}"):
        Environment(field_N_uT=field)
    # What no other unit explains is somebody's laboratory.
    assert Environment(field_N_uT=[0.0, 0.0, 0.0]).field_N_uT is not None
    assert Environment(field_N_uT=[300.0, 0.0, 0.0]).field_N_uT is not None


def test_gravity_that_points_up_is_refused() -> None:
    with pytest.raises(ValueError, match=r"g_N must point down, and z of N is up: \(0, 0, -9.80665\)"):
        Environment(g_N=[0.0, 0.0, 9.80665])
    assert not Environment(g_N=[0.0, 0.0, 0.0]).g_N.any()
