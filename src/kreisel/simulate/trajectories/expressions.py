"""Turns formulas of time written as text, as scenario files hold them, into a trajectory differentiated exactly."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from numbers import Real
from typing import Any

import numpy as np

from kreisel.data.checks import choice
from kreisel.simulate.formula import evaluate, parse
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.vocabulary import CONSTANTS, FUNCTIONS

Expression = str | float


def expressions(
    position: Sequence[Expression],
    orientation: str | Sequence[Expression] = "tangent",
    parameters: Mapping[str, float] | None = None,
    span: Sequence[float] | None = None,
) -> FunctionTrajectory:
    """A trajectory from formulas of t (s), such as "0.8*cos(2*pi*f*t)" with parameters {"f": 1.0}.

    position: x, y, z in m in N; plain numbers are constants.
    orientation: phi_x, phi_y, phi_z in rad; or "tangent" or "transport", as `FunctionTrajectory` has them.
    span: first and last time at which the formulas hold, s; for ever where it is left out.

    Formulas know + - * / // % **, comparisons, and / or / not, `a if t > 1 else b`, t, pi, e, the parameters and
    NumPy's functions by name (docs/scenarios.md lists them). They are never run as Python.
    Raises ValueError with the place, one sentence, for anything else.
    """
    values = _parameters(parameters or {})
    if isinstance(orientation, str):
        attitude: Any = choice("orientation", orientation, ("tangent", "transport"))
    else:
        attitude = _functions("orientation", orientation, values)
    first, last = (-np.inf, np.inf) if span is None else _pair(span)
    return FunctionTrajectory(
        _functions("position", position, values), attitude, span=(first, last), name="expressions"
    )


def _parameters(given: Mapping[str, float]) -> dict[str, float]:
    for name in given:
        plain = isinstance(name, str) and name.isascii() and name.isidentifier()
        if not plain or keyword.iskeyword(name):
            raise ValueError(f"parameters must have names like f or radius_2; got {name!r}.")
        if name == "t" or name in CONSTANTS or name in FUNCTIONS:
            raise ValueError(
                f"parameter {name!r} has the name of something that formulas know. Choose another name."
            )
    return {name: _number(f"parameter {name!r}", value) for name, value in given.items()}


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError(f"{name} must be a number; got {value!r:.60}.")
    try:
        number = float(value)
    except OverflowError:
        raise ValueError(f"{name} is too large a number.") from None
    if not np.isfinite(number):
        raise ValueError(f"{name} must be finite; got {number}.")
    return number


def _functions(
    name: str, given: Sequence[Expression], parameters: Mapping[str, float]
) -> tuple[Callable[[Any], Any] | float, ...]:
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 3:
        held = f"{len(given)}" if isinstance(given, list | tuple) else repr(given)
        raise ValueError(f'{name} must be three formulas, as in ["cos(t)", "sin(t)", "0"]; got {held:.60}.')
    return tuple(_function(f"{name}[{k}]", text, parameters) for k, text in enumerate(given))


def _function(name: str, given: Any, parameters: Mapping[str, float]) -> Callable[[Any], Any] | float:
    if not isinstance(given, str):
        return _number(name, given)
    try:
        return partial(evaluate, parse(given, parameters))
    except ValueError as error:
        raise ValueError(f"{name}, {error}") from None


def _pair(span: Sequence[float]) -> tuple[float, float]:
    if len(span) != 2:
        raise ValueError(f"span must be (first, last), s; got {span}.")
    return float(span[0]), float(span[1])


def example() -> FunctionTrajectory:
    """The loop of figure 1 at half its pace."""
    return expressions(
        ["0.8*cos(2*pi*f*t)", "0.8*sin(2*pi*f*t)", "0.3*cos(3*2*pi*f*t)"], parameters={"f": 0.5}
    )
