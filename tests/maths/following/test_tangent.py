"""The closed form of tangential orientation, and its limits where the angles themselves have none."""

import numpy as np
import numpy.typing as npt
import pytest

from kreisel.maths.following.tangent import (
    AFTER,
    BEFORE,
    DERIVATIVES,
    attitude_along,
    leading_series,
    limits,
    tangent_motion,
)
from kreisel.maths.jets import differentiate
from tests.truth import truth

Array = npt.NDArray[np.float64]


def derivatives(x: object, y: object, z: object, t: Array) -> Array:
    """Velocity and five more derivatives (6, n, 3) of three functions."""
    return differentiate(lambda u: (x(u), y(u), z(u)), t, DERIVATIVES)[1:]  # type: ignore[operator]


def zero(t: Array) -> Array:
    return 0.0 * t


def loop(t: Array) -> Array:
    return derivatives(
        lambda u: 0.8 * np.cos(2 * np.pi * u),
        lambda u: 0.8 * np.sin(2 * np.pi * u),
        lambda u: 0.3 * np.cos(6 * np.pi * u),
        t,
    )


def test_closed_form_equals_fifty_digits() -> None:
    t = np.arange(0.0, 5.0, 0.01)
    exact = truth("A", t)
    v, a, j, *_ = loop(t)
    attitude, headless = tangent_motion(t, v, a, j)
    assert not headless.any()
    # alpha reaches 400 rad/s^2 and its own derivative 2e4; the argument 6 pi t is rounded to 1.4e-14.
    np.testing.assert_allclose(attitude.R_NB, exact.R_NB, atol=1e-13)
    np.testing.assert_allclose(attitude.omega_NB_B, exact.omega_NB_B, atol=1e-12)
    np.testing.assert_allclose(attitude.alpha_NB_B, exact.alpha_NB_B, atol=1e-10)


def test_limits_are_the_closed_form_where_the_body_moves() -> None:
    t = np.arange(0.0, 1.0, 0.01)
    d = loop(t)
    attitude, _ = tangent_motion(t, d[0], d[1], d[2])
    for side in (BEFORE, AFTER):
        for ours, theirs in zip(attitude_along(limits(t, d, side).directions), attitude, strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_a_row_without_horizontal_velocity_is_marked() -> None:
    v = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [1e-16, 0.0, 3.0], [1e-6, 0.0, 0.0]])
    _, headless = tangent_motion(np.arange(4.0), v, np.zeros((4, 3)), np.zeros((4, 3)))
    assert headless.tolist() == [True, True, True, False]


@pytest.mark.parametrize("side", [BEFORE, AFTER])
def test_the_cusp_of_a_cycloid_has_the_rate_of_its_tangent(side: int) -> None:
    # A wheel of radius 1 rolling along x: the tangent of its rim turns at half the wheel's rate, -1/2 rad/s,
    # at the cusp as everywhere; there it stands upright.
    cusp = np.array([2.0 * np.pi])
    d = derivatives(lambda u: u - np.sin(u), lambda u: 1.0 - np.cos(u), zero, cusp)
    attitude = attitude_along(limits(cusp, d, side).directions)
    np.testing.assert_allclose(attitude.R_NB[0, :, 0], [0.0, side, 0.0], atol=1e-15)
    np.testing.assert_allclose(attitude.omega_NB_B[0], [0.0, 0.0, -0.5], atol=1e-15)
    np.testing.assert_allclose(attitude.alpha_NB_B[0], 0.0, atol=1e-14)


@pytest.mark.parametrize("begins_with", [1, 2, 3, 4])
def test_a_movement_may_begin_with_any_derivative_up_to_snap(begins_with: int) -> None:
    # The velocity is tau^(k-1) u(tau) with u = (3, 4 + tau, tau^2).
    k, t = begins_with, np.zeros(1)

    def along(power: int) -> object:
        return lambda u: u ** (k + power) / (k + power)

    x, y = along(0), along(1)
    d = derivatives(
        lambda u: 3.0 * x(u),  # type: ignore[operator]
        lambda u: 4.0 * x(u) + y(u),  # type: ignore[operator]
        lambda u: along(2)(u),  # type: ignore[operator]
        t,
    )
    after, before = (attitude_along(limits(t, d, side).directions) for side in (AFTER, BEFORE))
    np.testing.assert_allclose(after.R_NB[0, :, 0], [0.6, 0.8, 0.0], atol=1e-15)
    np.testing.assert_allclose(
        before.R_NB[0, :, 0], (-1.0) ** (k - 1) * np.array([0.6, 0.8, 0.0]), atol=1e-15
    )
    # phi_z = atan2(4 + tau, 3): 3/25 rad/s, -24/625 rad/s^2; phi_y = -tau^2 / 5 to second order.
    for found, sign in ((after, 1.0), (before, (-1.0) ** (k - 1))):
        np.testing.assert_allclose(found.omega_NB_B[0], [0.0, 0.0, 0.12], atol=1e-15)
        np.testing.assert_allclose(found.alpha_NB_B[0], [0.0, -0.4 * sign, -24.0 / 625.0], atol=1e-14)


@pytest.mark.parametrize("side", [BEFORE, AFTER])
def test_through_the_vertical_the_pitch_turns_back_and_the_heading_flips(side: int) -> None:
    # Top speed upwards on a vertical circle at 1 rad/s: nose up, rate 1 rad/s about a y axis that flips.
    t = np.zeros(1)
    d = derivatives(lambda u: np.cos(u), zero, lambda u: np.sin(u), t)
    attitude = attitude_along(limits(t, d, side).directions)
    np.testing.assert_allclose(attitude.R_NB[0, :, 0], [0.0, 0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(attitude.R_NB[0, :, 1], [0.0, -side, 0.0], atol=1e-15)
    # In N the rate is -1 rad/s about y whatever the body's y axis is: from z towards -x.
    np.testing.assert_allclose(attitude.R_NB[0] @ attitude.omega_NB_B[0], [0.0, -1.0, 0.0], atol=1e-15)


def test_the_tail_of_a_slow_beginning_is_no_reversal() -> None:
    # 1e-7 s after a start with snap the velocity is far below round-off and the acceleration is not: the body
    # still moves forward on both sides.
    t = np.array([1e-7])
    d = derivatives(lambda u: 35.0 * u**4 + u**5, zero, zero, t)
    assert leading_series(t, d, AFTER)[0, 0, 0] > 0.0


def test_at_rest_nothing_leads() -> None:
    assert np.isnan(leading_series(np.zeros(1), np.zeros((6, 1, 3)), AFTER)).all()
    assert np.isnan(limits(np.zeros(1), np.zeros((6, 1, 3)), AFTER).directions.climb).all()
