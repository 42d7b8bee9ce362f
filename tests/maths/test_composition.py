"""The chain rule of position and attitude, against functions that are differentiated exactly as a whole."""

import numpy as np

from kreisel.maths.composition import composed, turned_by
from kreisel.maths.following.exact import follow
from kreisel.maths.jets import differentiate


def curve(u):
    return np.cos(u), np.sin(2.0 * u), 0.3 * u**2


def clock(t):
    return t + 0.3 * np.sin(t)


T = np.linspace(0.0, 3.0, 11)


def test_position_and_four_derivatives():
    u = differentiate(clock, T, 4)
    found = composed(differentiate(curve, u[0], 4), u)
    exact = differentiate(lambda t: curve(clock(t)), T, 4)
    # Sums of products of up to four factors of order one to sixteen.
    np.testing.assert_allclose(found, exact, atol=1e-13 * np.abs(exact).max())


def test_attitude_and_its_rates():
    u = differentiate(clock, T, 2)
    along = follow(lambda x, order: differentiate(curve, x, order), u[0]).attitude
    exact = follow(lambda t, order: differentiate(lambda s: curve(clock(s)), t, order), T).attitude
    for one, other in zip(turned_by(along, u), exact, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
