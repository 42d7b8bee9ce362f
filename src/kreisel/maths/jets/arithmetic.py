"""Turns sums, differences, products and quotients of jets into jets."""

from typing import Any

import numpy as np

from kreisel.maths.jets import series
from kreisel.maths.jets.jet import Jet
from kreisel.maths.jets.rules import lifted, ufunc_rule
from kreisel.maths.jets.series import Series

_NUMBERS = (int, float, np.int64, np.float64)


@ufunc_rule(np.add)
def _add(x: Any, y: Any) -> Jet:
    return _remembered("+", x, y)


@ufunc_rule(np.subtract)
def _subtract(x: Any, y: Any) -> Jet:
    return _remembered("-", x, y)


@ufunc_rule(np.multiply)
def _multiply(x: Any, y: Any) -> Jet:
    return _remembered("*", x, y)


@ufunc_rule(np.divide)
def _divide(x: Any, y: Any) -> Jet:
    return _remembered("/", x, y)


def _remembered(sign: str, x: Any, y: Any) -> Jet:
    # A trajectory names its argument again and again, cos(w t), sin(w t): handing out one series for one w t
    # lets them share sin and cos, most of the work. Keeping more than short series would outgrow the cache.
    jet, number, side = (x, y, "left") if isinstance(x, Jet) else (y, x, "right")
    if type(number) not in _NUMBERS or len(jet.rows) > 2:
        return _calculated(sign, x, y)
    kept: Jet = jet.remember((sign, side, number), lambda: _calculated(sign, x, y))
    return kept.twin()


def _calculated(sign: str, x: Any, y: Any) -> Jet:
    order, (a, b) = lifted((x, y))
    return Jet(_rows(sign, a, b, order), order)


def _rows(sign: str, a: Series, b: Series, order: int) -> Series:
    if sign == "+":
        return series.add(a, b)
    if sign == "-":
        return series.subtract(a, b)
    return series.product(a, b, order) if sign == "*" else series.quotient(a, b, order)


@ufunc_rule(np.negative)
def _negative(x: Jet) -> Jet:
    return Jet(series.negate(x.rows), x.order)


@ufunc_rule(np.positive)
def _positive(x: Jet) -> Jet:
    return x.twin()


@ufunc_rule(np.square)
def _square(x: Jet) -> Jet:
    return _calculated("*", x, x)


@ufunc_rule(np.deg2rad, np.radians)
def _radians(x: Jet) -> Jet:
    return Jet(series.scale(x.rows, np.pi / 180.0), x.order)


@ufunc_rule(np.rad2deg, np.degrees)
def _degrees(x: Jet) -> Jet:
    return Jet(series.scale(x.rows, 180.0 / np.pi), x.order)


@ufunc_rule(np.conjugate)
def _conjugate(x: Jet) -> Jet:
    return Jet(series.linear(np.conjugate, [x.rows]), x.order)
