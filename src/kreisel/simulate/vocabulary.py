"""Turns the words and signs that a formula may use into the NumPy functions they stand for."""

from __future__ import annotations

import ast
from collections.abc import Callable
from types import MappingProxyType
from typing import Any

import numpy as np

CONSTANTS = MappingProxyType({"pi": float(np.pi), "e": float(np.e)})


def _answers(question: Callable[..., Any]) -> Callable[..., Any]:
    # As numbers, because NumPy's booleans cannot be subtracted and add up to True.
    return lambda *operands: question(*operands) * 1.0


both, either, _negated = (_answers(np.logical_and), _answers(np.logical_or), _answers(np.logical_not))

UNARY: dict[type[ast.unaryop], Callable[..., Any]] = {
    ast.UAdd: np.positive,
    ast.USub: np.negative,
    ast.Not: _negated,
}

BINARY: dict[type[ast.operator], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.FloorDiv: np.floor_divide,
    ast.Mod: np.remainder,
    ast.Pow: np.power,
}

COMPARISONS: dict[type[ast.cmpop], Callable[..., Any]] = {
    ast.Lt: _answers(np.less),
    ast.LtE: _answers(np.less_equal),
    ast.Gt: _answers(np.greater),
    ast.GtE: _answers(np.greater_equal),
    ast.Eq: _answers(np.equal),
    ast.NotEq: _answers(np.not_equal),
}

_ONE = (
    *(
        "sin",
        "cos",
        "tan",
        "arcsin",
        "arccos",
        "arctan",
        "sinh",
        "cosh",
        "tanh",
        "arcsinh",
        "arccosh",
        "arctanh",
    ),
    *("exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "sqrt", "cbrt", "square", "sinc"),
    *("abs", "sign", "floor", "ceil", "trunc", "rint", "deg2rad", "rad2deg", "radians", "degrees"),
)
_TWO = (
    *("arctan2", "hypot", "power", "minimum", "maximum", "mod", "fmod", "remainder"),
    *("copysign", "heaviside", "logaddexp"),
)
# As Python's math module and mathematicians write them.
_ALIASES = {
    **{f"a{name}": f"arc{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "tan2")},
    **{"ln": "log", "pow": "power", "min": "minimum", "max": "maximum"},
}

# name -> NumPy's function and how many arguments it takes
_OWN = {
    **{name: (getattr(np, name), 1) for name in _ONE},
    **{name: (getattr(np, name), 2) for name in _TWO},
    **{name: (getattr(np, name), 3) for name in ("where", "clip", "interp")},
}
FUNCTIONS = MappingProxyType({**_OWN, **{alias: _OWN[name] for alias, name in _ALIASES.items()}})

_CURES = {
    "^": "write ** for a power",
    "&": "write `and` between conditions",
    "|": "write `or` between conditions",
    "~": "write `not` before a condition",
    ";": "a formula is one expression",
    "'": "a formula holds no text",
    '"': "a formula holds no text",
    "\N{MIDDLE DOT}": "write * for a product",
    "\N{MULTIPLICATION SIGN}": "write * for a product",
    "\N{MINUS SIGN}": "write the minus sign of the keyboard",
    "\N{GREEK SMALL LETTER PI}": "write pi",
}


def strange_character(letter: str) -> str:
    """Why a character has no place in a formula and, where there is one, what to write in its stead."""
    return f"the character {letter!r} has no place in a formula" + (
        f"; {_CURES[letter]}" if letter in _CURES else ""
    )
