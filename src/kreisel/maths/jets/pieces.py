"""Turns functions made of pieces (comparisons, abs, floor, mod, where, clip, interp, ...) of jets into jets.

Selecting copies coefficients and never multiplies them by 0, so that an infinite or undefined piece that was
not selected leaves no trace: where(t > 0, sqrt(t), 0) is clean for all t.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from kreisel.maths.jets import refusals, series
from kreisel.maths.jets.jet import UFUNC_RULES, Jet
from kreisel.maths.jets.rules import constant, function_rule, lifted, plain, ufunc_rule, values
from kreisel.maths.jets.series import Array, Series
from kreisel.maths.jets.smooth import hypot

# --- constant between jumps ---

_STEPS = (
    *(np.greater, np.greater_equal, np.less, np.less_equal, np.equal, np.not_equal),
    *(np.logical_and, np.logical_or, np.logical_xor, np.logical_not),
    *(np.bitwise_and, np.bitwise_or, np.bitwise_xor, np.invert, np.isfinite, np.isnan, np.isinf, np.signbit),
    *(np.sign, np.floor, np.ceil, np.trunc, np.rint, np.heaviside, np.floor_divide),
)


def _step(function: Callable[..., Any]) -> Callable[..., Jet]:
    def rule(*operands: Any, **options: Any) -> Jet:
        jets = [x for x in operands if isinstance(x, Jet)]
        return constant(jets, function(*values(operands), **options))

    return rule


UFUNC_RULES.update({ufunc: _step(ufunc) for ufunc in _STEPS})
function_rule(np.fix)(_step(np.fix))
function_rule(np.isclose)(_step(np.isclose))


@function_rule(np.round, np.around)
def _round(a: Jet, decimals: int = 0) -> Jet:
    return constant([a], np.round(a.value, decimals))


# --- selection ---


def select(mask: Array, x: Series, y: Series) -> Series:
    """The series that is x where mask holds and y elsewhere, as a copy."""
    return series.linear(lambda a, b: np.where(mask, a, b), [x, y])


def exceeds(x: Series, y: Series) -> Array:
    """Where x > y just to the right of this time, or x = y in every order that is known."""
    larger, undecided = np.greater(x[0], y[0]), np.equal(x[0], y[0])
    for k in range(1, max(len(x), len(y))):
        if not np.any(undecided):
            break
        a, b = series.row_of(x, k), series.row_of(y, k)
        larger = larger | (undecided & np.greater(a, b))
        undecided = undecided & np.equal(a, b)
    return np.asarray(larger | undecided)


@function_rule(np.where)
def _where(condition: Any, *pieces: Any) -> Jet:
    if len(pieces) != 2:
        raise refusals.no_rule("np.where with a condition alone")
    order, (mask, x, y) = lifted((condition, *pieces))
    return Jet(select(mask[0] != 0, x, y), order)


@function_rule(np.select)
def _select(condlist: Sequence[Any], choicelist: Sequence[Any], default: Any = 0.0) -> Any:
    if len(condlist) != len(choicelist):
        raise ValueError(
            f"np.select needs a choice per condition; got {len(condlist)} and {len(choicelist)}."
        )
    chosen: Any = default
    for condition, choice in zip(reversed(condlist), reversed(choicelist), strict=True):
        chosen = np.where(condition, choice, chosen)
    return chosen


_or, _not = _step(np.logical_or), _step(np.logical_not)


@function_rule(np.piecewise)
def _piecewise(x: Jet, condlist: Any, funclist: Sequence[Any], *args: Any, **kw: Any) -> Jet:
    conditions: list[Any] = list(condlist) if isinstance(condlist, list | tuple) else [condlist]
    result, covered = constant([x], np.zeros(x.shape)), constant([x], np.zeros(x.shape, dtype=bool))
    for condition in conditions:
        covered = _or(covered, condition)
    conditions += [_not(covered)] * (len(funclist) - len(conditions))
    for condition, piece in zip(conditions, funclist, strict=True):
        result[condition] = piece(x[condition], *args, **kw) if callable(piece) else piece
    return result


# --- kinks ---


@ufunc_rule(np.absolute, np.fabs)
def _absolute(x: Jet) -> Jet:
    if np.iscomplexobj(x.value):
        return hypot(x.real, x.imag)
    return Jet((np.abs(x.value), *_flipped(x.rows, exceeds(x.rows, (0.0,)))[1:]), x.order)


def _flipped(x: Series, positive: Array) -> Series:
    sign = np.where(positive, 1.0, -1.0)
    return tuple(row * sign for row in x)


@ufunc_rule(np.copysign)
def _copysign(x: Any, y: Any) -> Jet:
    order, (a, b) = lifted((x, y))
    positive = np.signbit(a[0]) == np.signbit(b[0])
    return Jet((np.copysign(a[0], b[0]), *_flipped(a, positive)[1:]), order)


def _extreme(ufunc: np.ufunc, largest: bool, ignores_nan: bool) -> Callable[[Any, Any], Jet]:
    def rule(x: Any, y: Any) -> Jet:
        order, (a, b) = lifted((x, y))
        first = exceeds(a, b) if largest else exceeds(b, a)
        missing = b if ignores_nan else a
        return Jet((ufunc(a[0], b[0]), *select(first | np.isnan(missing[0]), a, b)[1:]), order)

    return rule


ufunc_rule(np.maximum)(_extreme(np.maximum, largest=True, ignores_nan=False))
ufunc_rule(np.minimum)(_extreme(np.minimum, largest=False, ignores_nan=False))
ufunc_rule(np.fmax)(_extreme(np.fmax, largest=True, ignores_nan=True))
ufunc_rule(np.fmin)(_extreme(np.fmin, largest=False, ignores_nan=True))


@function_rule(np.clip)
def _clip(a: Any, a_min: Any = None, a_max: Any = None, *, min: Any = None, max: Any = None) -> Any:
    lower, upper = (a_min if min is None else min), (a_max if max is None else max)
    above: Any = a if lower is None else np.maximum(a, lower)
    return above if upper is None else np.minimum(above, upper)


@ufunc_rule(np.remainder)
def _remainder(x: Any, y: Any) -> Jet:
    return _less_multiples(np.remainder, np.floor_divide, x, y)


@ufunc_rule(np.fmod)
def _fmod(x: Any, y: Any) -> Jet:
    return _less_multiples(np.fmod, lambda a, b: np.trunc(a / b), x, y)


def _less_multiples(remainder: np.ufunc, multiples: Callable[[Any, Any], Any], x: Any, y: Any) -> Jet:
    order, (a, b) = lifted((x, y))
    rest = a if len(b) == 1 else series.subtract(a, series.scale(b, multiples(a[0], b[0])))
    return Jet((remainder(a[0], b[0]), *rest[1:]), order)


@ufunc_rule(np.divmod)
def _divmod(x: Any, y: Any) -> tuple[Any, Any]:
    return np.floor_divide(x, y), np.remainder(x, y)


@ufunc_rule(np.modf)
def _modf(x: Jet) -> tuple[Jet, Jet]:
    fraction, whole = np.modf(x.value)
    return Jet((fraction, *x.rows[1:]), x.order), constant([x], whole)


# --- tables and polynomials ---


@function_rule(np.interp)
def _interp(x: Any, xp: Any, fp: Any, left: Any = None, right: Any = None, period: Any = None) -> Jet:
    if not isinstance(x, Jet) or isinstance(xp, Jet) or isinstance(fp, Jet):
        raise refusals.no_rule("np.interp with a table that depends on time")
    knots, heights = np.asarray(xp, dtype=np.float64), np.asarray(fp, dtype=np.float64)
    value = np.interp(x.value, knots, heights, left, right, period)
    place = x.value
    if period is not None:
        place, knots, heights = _unrolled(place, knots, heights, abs(float(period)))
    slope = _slope(place, knots, heights, rising=exceeds((0.0, *x.rows[1:]), (0.0,)))
    return Jet((value, *series.scale(x.rows[1:], slope)), x.order)


def _unrolled(place: Array, knots: Array, heights: Array, period: float) -> tuple[Array, Array, Array]:
    order = np.argsort(knots % period)
    knots, heights = (knots % period)[order], heights[order]
    knots = np.concatenate([knots[-1:] - period, knots, knots[:1] + period])
    return place % period, knots, np.concatenate([heights[-1:], heights, heights[:1]])


def _slope(place: Array, knots: Array, heights: Array, rising: Array) -> Array:
    """Slope of the piece that `place` is about to enter; 0 beyond the table."""
    slopes = np.concatenate([[0.0], np.diff(heights) / np.diff(knots), [0.0]])
    right, left = np.searchsorted(knots, place, side="right"), np.searchsorted(knots, place, side="left")
    return np.asarray(slopes[np.where(rising, right, left)])


@function_rule(np.polyval)
def _polyval(p: Any, x: Any) -> Jet:
    if not isinstance(x, Jet) or isinstance(p, Jet):
        raise refusals.no_rule("np.polyval with coefficients that depend on time")
    outer, coefficients = [], plain(p)
    for k in range(x.order + 1):
        outer.append((1.0, np.polyval(coefficients, x.value)))
        coefficients = np.polyder(coefficients) / (k + 1)
    return Jet(series.compose(outer, x.powers(), x.order), x.order)
