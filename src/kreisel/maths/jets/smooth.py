"""Turns smooth functions of jets (sin, exp, powers, arctan2, ...) into jets.

A function of one variable is given by its Taylor series at the value, in closed form or by the recurrence of
its differential equation; `series.compose` does the rest. Recurrences are chosen so that no digits cancel
where the function itself keeps them (1 - tanh^2 is never formed from tanh).
"""

from collections.abc import Callable
from functools import partial
from math import comb, factorial
from typing import Any

import numpy as np

from kreisel.maths.jets import series
from kreisel.maths.jets.jet import UFUNC_RULES, Jet
from kreisel.maths.jets.rules import function_rule, lifted, ufunc_rule
from kreisel.maths.jets.series import Array, Row, Term

Taylor = Callable[[Array, int], list[Term]]  # value, order -> Taylor series there, weight of the first term 1


def applied(taylor: Taylor, x: Jet) -> Jet:
    """The function with this Taylor series, applied to a jet."""
    if len(x.rows) == 1:
        return Jet((taylor(_as_float(x.value), 0)[0][1],), x.order)
    return Jet(series.compose(taylor(_as_float(x.value), x.order), x.powers(), x.order), x.order)


def _as_float(value: Array) -> Array:
    return np.asarray(value, dtype=np.result_type(value, np.float64))


# --- exponentials and logarithms ---


def _exp(x: Array, order: int) -> list[Term]:
    return _exponential(np.exp(x), 1.0, order)


def _exp2(x: Array, order: int) -> list[Term]:
    return _exponential(np.exp2(x), np.log(2.0), order)


def _expm1(x: Array, order: int) -> list[Term]:
    return [(1.0, np.expm1(x)), *_exp(x, order)[1:]]


def _exponential(value: Row, slope: Row, order: int) -> list[Term]:
    if np.ndim(slope) == 0:
        return [(float(slope) ** k / factorial(k), value) for k in range(order + 1)]
    return [(1.0 / factorial(k), value * slope**k) for k in range(order + 1)]


def _log(x: Array, order: int, log: np.ufunc = np.log, unit: float = 1.0, shift: float = 0.0) -> list[Term]:
    value = log(x)
    ratio = np.where(np.isnan(value), np.nan, 1.0) / (x + shift)
    return [(1.0, value), *((-((-1.0) ** k) / (k * unit), ratio**k) for k in range(1, order + 1))]


def _logaddexp(x: Array, order: int) -> list[Term]:
    """log(1 + exp(x)): its slope s obeys s' = s (1 - s), with 1 - s as its own series, lest it cancel."""
    terms: list[Term] = [(1.0, np.logaddexp(0.0, x))]
    slope: list[Row] = [1.0 / (1.0 + np.exp(-x))]
    rest: list[Row] = [1.0 / (1.0 + np.exp(x))]
    for k in range(order):
        terms.append((1.0 / (k + 1), slope[k]))
        slope.append(series.total(slope[i] * rest[k - i] for i in range(k + 1)) / (k + 1))
        rest.append(-slope[-1])
    return terms


@ufunc_rule(np.logaddexp)
def _log_sum(x: Any, y: Any) -> Any:
    gap = y - x
    return x + applied(_logaddexp, gap)


# --- powers ---


def _raised(exponent: Row, x: Array, order: int) -> list[Term]:
    """x^p, each power of x formed by itself, so that whole powers are exact at 0 and others right there."""
    if np.ndim(exponent):
        return [
            (1.0, np.power(x, exponent)),
            *((1.0, _descended(x, exponent, k)) for k in range(1, order + 1)),
        ]
    p, weight = float(exponent), 1.0
    terms: list[Term] = [(1.0, _power(x, p) if p else np.ones_like(x))]
    for k in range(1, order + 1):
        weight *= (p - k + 1) / k
        if weight == 0.0:
            break
        terms.append((weight, _power(x, p - k)))
    return terms


def _power(x: Array, p: float) -> Row:
    if p in (0.0, 1.0):
        return x if p else 1.0
    return x * x if p == 2.0 else np.power(x, p)


def _descended(x: Array, exponent: Array, k: int) -> Array:
    weight = np.prod([(exponent - j) / (j + 1.0) for j in range(k)], axis=0)
    return np.where(weight == 0.0, 0.0, weight * np.power(x, exponent - k))


