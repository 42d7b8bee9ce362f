"""Every derivative rule against mpmath at 50 digits, alone and inside one another."""

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kreisel.maths import jets
from kreisel.maths.jets import Jet, differentiate
from kreisel.maths.jets.evaluate import BLOCK
from kreisel.maths.jets.smooth import _SINC_SWITCH

ORDER = 5

# At order 5 some 20 products add up, each good to 1e-16; they cancel by a factor of 10 or so where x^y does.
TOLERANCE = 2e-13

WIDE, POSITIVE, UNIT, ABOVE_ONE = (
    (-2.1, -0.4, 0.3, 1.7),
    (0.2, 0.9, 1.6, 30.0),
    (-0.8, -0.1, 0.4, 0.7),
    (1.3, 2.0, 40.0),
)


def oracle(function: Callable[[Any], Any], points: Any, order: int) -> np.ndarray:
    """Derivatives 0..order at the points, from mpmath at 50 digits."""
    with mp.workdps(50):
        columns = [mp.taylor(function, mp.mpf(float(p)), order) for p in points]
        return np.array([[float(c[k] * mp.factorial(k)) for c in columns] for k in range(order + 1)])


def assert_same(
    function: Callable[[Any], Any], exact: Callable[[Any], Any], points: Any, order: int = ORDER
) -> None:
    expected = oracle(exact, points, order)
    # All functions here are of order 1; a derivative that vanishes is measured against that.
    scale = np.maximum(np.abs(expected).max(axis=1, keepdims=True), 0.1)
    error = np.abs(differentiate(function, points, order) - expected) / scale
    assert error.max() < TOLERANCE, error


