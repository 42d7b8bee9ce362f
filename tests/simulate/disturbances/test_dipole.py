"""The field of a dipole: two textbook places, two laws of physics, and the magnet that a path runs into."""

import numpy as np
import pytest

from kreisel.simulate.disturbances.dipole import Dipole

ORIGIN = (0.0, 0.0, 0.0)
T = np.zeros(1)


def field(dipole, p):
    p = np.atleast_2d(np.asarray(p, dtype=float))
    return dipole.added_N_uT(np.zeros(len(p)), p)


def test_on_the_axis_it_is_twice_that_beside_it_and_turned_round():
    """mu_0 / 4 pi = 0.1 uT m^3 / (A m^2): 0.2 uT at 1 m on the axis of 1 A m^2."""
    dipole = Dipole(ORIGIN, (0.0, 0.0, 1.0))
    np.testing.assert_allclose(field(dipole, [0.0, 0.0, 1.0])[0], [0.0, 0.0, 0.2], atol=1e-17)
    np.testing.assert_allclose(field(dipole, [1.0, 0.0, 0.0])[0], [0.0, 0.0, -0.1], atol=1e-17)
    # Half as far, eight times as strong.
    np.testing.assert_allclose(field(dipole, [0.0, 0.0, 0.5])[0], [0.0, 0.0, 1.6], atol=1e-15)


def test_the_earth_is_one():
    """8e22 A m^2 at its centre, pointing south, are 31 uT to the north at the equator and 62 uT down at the pole."""
    earth = Dipole(ORIGIN, (0.0, 0.0, -8.0e22))
    equator, pole = field(earth, [[6.371e6, 0.0, 0.0], [0.0, 0.0, 6.371e6]])
    assert equator[2] == pytest.approx(30.9, abs=0.1)
    assert pole[2] == pytest.approx(-61.9, abs=0.1)


def test_it_has_neither_sources_nor_curl(rng):
    """Div B = 0 and curl B = 0 outside the magnet, by central differences."""
    dipole = Dipole(rng.normal(size=3), rng.normal(size=3))
    p, h = rng.normal(size=(20, 3)) * 3.0 + 5.0, 1e-4
    shifted = np.stack([(field(dipole, p + h * e) - field(dipole, p - h * e)) / (2.0 * h) for e in np.eye(3)])
    slope = np.moveaxis(shifted, 0, -1)  # slope[n, i, j]: of component i along j
    # Truncation: h^2 times two derivatives more, each a factor of a few over the distance of metres.
    size = np.abs(slope).max(axis=(1, 2))
    assert (np.abs(np.trace(slope, axis1=1, axis2=2)) < 1e-6 * size).all()
    assert (np.abs(slope - np.swapaxes(slope, 1, 2)).max(axis=(1, 2)) < 1e-6 * size).all()


def test_a_path_through_the_magnet_is_refused_with_time_and_place():
    dipole = Dipole((2.0, 0.0, 0.5), (0.0, 1.0, 0.0))
    t = np.arange(5.0)
    path = np.stack([t, 0 * t, 0 * t + 0.5], axis=1)
    with pytest.raises(ValueError) as caught:
        dipole.added_N_uT(t, path)
    told = str(caught.value)
    assert told.startswith(
        "p_ND [2.0, 0.0, 0.5] m is on the path: at t = 2 s the sensor is at [2.0, 0.0, 0.5] m, 0 m away"
    )
    assert "Place the dipole 0.0058 m or more from the path" in told
    # A metre beside it nothing is wrong, and a magnet without moment is none.
    assert np.isfinite(dipole.added_N_uT(t, path + np.array([0.0, 1.0, 0.0]))).all()
    assert not Dipole((2.0, 0.0, 0.5), ORIGIN).added_N_uT(t, path).any()


def test_parameters_are_named_with_their_units():
    with pytest.raises(ValueError, match=r"p_ND must be three finite numbers, m in N; got \[1, 2\]"):
        Dipole([1, 2], ORIGIN)
    with pytest.raises(ValueError, match=r"moment_N must be three finite numbers, A m\^2 in N; got 3"):
        Dipole(ORIGIN, 3.0)
