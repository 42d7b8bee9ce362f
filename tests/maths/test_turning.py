"""A frame that turns: there and back, gravity that turns with it, and nothing at all where it rests."""

import mpmath
import numpy as np

from kreisel.maths.rotations import exp_so3
from kreisel.maths.turning import (
    State,
    acceleration_in_N,
    falls,
    felt_acceleration,
    felt_rate,
    rates_in_N,
    standing_still,
    turning_along,
)

OMEGA = np.array([0.2, -0.3, 0.5])
G = np.array([0.3, -0.1, -9.8])


def some_state(rng, n):
    return State(rng.normal(size=(n, 3)), rng.normal(size=(n, 3)), exp_so3(rng.normal(size=(n, 3))))


def test_there_and_back(rng):
    t, state = np.sort(rng.uniform(0.0, 50.0, 40)), some_state(rng, 40)
    there = standing_still(t, state, OMEGA)
    for before, after in zip(state, turning_along(t, there, OMEGA), strict=True):
        # Two rotations there, two back.
        np.testing.assert_allclose(after, before, atol=1e-14)
    # At t[0] the axes are the same, and only the velocity is not.
    np.testing.assert_array_equal(there.p_XS[0], state.p_XS[0])
    np.testing.assert_allclose(there.v_XS[0], state.v_XS[0] + np.cross(OMEGA, state.p_XS[0]), atol=1e-15)


def test_rates_and_accelerations_there_and_back(rng):
    omega, alpha, a, v, p = rng.normal(size=(5, 40, 3))
    R = exp_so3(rng.normal(size=(40, 3)))
    felt = felt_acceleration(a, v, p, OMEGA)
    np.testing.assert_allclose(acceleration_in_N(felt, v, p, OMEGA), a, atol=1e-14)
    found, _ = rates_in_N(felt_rate(omega, R, OMEGA), alpha, R, OMEGA)
    np.testing.assert_allclose(found, omega, atol=1e-15)


def test_the_slope_of_a_rate_in_n_is_not_that_of_the_gyroscope():
    """A body that turns about z at rate w in a frame that turns about x: its x and y see that rate go round."""
    w, turn, t = 2.0, 0.3, np.linspace(0.0, 1.0, 7)
    R = exp_so3(t[:, None] * [0.0, 0.0, w])
    slope = turn * w * np.stack([-np.sin(w * t), -np.cos(w * t), 0.0 * t], axis=1)
    frame = np.array([turn, 0.0, 0.0])
    omega, alpha = rates_in_N(felt_rate(np.tile([0.0, 0.0, w], (7, 1)), R, frame), slope, R, frame)
    np.testing.assert_allclose(omega, np.tile([0.0, 0.0, w], (7, 1)), atol=1e-15)
    np.testing.assert_allclose(alpha, 0.0, atol=1e-15)


def test_where_n_rests_nothing_is_touched(rng):
    t, state, still = np.arange(5.0), some_state(rng, 5), np.zeros(3)
    x = rng.normal(size=(5, 3))
    assert standing_still(t, state, still) is state
    assert turning_along(t, state, still) is state
    assert felt_rate(x, state.R_XS, still) is x
    assert felt_acceleration(x, x, x, still) is x
    assert acceleration_in_N(x, x, x, still) is x
    assert rates_in_N(x, x, state.R_XS, still) == (x, x)
    dv, dp = falls(t, G, still)
    np.testing.assert_array_equal(dv, np.tile(G, (4, 1)))
    np.testing.assert_array_equal(dp, 0.5 * np.tile(G, (4, 1)))


def turned(s):
    """Exp(omega s) G in 30 digits, by Rodrigues' formula."""
    omega, g = mpmath.matrix(OMEGA), mpmath.matrix(G)
    rate = mpmath.norm(omega)
    axis = omega / rate
    cross = mpmath.matrix(
        [axis[(i + 1) % 3] * g[(i + 2) % 3] - axis[(i + 2) % 3] * g[(i + 1) % 3] for i in range(3)]
    )
    along = axis * sum(a * b for a, b in zip(axis, g, strict=True))
    return along + (g - along) * mpmath.cos(rate * s) + cross * mpmath.sin(rate * s)


def test_gravity_that_turns_adds_up_as_its_integrals_do():
    """Uneven steps, from a millisecond to ten seconds: five radians."""
    t = np.array([3.0, 3.001, 3.5, 13.5, 14.0])
    dv, dp = falls(t, G, OMEGA)
    with mpmath.workdps(30):
        for k in range(4):
            a, b = (mpmath.mpf(x) - 3 for x in t[k : k + 2])
            velocity = [mpmath.quad(lambda s, i=i: turned(s)[i], [a, b]) for i in range(3)]
            place = [mpmath.quad(lambda s, i=i, b=b: (b - s) * turned(s)[i], [a, b]) for i in range(3)]
            # Sums of terms up to 10 m/s^2 over the step.
            np.testing.assert_allclose(
                dv[k], [float(x) for x in velocity], rtol=0, atol=2e-14 * float(b - a) * 10
            )
            np.testing.assert_allclose(
                dp[k], [float(x) for x in place], rtol=0, atol=2e-14 * float(b - a) ** 2 * 10
            )
