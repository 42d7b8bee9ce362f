"""Turns the mixed operands of a NumPy call, jets and plain numbers, into series of one common order."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from kreisel.maths.jets import refusals
from kreisel.maths.jets.jet import FUNCTION_RULES, UFUNC_RULES, Jet, Packed
from kreisel.maths.jets.series import Array, Series

Rule = TypeVar("Rule", bound=Callable[..., Any])


def ufunc_rule(*ufuncs: np.ufunc) -> Callable[[Rule], Rule]:
    """Register a function as what these ufuncs do to jets."""

    def register(rule: Rule) -> Rule:
        UFUNC_RULES.update(dict.fromkeys(ufuncs, rule))
        return rule

    return register


def function_rule(*functions: Any) -> Callable[[Rule], Rule]:
    """Register a function as what these NumPy functions do to jets."""

    def register(rule: Rule) -> Rule:
        FUNCTION_RULES.update(dict.fromkeys(functions, rule))
        return rule

    return register


def lifted(operands: Sequence[Any]) -> tuple[int, list[Series]]:
    """The common order of the jets among the operands, and the series of each; plain ones are constant."""
    order = min(x.order for x in operands if isinstance(x, Jet))
    return order, [x.rows if isinstance(x, Jet) else (plain(x),) for x in operands]


def values(operands: Sequence[Any]) -> list[Array]:
    """The values of the operands, their derivatives left aside."""
    return [x.value if isinstance(x, Jet) else plain(x) for x in operands]


def constant(like: Sequence[Any], value: Any) -> Jet:
    """A jet of this value whose derivatives are all zero, of the order of the jets in `like`."""
    return Jet((value,), min(x.order for x in like if isinstance(x, Jet)))


def plain(x: Any) -> Array:
    """A plain operand as an array of numbers."""
    array = np.asarray(x)
    if array.dtype == object and any(isinstance(part, Packed) for part in array.flat):
        raise refusals.taken_as_plain_array()
    if array.dtype.kind not in "biufc":
        raise TypeError(
            f"a function of time meets numbers and numeric arrays; got {type(x).__name__} {x!r:.60}."
        )
    return array.astype(np.float64) if array.dtype.kind in "iuf" else array
