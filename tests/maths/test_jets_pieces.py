"""Functions made of pieces: kinks from the right, clean selection, steps without derivatives, tables."""

import warnings
from typing import Any

import numpy as np
import pytest

from kreisel.maths.jets import Jet, differentiate

T = np.array([-2.5, -1.0, -0.25, 0.0, 0.25, 1.0, 2.5])


def slope(function: Any, t: float) -> float:
    return float(differentiate(function, [t], 2)[1, 0])


@pytest.mark.parametrize(
    ("function", "t", "expected"),
    [
        (abs, 0.0, 1.0),
        (lambda t: abs(-t), 0.0, 1.0),
        (lambda t: abs(t * t * t - t), 0.0, 1.0),
        (lambda t: np.maximum(t, 0), 0.0, 1.0),
        (lambda t: np.maximum(0, t), 0.0, 1.0),
        (lambda t: np.maximum(-t, 0), 0.0, 0.0),
        (lambda t: np.minimum(t, 0), 0.0, 0.0),
        (lambda t: np.minimum(0, -t), 0.0, -1.0),
        (lambda t: np.minimum(t, t * t), 1.0, 1.0),
        (lambda t: np.fmax(t, 0), 0.0, 1.0),
        (lambda t: np.fmin(t, 0), 0.0, 0.0),
        (lambda t: np.clip(t, 0, 1), 0.0, 1.0),
        (lambda t: np.clip(t, 0, 1), 1.0, 0.0),
        (lambda t: np.clip(1 - t, 0, 1), 0.0, -1.0),
        (lambda t: np.interp(t, [0, 1, 3], [0, 2, 0]), 0.0, 2.0),
        (lambda t: np.interp(t, [0, 1, 3], [0, 2, 0]), 1.0, -1.0),
        (lambda t: np.interp(t, [0, 1, 3], [0, 2, 0]), 3.0, 0.0),
        (lambda t: np.interp(2 - t, [0, 1, 3], [0, 2, 0]), 1.0, -2.0),
        (lambda t: np.interp(-t, [0, 1, 3], [0, 2, 0]), 0.0, 0.0),
        (lambda t: np.where(t > 1, 5 * t, t), 1.0, 1.0),
        (lambda t: np.where(t >= 1, 5 * t, t), 1.0, 5.0),
        (lambda t: t % 1, 2.0, 1.0),
        (lambda t: np.copysign(t, 1), 0.0, 1.0),
    ],
)
def test_derivative_from_the_right_at_a_kink(function: Any, t: float, expected: float) -> None:
    assert slope(function, t) == expected


def test_kink_of_a_higher_order() -> None:
    # t^3 and 0 touch at 0 in value and two derivatives; the third decides which is larger just after.
    found = differentiate(lambda t: np.maximum(t**3, 0), [0.0], 3)[:, 0]
    np.testing.assert_array_equal(found, [0.0, 0.0, 0.0, 6.0])


def test_nan_follows_numpy() -> None:
    found = differentiate(
        lambda t: (np.maximum(np.sqrt(t), 1 + 0 * t), np.fmax(np.sqrt(t), 2 * t), t), [-1.0], 1
    )
    assert np.isnan(found[0, 0, 0])
    np.testing.assert_array_equal(found[:, 0, 1], [-2.0, 2.0])