RULES: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any], tuple[float, ...]]] = {
    "add": (lambda x: 2 + x + x, lambda x: 2 + 2 * x, WIDE),
    "subtract": (lambda x: 2 - x - 3 * x, lambda x: 2 - 4 * x, WIDE),
    "subtract longer": (lambda x: x - x * x * x, lambda x: x - x**3, WIDE),
    "negative": (lambda x: -(+x), lambda x: -x, WIDE),
    "multiply": (lambda x: x * (x * x), lambda x: x**3, WIDE),
    "divide by jet": (lambda x: (1 + x) / (5 + x * x), lambda x: (1 + x) / (5 + x * x), WIDE),
    "divide number": (lambda x: 2.0 / x, lambda x: 2 / x, WIDE),
    "divide by number": (lambda x: x / 3.0, lambda x: x / 3, WIDE),
    "square": (np.square, lambda x: x * x, WIDE),
    "reciprocal": (np.reciprocal, lambda x: 1 / x, WIDE),
    "power 0": (lambda x: x**0, lambda x: mp.mpf(1), WIDE),
    "power 1": (lambda x: x**1, lambda x: x, WIDE),
    "power 3": (lambda x: x**3, lambda x: x**3, WIDE),
    "power 7": (lambda x: np.power(x, 7), lambda x: x**7, WIDE),
    "power -2": (lambda x: x**-2, lambda x: x**-2, WIDE),
    "power 1.5": (lambda x: x**1.5, lambda x: x ** mp.mpf("1.5"), POSITIVE),
    "power -0.3": (lambda x: np.float_power(x, -0.3), lambda x: x ** mp.mpf(-0.3), POSITIVE),
    "power of number": (lambda x: 2.5**x, lambda x: mp.mpf(2.5) ** x, WIDE),
    "power of jet": (lambda x: x ** (1 + x * x / 100), lambda x: x ** (1 + x * x / 100), (0.9, 1.2, 1.6)),
    "sqrt": (np.sqrt, mp.sqrt, POSITIVE),
    "cbrt": (np.cbrt, mp.cbrt, POSITIVE),
    "cbrt negative": (np.cbrt, lambda x: -mp.cbrt(-x), (-3.0, -0.7)),
    "exp": (np.exp, mp.exp, WIDE),
    "exp2": (np.exp2, lambda x: mp.mpf(2) ** x, WIDE),
    "expm1": (np.expm1, mp.expm1, (1e-9, *WIDE)),
    "log": (np.log, mp.log, POSITIVE),
    "log2": (np.log2, lambda x: mp.log(x) / mp.log(2), POSITIVE),
    "log10": (np.log10, mp.log10, POSITIVE),
    "log1p": (np.log1p, mp.log1p, (1e-9, -0.3, 0.4, 3.0)),
    "logaddexp": (
        lambda x: np.logaddexp(1, 3 * x),
        lambda x: mp.log(mp.e + mp.exp(3 * x)),
        (-30.0, *WIDE, 30.0),
    ),
    "sin": (np.sin, mp.sin, (-30.0, *WIDE)),
    "cos": (np.cos, mp.cos, (-30.0, *WIDE)),
    "tan": (np.tan, mp.tan, (-1.2, 0.1, 1.4)),
    "secant": (lambda x: 1 / np.cos(x), mp.sec, (-1.2, 0.1, 1.2)),
    "sinh": (np.sinh, mp.sinh, WIDE),
    "cosh": (np.cosh, mp.cosh, WIDE),
    "tanh": (np.tanh, mp.tanh, WIDE),
    "tanh far": (np.tanh, mp.tanh, (17.0, 17.5, 18.0)),
    "arcsin": (np.arcsin, mp.asin, UNIT),
    "arccos": (np.arccos, mp.acos, UNIT),
    "arctan": (np.arctan, mp.atan, (*WIDE, 50.0)),
    "arcsinh": (np.arcsinh, mp.asinh, (*WIDE, 50.0)),
    "arccosh": (np.arccosh, mp.acosh, ABOVE_ONE),
    "arctanh": (np.arctanh, mp.atanh, UNIT),
    "arctan2": (lambda x: np.arctan2(x, x * x - 2), lambda x: mp.atan2(x, x * x - 2), WIDE),
    "arctan2 number": (lambda x: np.arctan2(2.0, x), lambda x: mp.atan2(2, x), WIDE),
    "hypot": (lambda x: np.hypot(x, 1 + x * x), lambda x: mp.sqrt(x**2 + (1 + x * x) ** 2), WIDE),
    "hypot number": (lambda x: np.hypot(x, 2.0), lambda x: mp.sqrt(x**2 + 4), WIDE),
    "deg2rad": (lambda x: np.sin(np.deg2rad(x)), lambda x: mp.sin(x * mp.pi / 180), WIDE),
    "degrees": (lambda x: np.degrees(np.sin(x)), lambda x: mp.sin(x) * 180 / mp.pi, WIDE),
    "sinc": (np.sinc, lambda x: mp.sin(mp.pi * x) / (mp.pi * x), (1e-7, 0.01, *WIDE)),
    "polyval": (lambda x: np.polyval([3, 0, -1, 2, 1], x), lambda x: 3 * x**4 - x * x + 2 * x + 1, WIDE),
    "poly1d": (np.poly1d([2, 1, 0]), lambda x: 2 * x * x + x, WIDE),
    "abs": (np.abs, abs, WIDE),
    "fabs": (np.fabs, abs, WIDE),
    "builtin abs": (abs, abs, WIDE),
    "mod": (lambda x: (x * x) % 0.7, lambda x: x * x - mp.mpf(0.7) * mp.floor(x * x / mp.mpf(0.7)), WIDE),
    "mod of jet": (lambda x: 7 % (3 + x), lambda x: 7 - (3 + x) * mp.floor(7 / (3 + x)), WIDE),
    "fmod": (lambda x: np.fmod(x * x * x, 0.7), lambda x: x**3 - mp.mpf(0.7) * int(x**3 / mp.mpf(0.7)), WIDE),
    "divmod": (lambda x: divmod(x, 0.7)[1], lambda x: x - mp.mpf(0.7) * mp.floor(x / mp.mpf(0.7)), WIDE),
    "modf": (lambda x: np.modf(x * x)[0], lambda x: x * x - mp.floor(x * x), WIDE),
    "maximum": (lambda x: np.maximum(x, x * x), lambda x: max(x, x * x), WIDE),
    "minimum": (lambda x: np.minimum(x, x * x), lambda x: min(x, x * x), WIDE),
    "fmax": (lambda x: np.fmax(x, 0.1), lambda x: max(x, mp.mpf(0.1)), WIDE),
    "fmin": (lambda x: np.fmin(x, 0.1), lambda x: min(x, mp.mpf(0.1)), WIDE),
    "copysign": (lambda x: np.copysign(x * x, -x), lambda x: -x * abs(x), WIDE),
    "clip": (lambda x: np.clip(x * x, 0.1, 2.0), lambda x: min(max(x * x, mp.mpf(0.1)), mp.mpf(2)), WIDE),
    "where": (lambda x: np.where(x > 0, np.sin(x), x * x), lambda x: mp.sin(x) if x > 0 else x * x, WIDE),
    "phasor": (lambda x: np.exp(2j * x).imag, lambda x: mp.sin(2 * x), WIDE),
    "phasor length": (lambda x: np.abs((1 + 1j * x) ** 2), lambda x: 1 + x * x, WIDE),
    "phasor angle": (lambda x: np.angle(1 + 1j * x), mp.atan, WIDE),
    "conjugate": (lambda x: np.imag(np.conj(1j * x)), lambda x: -x, WIDE),
}


