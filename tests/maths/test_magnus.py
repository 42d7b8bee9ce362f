"""One step of rates and forces: the matrix exponential for constants, sixth order otherwise."""

import mpmath
import numpy as np
import pytest

from kreisel.maths.magnus import GAUSS, SERIES_BELOW, _coefficients, increments
from kreisel.maths.rotations import exp_so3, log_so3, skew


def exponential(omega, f, h):
    """The step for constant omega and f, from the 5 x 5 matrix exponential in 40 digits."""
    A = np.zeros((5, 5))
    A[:3, :3], A[:3, 3], A[3, 4] = skew(omega), f, 1.0
    with mpmath.workdps(40):
        X = mpmath.expm(mpmath.matrix(A.tolist()) * mpmath.mpf(h))
        return np.array(X.tolist(), dtype=float)


@pytest.mark.parametrize("rate", [0.0, 1e-9, 1e-3, 1.9, 2.1, 20.0])
def test_constant_rate_and_force_are_exact(rng, rate):
    axis = rng.normal(size=3)
    omega, f, h = rate * axis / np.linalg.norm(axis), rng.normal(size=3), 0.1
    dtheta, dv, dp = increments(np.array([h]), np.tile(np.hstack([omega, f]), (1, 3, 1)))
    X = exponential(omega, f, h)
    # Round-off of a dozen operations.
    np.testing.assert_allclose(exp_so3(dtheta[0]), X[:3, :3], rtol=0, atol=1e-15)
    np.testing.assert_allclose(dv[0], X[:3, 3], rtol=0, atol=2e-16)
    np.testing.assert_allclose(dp[0], X[:3, 4], rtol=0, atol=1e-17)


@pytest.mark.parametrize("angle", [0.0, 1e-8, 0.99 * SERIES_BELOW, SERIES_BELOW, 1.01 * SERIES_BELOW, 3.0])
def test_coefficients_agree_with_many_digits(angle):
    b, c, d = _coefficients(angle * angle)
    with mpmath.workdps(60):
        a = mpmath.mpf(angle) or mpmath.mpf(10) ** -15
        exact = [
            (1 - mpmath.cos(a)) / a**2,
            (a - mpmath.sin(a)) / a**3,
            (a**2 / 2 - 1 + mpmath.cos(a)) / a**4,
        ]
    # c enters times the angle and d times its square, so their digits count by as much.
    for got, wanted, weight in zip((b, c, d), exact, (1.0, min(1.0, angle), min(1.0, angle**2)), strict=True):
        assert abs(got - float(wanted)) * weight < 1e-15


def rates(t):
    """A gyro and an accelerometer that both turn, out of step."""
    return np.stack(
        [np.cos(9 * t), np.sin(7 * t), 1 + 0 * t, 3 * np.sin(8 * t), np.cos(5 * t), 9.8 + np.cos(11 * t)],
        axis=-1,
    )


def composed(steps, span=1.0):
    """Attitude, velocity and position after `span` in so many steps."""
    h = span / steps
    starts = h * np.arange(steps)
    R, v, p = np.eye(3), np.zeros(3), np.zeros(3)
    for dtheta, dv, dp in zip(
        *increments(np.full(steps, h), rates(starts[:, None] + h * GAUSS)), strict=True
    ):
        p = p + v * h + R @ dp
        v = v + R @ dv
        R = R @ exp_so3(dtheta)
    return R, v, p


def test_sixth_order_in_attitude_velocity_and_position():
    R_fine, v_fine, p_fine = composed(640)
    coarse, half = composed(20), composed(40)
    for error in (
        lambda x: np.linalg.norm(log_so3(R_fine.T @ x[0])),
        lambda x: np.linalg.norm(x[1] - v_fine),
        lambda x: np.linalg.norm(x[2] - p_fine),
    ):
        # 1e-9 at 20 steps and 2e-11 at 40; the next order bends the slope by some tenths.
        assert np.log2(error(coarse) / error(half)) == pytest.approx(6.0, abs=0.5)