@ufunc_rule(np.power, np.float_power)
def _raise(x: Any, y: Any) -> Jet:
    order, (base, exponent) = lifted((x, y))
    if len(exponent) == 1:
        whole = x if isinstance(x, Jet) else Jet(base, order)
        return applied(partial(_raised, exponent[0]), whole)
    if len(base) == 1:
        return applied(partial(_raised_to, base[0]), y)
    grown: Jet = np.exp(y * np.log(x))
    return Jet((np.power(base[0], exponent[0]), *grown.rows[1:]), order)


def _raised_to(base: Array, x: Array, order: int) -> list[Term]:
    return _exponential(np.power(base, x), np.log(base), order)


def _sqrt(x: Array, order: int) -> list[Term]:
    return _root(np.sqrt(x), 0.5, x, order)


def _cbrt(x: Array, order: int) -> list[Term]:
    return _root(np.cbrt(x), 1.0 / 3.0, x, order)


def _root(root: Array, p: float, x: Array, order: int) -> list[Term]:
    """x^p for p = 1/2, 1/3; the first slope comes from the root, so that it is infinite at 0 and not nan."""
    slope, inverse, weight = p / root ** round(1.0 / p - 1.0), 1.0 / x, 1.0
    terms = [(1.0, root)]
    for k in range(1, order + 1):
        terms.append((weight, slope))
        weight *= (p - k) / (k + 1)
        slope = slope * inverse
    return terms


def _reciprocal(x: Array, order: int) -> list[Term]:
    inverse = 1.0 / x
    return [((-1.0) ** k, inverse ** (k + 1)) for k in range(order + 1)]


# --- circular and hyperbolic functions ---


def _cyclic(x: Jet, names: tuple[np.ufunc, np.ufunc], signs: tuple[float, ...], start: int) -> Jet:
    """sin, cos, sinh or cosh: their derivatives go round in a cycle of four."""
    if len(x.rows) == 1:
        return Jet((names[start](_as_float(x.value)),), x.order)
    pair = x.remember(names, lambda: tuple(name(_as_float(x.value)) for name in names))
    outer = [
        (signs[(start + k) % 4] / (signs[start] * factorial(k)), pair[(start + k) % 2])
        for k in range(x.order + 1)
    ]
    return Jet(series.compose(outer, x.powers(), x.order), x.order)


for _names, _signs in (
    ((np.sin, np.cos), (1.0, 1.0, -1.0, -1.0)),
    ((np.sinh, np.cosh), (1.0, 1.0, 1.0, 1.0)),
):
    for _start in (0, 1):
        UFUNC_RULES[_names[_start]] = partial(_cyclic, names=_names, signs=_signs, start=_start)


def _tan(x: Array, order: int) -> list[Term]:
    return _tangent(np.tan(x), 1.0 / np.cos(x) ** 2, 2.0, order)


def _tanh(x: Array, order: int) -> list[Term]:
    return _tangent(np.tanh(x), 1.0 / np.cosh(x) ** 2, -2.0, order)


def _tangent(value: Array, slope: Array, twice: float, order: int) -> list[Term]:
    """y' = w and w' = 2 y w (tan) or -2 y w (tanh)."""
    y: list[Row] = [value]
    w: list[Row] = [slope]
    for k in range(order):
        w.append(series.total(y[i] * w[k - i] for i in range(k + 1)) * (twice / (k + 1)))
        y.append(w[k] / (k + 1))
    return [(1.0, row) for row in y]


# --- their inverses ---


def _arcsin(x: Array, order: int) -> list[Term]:
    square = (1.0 - x) * (1.0 + x)
    return _inverse_sine(np.arcsin(x), 1.0 / np.sqrt(square), x / square, 1.0 / square, order)


def _arccos(x: Array, order: int) -> list[Term]:
    square = (1.0 - x) * (1.0 + x)
    return _inverse_sine(np.arccos(x), -1.0 / np.sqrt(square), x / square, 1.0 / square, order)


def _arcsinh(x: Array, order: int) -> list[Term]:
    size = np.hypot(1.0, x)
    return _inverse_sine(np.arcsinh(x), 1.0 / size, -x / size / size, -1.0 / size / size, order)


def _arccosh(x: Array, order: int) -> list[Term]:
    square = (x - 1.0) * (x + 1.0)
    return _inverse_sine(
        np.arccosh(x), 1.0 / (np.sqrt(x - 1.0) * np.sqrt(x + 1.0)), -x / square, -1.0 / square, order
    )


def _inverse_sine(value: Array, slope: Array, once: Array, twice: Array, order: int) -> list[Term]:
    """y' = b and q b' = +-x b, so (m+1) b_(m+1) = (2m+1) once b_m + m twice b_(m-1), with +-x/q and +-1/q."""
    terms, b = [(1.0, value)], [slope]
    for m in range(order):
        terms.append((1.0 / (m + 1), b[m]))
        step = once * b[m] * ((2 * m + 1) / (m + 1))
        b.append(step + twice * b[m - 1] * (m / (m + 1)) if m else step)
    return terms