@pytest.mark.parametrize("name", RULES)
def test_rule_of_the_time(name: str) -> None:
    function, exact, points = RULES[name]
    assert_same(function, exact, points)


@pytest.mark.parametrize("name", RULES)
def test_rule_of_a_curved_argument(name: str) -> None:
    function, exact, points = RULES[name]
    assert_same(lambda t: function(t + 0.01 * t * t), lambda t: exact(t + mp.mpf(0.01) * t * t), points)


@pytest.mark.parametrize("offset", [-1e-9, 0.0, 1e-9])
def test_sinc_around_its_switch(offset: float) -> None:
    point = _SINC_SWITCH / np.pi + offset
    assert_same(np.sinc, lambda x: mp.sin(mp.pi * x) / (mp.pi * x), (point, -point, 0.9 * point, 1.1 * point))


def test_sinc_at_zero() -> None:
    expected = [1.0, 0.0, -(np.pi**2) / 3, 0.0, np.pi**4 / 5, 0.0]
    np.testing.assert_allclose(differentiate(np.sinc, [0.0], 5)[:, 0], expected, rtol=1e-15, atol=0.0)


def test_figure_1_loop_to_order_4() -> None:
    f = 0.125
    t = np.linspace(0.0, 16.0, 33)

    def loop(t: Any) -> Any:
        turn = 2 * np.pi * f * t
        return 0.8 * np.cos(turn), 0.8 * np.sin(turn), 0.3 * np.cos(2 * np.pi * 3 * f * t)

    w, found = mp.mpf(2 * np.pi * f), differentiate(loop, t, 4)
    exact = (
        lambda t: mp.mpf(0.8) * mp.cos(w * t),
        lambda t: mp.mpf(0.8) * mp.sin(w * t),
        lambda t: mp.mpf(0.3) * mp.cos(mp.mpf(2 * np.pi * 3 * f) * t),
    )
    for i, component in enumerate(exact):
        expected = oracle(component, t, 4)
        error = np.abs(found[:, :, i] - expected).max(axis=1) / np.abs(expected).max(axis=1)
        # The argument w t itself is rounded: half an ulp of 12 turns is 5e-15 in phase.
        assert error.max() < 7e-15


def test_speed_and_heading_of_the_tangent() -> None:
    def velocity(t: Jet) -> tuple[Jet, Jet]:
        return (0.8 * np.cos(t)).rate(), (0.4 * np.sin(2 * t)).rate()

    def exact(t: Any) -> Any:
        return mp.atan2(mp.mpf(0.8) * mp.cos(2 * t), -mp.mpf(0.8) * mp.sin(t))

    t = np.array([0.3, 1.1, 2.0, 4.0, 5.5])
    x, y = velocity(Jet.variable(t, 4))
    heading = np.arctan2(y, x)
    found = np.array([heading.derivative(k) for k in range(4)])
    expected = oracle(exact, t, 3)
    assert np.abs(found - expected).max() < TOLERANCE * np.abs(expected).max()


