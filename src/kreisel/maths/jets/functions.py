"""Turns NumPy functions that arrange, join or contract arrays of jets into jets.

Sums over the sample axis mix times and are refused where they can be seen (a jet of one axis);
`differentiate` finds the others.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from kreisel.maths.jets import refusals, series
from kreisel.maths.jets.jet import UFUNC_RULES, Jet
from kreisel.maths.jets.rules import constant, function_rule, lifted

# --- what an array looks like ---

function_rule(np.shape)(lambda a: a.shape)
function_rule(np.ndim)(lambda a: a.ndim)
function_rule(np.size)(lambda a, axis=None: a.size if axis is None else a.shape[axis])
function_rule(np.real)(lambda val: val.real)
function_rule(np.imag)(lambda val: val.imag)
function_rule(np.iscomplexobj)(lambda x: np.iscomplexobj(x.value))
function_rule(np.isrealobj)(lambda x: np.isrealobj(x.value))
function_rule(np.angle)(lambda z, deg=False: (180.0 / np.pi if deg else 1.0) * np.arctan2(z.imag, z.real))
function_rule(np.copy)(lambda a, order="K", subok=False: a.twin())

# --- new arrays of the same shape ---


@function_rule(np.zeros_like, np.empty_like)
def _zeros_like(a: Jet, dtype: Any = None, order: str = "K", subok: bool = True, shape: Any = None) -> Jet:
    return _filled(a, 0.0, dtype, shape)


@function_rule(np.ones_like)
def _ones_like(a: Jet, dtype: Any = None, order: str = "K", subok: bool = True, shape: Any = None) -> Jet:
    return _filled(a, 1.0, dtype, shape)


@function_rule(np.full_like)
def _full_like(
    a: Jet, fill_value: Any, dtype: Any = None, order: str = "K", subok: bool = True, shape: Any = None
) -> Jet:
    return _filled(a, fill_value, dtype, shape)


def _filled(like: Jet, fill: Any, dtype: Any, shape: Any) -> Jet:
    # Whole-number arrays would cut off what is assigned to them later; NumPy's own t is a float array too.
    kind = np.bool_ if dtype in (bool, np.bool_) else np.result_type(np.float64, dtype or np.float64)
    return constant([like], np.full(like.shape if shape is None else shape, fill, dtype=kind))


# --- arranging one array ---


def _arranging(function: Any) -> Callable[..., Jet]:
    def rule(a: Jet, *args: Any, **kwargs: Any) -> Jet:
        return a.arranged(lambda row: function(row, *args, **kwargs))

    return rule


_ARRANGING: tuple[Any, ...] = (
    *(np.transpose, np.reshape, np.ravel, np.squeeze, np.expand_dims, np.moveaxis, np.rollaxis, np.swapaxes),
    *(np.broadcast_to, np.atleast_1d, np.atleast_2d, np.atleast_3d, np.take, np.repeat, np.tile),
)
for _function in _ARRANGING:
    function_rule(_function)(_arranging(_function))


# --- joining several ---


def _joining(function: Any) -> Callable[..., Jet]:
    def rule(arrays: Sequence[Any], *args: Any, **kwargs: Any) -> Jet:
        order, parts = lifted(list(arrays))
        shapes = [np.shape(part[0]) for part in parts]

        def join(*rows: Any) -> Any:
            return function(
                [np.broadcast_to(row, s) for row, s in zip(rows, shapes, strict=True)], *args, **kwargs
            )

        return Jet(series.linear(join, parts), order)

    return rule


_JOINING: tuple[Any, ...] = (np.stack, np.concatenate, np.column_stack, np.vstack, np.hstack, np.dstack)
for _function in _JOINING:
    function_rule(_function)(_joining(_function))


# --- contracting ---


def _summing(function: Any) -> Callable[..., Jet]:
    def rule(a: Jet, axis: Any = None, **kwargs: Any) -> Jet:
        if axis is None or a.ndim < 2:
            raise refusals.no_rule(f"{refusals.public_name(function)} over the samples")
        return a.arranged(lambda row: function(row, axis=axis, **kwargs))

    return rule


function_rule(np.sum)(_summing(np.sum))
function_rule(np.mean)(_summing(np.mean))


def _contracting(function: Any) -> Callable[..., Jet]:
    def rule(a: Any, b: Any, *args: Any, **kwargs: Any) -> Jet:
        order, (x, y) = lifted((a, b))
        x, y = _full(x), _full(y)
        return Jet(
            series.bilinear(partial(function, *args, **kwargs) if args or kwargs else function, x, y, order),
            order,
        )

    return rule


def _full(x: series.Series) -> series.Series:
    return tuple(np.broadcast_to(row, np.shape(x[0])) for row in x)


_CONTRACTING: tuple[Any, ...] = (np.dot, np.inner, np.outer, np.cross, np.kron)
for _function in _CONTRACTING:
    function_rule(_function)(_contracting(_function))
for _name in ("matmul", "vecdot", "matvec", "vecmat"):  # the last three are younger than NumPy 1
    if hasattr(np, _name):
        UFUNC_RULES[getattr(np, _name)] = _contracting(getattr(np, _name))


@function_rule(np.einsum)
def _einsum(subscripts: Any, *operands: Any, **kwargs: Any) -> Any:
    if len(operands) == 1:
        return operands[0].arranged(lambda row: np.einsum(subscripts, row, **kwargs))
    if len(operands) != 2:
        raise refusals.no_rule("np.einsum of more than two arrays")
    return _contracting(lambda x, y: np.einsum(subscripts, x, y, **kwargs))(*operands)


@function_rule(np.linalg.norm)
def _norm(x: Jet, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Jet:
    if ord not in (None, 2) or not isinstance(axis, int) or x.ndim < 2:
        raise refusals.no_rule("np.linalg.norm without axis=, or with an order other than 2,")
    square = np.sum(x * x, axis=axis, keepdims=keepdims)
    return Jet(series.square_root(np.sqrt(square.value), square.rows, x.order), x.order)