def _arctan(x: Array, order: int) -> list[Term]:
    size = np.hypot(1.0, x)
    return _inverse_tangent(
        np.arctan(x), 1.0 / size / size, -2.0 * (x / size / size), -1.0 / size / size, order
    )


def _arctanh(x: Array, order: int) -> list[Term]:
    value = np.arctanh(x)
    slope = np.where(np.isnan(value), np.nan, 1.0) / ((1.0 - x) * (1.0 + x))
    return _inverse_tangent(value, slope, 2.0 * x * slope, slope, order)


def _inverse_tangent(value: Array, slope: Array, once: Array, twice: Array, order: int) -> list[Term]:
    """y' = b = 1 / (1 +- x^2): b_m = once b_(m-1) + twice b_(m-2)."""
    terms, b = [(1.0, value)], [slope]
    for m in range(order):
        terms.append((1.0 / (m + 1), b[m]))
        b.append(once * b[m] + twice * b[m - 1] if m else once * b[m])
    return terms


@ufunc_rule(np.arctan2)
def _arctan2(y: Any, x: Any) -> Jet:
    order, (a, b) = lifted((y, x))
    value = np.arctan2(a[0], b[0])
    if order == 0:
        return Jet((value,), order)
    turn = series.subtract(
        series.product(b, series.derivative(a), order - 1), series.product(a, series.derivative(b), order - 1)
    )
    square = series.add(series.product(a, a, order - 1), series.product(b, b, order - 1))
    return Jet(series.integral(value, series.quotient(turn, square, order - 1)), order)


@ufunc_rule(np.hypot)
def hypot(x: Any, y: Any) -> Jet:
    """The length of (x, y); nan derivatives where it is 0."""
    order, (a, b) = lifted((x, y))
    square = series.add(series.product(a, a, order), series.product(b, b, order))
    return Jet(series.square_root(np.hypot(a[0], b[0]), square, order), order)


# --- sinc ---

# Below this argument the power series, above it y f^(k) + k f^(k-1) = sin^(k)(y), which loses k!/y^k.
_SINC_SWITCH = 3.0
_SINC_TERMS = 20


@function_rule(np.sinc)
def _sinc(x: Jet) -> Jet:
    return applied(_sine_quotient, np.pi * x)


def _sine_quotient(y: Array, order: int) -> list[Term]:
    near = np.abs(y) < _SINC_SWITCH
    rows = _sinc_far(np.where(near, _SINC_SWITCH, y), order)
    for k in range(order + 1):
        rows[k] = np.where(near, _sinc_near(np.where(near, y, 0.0), k), rows[k])
    return [(1.0, row) for row in rows]


def _sinc_far(y: Array, order: int) -> list[Array]:
    cycle = (np.sin(y), np.cos(y))
    rows = [cycle[0] / y]
    for k in range(1, order + 1):
        sine = cycle[k % 2] * ((1.0, 1.0, -1.0, -1.0)[k % 4] / factorial(k))
        rows.append((sine - rows[-1]) / y)
    return rows


def _sinc_near(y: Array, k: int) -> Array:
    coefficients = [
        (-1.0) ** m * comb(2 * m, k) / factorial(2 * m + 1) for m in range((k + 1) // 2, _SINC_TERMS)
    ]
    return np.asarray(np.polyval(coefficients[::-1], y * y) * y ** (k % 2))


_TAYLOR: dict[np.ufunc, Taylor] = {
    np.exp: _exp,
    np.exp2: _exp2,
    np.expm1: _expm1,
    np.log: _log,
    np.log2: partial(_log, log=np.log2, unit=np.log(2.0)),
    np.log10: partial(_log, log=np.log10, unit=np.log(10.0)),
    np.log1p: partial(_log, log=np.log1p, shift=1.0),
    np.sqrt: _sqrt,
    np.cbrt: _cbrt,
    np.reciprocal: _reciprocal,
    np.tan: _tan,
    np.tanh: _tanh,
    np.arcsin: _arcsin,
    np.arccos: _arccos,
    np.arctan: _arctan,
    np.arcsinh: _arcsinh,
    np.arccosh: _arccosh,
    np.arctanh: _arctanh,
}
UFUNC_RULES.update({ufunc: partial(applied, taylor) for ufunc, taylor in _TAYLOR.items()})