# --- random compositions ---

_UNARY: list[tuple[Callable[[Any], Any], Callable[[Any], Any]]] = [
    (np.sin, mp.sin),
    (np.cos, mp.cos),
    (np.tanh, mp.tanh),
    (np.arctan, mp.atan),
    (lambda x: np.exp(np.sin(x)), lambda x: mp.exp(mp.sin(x))),
    (lambda x: np.sqrt(1 + x * x), lambda x: mp.sqrt(1 + x * x)),
    (lambda x: np.log(2 + np.cos(x)), lambda x: mp.log(2 + mp.cos(x))),
]
_BINARY: list[tuple[Callable[[Any, Any], Any], Callable[[Any, Any], Any]]] = [
    (lambda x, y: x + y, lambda x, y: x + y),
    (lambda x, y: x - y, lambda x, y: x - y),
    (lambda x, y: np.sin(x) * y, lambda x, y: mp.sin(x) * y),
    (lambda x, y: x / (2 + np.cos(y)), lambda x, y: x / (2 + mp.cos(y))),
    (lambda x, y: np.arctan2(x, 1.5 + y * y), lambda x, y: mp.atan2(x, 1.5 + y * y)),
    (lambda x, y: np.hypot(x, 1 + np.cos(y) ** 2), lambda x, y: mp.sqrt(x * x + (1 + mp.cos(y) ** 2) ** 2)),
]

Pair = tuple[Callable[[Any], Any], Callable[[Any], Any]]
_LEAVES: list[Pair] = [
    (lambda t: t, lambda t: t),
    (lambda t: 0.7 * t + 0.2, lambda t: mp.mpf(0.7) * t + mp.mpf(0.2)),
    (lambda t: 1.3 + 0 * t, lambda t: mp.mpf(1.3) + 0 * t),
]


def _nest(outer: Pair, inner: Pair) -> Pair:
    return lambda t: outer[0](inner[0](t)), lambda t: outer[1](inner[1](t))


def _join(outer: Any, x: Pair, y: Pair) -> Pair:
    return lambda t: outer[0](x[0](t), y[0](t)), lambda t: outer[1](x[1](t), y[1](t))


COMPOSITIONS: st.SearchStrategy[Pair] = st.recursive(
    st.sampled_from(_LEAVES),
    lambda parts: (
        st.builds(_nest, st.sampled_from(_UNARY), parts)
        | st.builds(_join, st.sampled_from(_BINARY), parts, parts)
    ),
    max_leaves=5,
)


@settings(max_examples=60, deadline=None, print_blob=True)
@given(pair=COMPOSITIONS, t=st.floats(-2.0, 2.0))
def test_random_compositions(pair: Pair, t: float) -> None:
    found, expected = differentiate(pair[0], [t], 4)[:, 0], oracle(pair[1], [t], 4)[:, 0]
    # Nested terms of either sign may cancel: their size is that of the largest derivative, not of each.
    assert np.all(np.abs(found - expected) <= 1e-11 * (1.0 + np.abs(expected).max()))


# --- values where powers and roots are special ---


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (lambda t: t**0, [1, 0, 0, 0, 0]),
        (lambda t: t**1, [0, 1, 0, 0, 0]),
        (lambda t: t**2, [0, 0, 2, 0, 0]),
        (lambda t: t**3, [0, 0, 0, 6, 0]),
        (lambda t: t**3.0, [0, 0, 0, 6, 0]),
        (lambda t: (t + t * t) ** 2, [0, 0, 2, 12, 24]),
        (lambda t: t ** np.array([2.0]), [0, 0, 2, 0, 0]),
        (lambda t: np.power(t, 5) / (1 + t), [0, 0, 0, 0, 0]),
        (lambda t: t**2.5, [0, 0, 0, np.inf, -np.inf]),
        (np.sqrt, [0, np.inf, -np.inf, np.inf, -np.inf]),
        (np.cbrt, [0, np.inf, -np.inf, np.inf, -np.inf]),
        (lambda t: 0**t, [1, -np.inf, np.inf, -np.inf, np.inf]),
    ],
)
def test_powers_at_zero(function: Any, expected: list[float]) -> None:
    np.testing.assert_array_equal(differentiate(function, [0.0], 4)[:, 0], expected)