@pytest.mark.parametrize(
    "function",
    [
        lambda t: np.where(t > 0, np.sqrt(t), 0),
        lambda t: np.select([t > 0, t <= 0], [np.sqrt(t), 0]),
        lambda t: np.piecewise(t, [t > 0], [np.sqrt, 0.0]),
        lambda t: np.piecewise(t, t > 0, [np.sqrt, lambda x: 0 * x]),
    ],
)
def test_a_piece_that_is_not_selected_leaves_no_trace(function: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = differentiate(function, T, 3)
    np.testing.assert_array_equal(found[:, T <= 0], 0.0)
    right = T[T > 0]
    np.testing.assert_allclose(found[:2, T > 0], [np.sqrt(right), 0.5 / np.sqrt(right)], rtol=1e-15)


def test_assigning_to_selected_samples() -> None:
    def function(t: Jet) -> Jet:
        x = np.zeros_like(t)
        x[t > 0] = t[t > 0] ** 2
        x[(t > 1) & ~(t > 2)] += 3.0
        return x

    found = differentiate(function, T, 2)
    np.testing.assert_array_equal(found[0], np.where(T > 0, T**2, 0) + 0.0)
    np.testing.assert_array_equal(found[1], np.where(T > 0, 2 * T, 0))
    np.testing.assert_array_equal(found[2], np.where(T > 0, 2.0, 0))


@pytest.mark.parametrize(
    "function",
    [
        *(np.sign, np.floor, np.ceil, np.trunc, np.rint, np.round, np.fix, np.isfinite, np.signbit),
        lambda t: np.round(10 * t, 1),
        lambda t: t // 0.7,
        lambda t: np.heaviside(t, 0.5),
        lambda t: (t > 0) * 1.0,
        lambda t: (t > 0).astype(float),
        lambda t: 1.0 * ((t > 0) & (t < 1) | (t == -1) ^ (t != 1)),
        lambda t: 1.0 * np.logical_or(t >= 1, np.logical_not(t <= -1)),
        lambda t: np.isclose(t, 1.0) * 2.0,
        lambda t: np.modf(t)[1],
        lambda t: divmod(t, 0.7)[0],
    ],
)
def test_steps_have_values_and_no_derivatives(function: Any) -> None:
    found = differentiate(function, T, 3)
    np.testing.assert_array_equal(found[0], np.asarray(function(T), dtype=float))
    np.testing.assert_array_equal(found[1:], 0.0)


def test_select_takes_the_first_condition_that_holds() -> None:
    def function(t: Any) -> Any:
        return np.select([t > 1, t > -1], [t**2, 3 * t], default=-7.0)

    found = differentiate(function, T, 1)
    np.testing.assert_array_equal(found[0], function(T))
    np.testing.assert_array_equal(found[1], np.where(T > 1, 2 * T, np.where(T > -1, 3.0, 0.0)))


def test_piecewise_with_several_conditions() -> None:
    def function(t: Any) -> Any:
        return np.piecewise(t, [t < -1, t >= 1], [lambda x: -x, lambda x, k=2: x**k, 4.0])

    found = differentiate(function, T, 1)
    np.testing.assert_array_equal(found[0], function(T))
    np.testing.assert_array_equal(found[1], np.select([T < -1, T >= 1], [-1.0, 2 * T], 0.0))


@pytest.mark.parametrize("options", [{}, {"left": -1.0, "right": 9.0}, {"period": 1.7}, {"period": -0.4}])
def test_table_has_the_slope_of_its_pieces(options: dict[str, float]) -> None:
    knots, heights = np.array([-1.0, 0.1, 0.4, 2.0]), np.array([3.0, -1.0, 0.5, 0.6])

    def function(t: Any) -> Any:
        return np.interp(0.3 * t * t - 1, knots, heights, **options)

    t, step = np.linspace(-4.0, 4.0, 57) + 0.003, 1e-6
    found = differentiate(function, t, 3)
    np.testing.assert_array_equal(found[0], function(t))
    # Central differences of a piecewise parabola are exact but for round-off, 1e-16 / 1e-6; no knot is near.
    np.testing.assert_allclose(found[1], (function(t + step) - function(t - step)) / (2 * step), atol=2e-8)
    np.testing.assert_allclose(found[2] * t, found[1], atol=1e-12)
    np.testing.assert_array_equal(found[3], 0.0)


def test_a_condition_selects_from_plain_arrays() -> None:
    def function(t: Any) -> Any:
        x = np.ones(len(t))
        x[t > 0] = 2.0
        return x * t

    np.testing.assert_array_equal(differentiate(function, T, 1), [function(T), np.where(T > 0, 2.0, 1.0)])
