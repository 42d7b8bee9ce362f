"""Roll that takes the sideways force away."""

import numpy as np
import pytest

from kreisel.maths.bank import banked
from kreisel.maths.following.exact import follow
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.jets import differentiate
from kreisel.maths.rotations import euler_from_matrix, log_so3

UP = np.array([0.0, 0.0, 9.80665])


def flown(path, t):
    """Attitude of a body banked along `path`, and its specific force in its own axes."""
    derivatives = differentiate(path, t, 4)
    force = derivatives[2:].copy()
    force[0] += UP
    attitude = banked(follow(lambda x, order: differentiate(path, x, order), t).attitude, force)
    return attitude, np.einsum("nji,nj->ni", attitude.R_NB, force[0])


@pytest.mark.parametrize(("turn", "sign"), [(1.0, -1.0), (-1.0, 1.0)])
def test_a_steady_turn_is_banked_by_the_pilots_formula(turn, sign):
    speed, radius = 20.0, 80.0
    rate = turn * speed / radius
    attitude, force = flown(
        lambda t: (radius * np.cos(rate * t), radius * np.sin(rate * t), 0.0 * t), np.linspace(0.0, 5.0, 6)
    )
    # Left side up is positive: a left turn has the left wing down.
    expected = sign * np.arctan(speed**2 / (9.80665 * radius))
    np.testing.assert_allclose(euler_from_matrix(attitude.R_NB)[:, 0], expected, rtol=1e-12)
    np.testing.assert_allclose(force[:, 1], 0.0, atol=1e-14 * 20.0)
    np.testing.assert_allclose(force[:, 2], np.hypot(9.80665, speed**2 / radius), rtol=1e-13)


def wild(t):
    return 30.0 * np.sin(0.9 * t), 25.0 * np.cos(1.1 * t), 5.0 * np.sin(0.7 * t)


def test_rates_are_the_derivatives_of_the_attitude():
    h, t = 1e-5, np.linspace(0.1, 4.0, 40)
    before, now, after = (flown(wild, t + shift) for shift in (-h, 0.0, h))
    assert np.abs(now[1][:, 1]).max() < 1e-12
    turn = log_so3(np.einsum("nji,njk->nik", before[0].R_NB, after[0].R_NB)) / (2.0 * h)
    # Truncation h^2 / 6 times a third derivative of a few hundred; round-off 1e-16 / h.
    np.testing.assert_allclose(turn, now[0].omega_NB_B, atol=1e-7)
    slope = (after[0].omega_NB_B - before[0].omega_NB_B) / (2.0 * h)
    np.testing.assert_allclose(slope, now[0].alpha_NB_B, atol=1e-6)


def test_a_body_in_free_fall_does_not_roll():
    level = Attitude(np.eye(3)[None], np.zeros((1, 3)), np.zeros((1, 3)))
    for part, same in zip(banked(level, np.zeros((3, 1, 3))), level, strict=True):
        np.testing.assert_array_equal(part, same)