@pytest.mark.parametrize("function", [np.log, np.arctanh, np.sqrt, np.arcsin, np.arccosh, lambda t: t**0.5])
def test_derivatives_are_undefined_where_the_value_is(function: Any) -> None:
    assert np.all(np.isnan(differentiate(lambda t: function(t - 7.0), [0.5], 3)))


# --- blocks, inputs, constants ---


def _busy(t: Jet) -> Any:
    # Library loops for vectors and for their tails agree to the bit in arithmetic, roots and exp.
    return (
        np.where(t > 0.2, np.sqrt(1 + t * t), np.exp(-t)) / (2 + t)
        + np.interp(t, [0, 0.5, 1], [0, 2, 1]) * t**3
    )


def test_blocks_do_not_change_a_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    t = np.linspace(0.0, 1.0, 2 * BLOCK + 3)
    whole = differentiate(_busy, t, 4)
    assert whole.shape == (5, t.size)
    for block in (1000, t.size):
        monkeypatch.setattr(jets.evaluate, "BLOCK", block)
        np.testing.assert_array_equal(differentiate(_busy, t, 4), whole)


def test_input_is_untouched() -> None:
    t = np.linspace(-1.0, 1.0, 50)
    before = t.copy()

    def ramp(time: Jet) -> Jet:
        time -= 0.5
        time[time < 0] = 0.0
        return time

    found = differentiate(ramp, t, 1)
    np.testing.assert_array_equal(t, before)
    np.testing.assert_array_equal(found, [np.maximum(t - 0.5, 0.0), (t >= 0.5) * 1.0])


def test_assigning_leaves_equal_expressions_alone() -> None:
    def function(t: Jet) -> Any:
        first, second = 2 * t, 2 * t
        first[t > 0] = 0.0
        return first, second, np.sin(2 * t)

    found = differentiate(function, [-1.0, 1.0], 1)
    np.testing.assert_array_equal(found[0, 1], [0.0, 2.0, np.sin(2.0)])
    np.testing.assert_array_equal(found[1, 1], [0.0, 2.0, 2 * np.cos(2.0)])


@pytest.mark.parametrize("n", [0, 1, 2, 3, 4, BLOCK + 1, BLOCK + 3])
def test_any_number_of_samples(n: int) -> None:
    t = np.linspace(0.0, 1.0, n)
    found = differentiate(lambda t: np.stack([t, t * t, 0 * t + 1]), t, 2)
    one = np.ones(n)
    np.testing.assert_array_equal(found[0], np.column_stack([t, t * t, one]))
    np.testing.assert_array_equal(found[1], np.column_stack([one, 2 * t, 0 * t]))
    np.testing.assert_array_equal(found[2], np.column_stack([0 * t, 2 * one, 0 * t]))


def test_derivative_and_rate() -> None:
    jet = Jet.variable([1.0, 2.0], 3) ** 3
    np.testing.assert_array_equal(jet.derivative(2), [6.0, 12.0])
    np.testing.assert_array_equal(jet.rate().derivative(1), [6.0, 12.0])
    assert jet.rate().order == 2
    jet.derivative(0)[:] = 0.0
    np.testing.assert_array_equal(jet.derivative(0), [1.0, 8.0])
    with pytest.raises(ValueError, match=r"0\.\.3; got 4"):
        jet.derivative(4)
    with pytest.raises(ValueError, match="order 0"):
        Jet.variable([1.0], 0).rate()
