"""One factor for every spelling of a unit."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.files.units import UNITS, scale


@pytest.mark.parametrize(
    ("quantity", "spellings"),
    [
        ("acceleration", ["m/s^2", "m/s2", "m/s²", "m s^-2", "m*s^-2", "m/s/s", "m s⁻²", "M/S^2"]),
        ("rate", ["deg/s", "dps", "°/s", "DPS", "deg s^-1", "degrees/s", "deg/sec"]),
        ("field", ["gauss", "G", "Gauss", "Gs"]),
        ("time", ["us", "µs", "usec"]),
        ("acceleration", ["g", "G"]),
        ("acceleration", ["mg", "mG"]),
    ],
)
def test_spellings_agree(quantity: str, spellings: list[str]) -> None:
    assert len({scale(spelling, quantity) for spelling in spellings}) == 1


def test_ours_comes_first_and_changes_no_bit() -> None:
    x = np.array([0.1, 1e-300, -3.0])
    for quantity, units in UNITS.items():
        assert scale(next(iter(units)), quantity)(x) is x


def test_decimal_units_round_once() -> None:
    # 3 * 0.001 is 0.003 + 1 ulp.
    assert scale("mm", "length")(np.array([3.0]))[0] == 0.003


@pytest.mark.parametrize(("unit", "quantity"), [("deg", "length"), ("", "length"), ("mT", "acceleration")])
def test_units_of_something_else_are_refused(unit: str, quantity: str) -> None:
    with pytest.raises(ValueError, match=f"no unit of {quantity}"):
        scale(unit, quantity)
