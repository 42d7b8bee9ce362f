"""Turns the text of a formula of time, such as "0.8*cos(2*pi*f*t)", into a function that exact mode can differentiate.

Nothing is ever run as Python: the text is parsed, every node of its syntax tree is checked against a whitelist and
translated into calls of NumPy functions, and parts without t are worked out at once, in float64. Whatever is not on
the list is refused with its column, before anything is calculated.
"""

from __future__ import annotations

import ast
import difflib
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any, NoReturn

import numpy as np

from kreisel.simulate.vocabulary import (
    BINARY,
    COMPARISONS,
    CONSTANTS,
    FUNCTIONS,
    UNARY,
    both,
    either,
    strange_character,
)

MAX_LENGTH = 4000
"""Characters in a formula: several pages; what is longer belongs into a file of samples."""

# Deeper than any formula that is written by hand, and far from the limits of Python's parser and stack.
_MAX_BRACKETS = 50
_MAX_DEPTH = 100

_STRANGE = re.compile(r"[^A-Za-z0-9_ .,+\-*/%()<>=!\[\]]")
_EXCERPT = 24


@dataclass(frozen=True, slots=True)
class Call:
    """One NumPy function of numbers, the time and other calls."""

    function: Callable[..., Any]
    operands: tuple[Formula, ...]


class Time:
    """Where the time stands in a formula."""


Formula = float | Time | Call


def evaluate(formula: Formula, t: Any) -> Any:
    """The value of a formula at `t`, an array or jet of times in s."""
    if isinstance(formula, Call):
        return formula.function(*(evaluate(operand, t) for operand in formula.operands))
    return t if isinstance(formula, Time) else formula


def parse(text: str, parameters: Mapping[str, float]) -> Formula:
    """The formula that `text` writes, its parameters replaced by their values.

    Raises ValueError, one sentence with the column, for anything that is not a formula of t.
    """
    flat = re.sub(r"\s", " ", text) if len(text) <= MAX_LENGTH else text
    _check_text(flat)
    # The parser takes leading blanks for an indent; brackets in their place keep every column.
    indent = len(flat) - len(flat.lstrip())
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(flat[indent:], mode="eval").body
    except SyntaxError as error:
        _refuse(flat, indent + max(error.offset or 1, 1) - 1, "this is not how a formula is written")
    except (ValueError, RecursionError, MemoryError):
        _refuse(flat, 0, "this is nested too deeply or too long for a formula")
    _check_depth(flat, tree, indent)
    return _Translation(flat, indent, parameters).formula(tree)


# --- what can be told before parsing ---


def _check_text(text: str) -> None:
    if len(text) > MAX_LENGTH:
        raise ValueError(
            f"a formula has at most {MAX_LENGTH} characters, and this one has {len(text)}; "
            'give samples in a file (kind = "file") instead.'
        )
    if not text.strip():
        raise ValueError('the formula is empty; write "0" for zero.')
    strange = _STRANGE.search(text)
    if strange:
        _refuse(text, strange.start(), strange_character(strange.group()))
    open_brackets = 0
    for column, letter in enumerate(text):
        open_brackets += (letter in "([") - (letter in ")]")
        if open_brackets > _MAX_BRACKETS:
            _refuse(text, column, f"more than {_MAX_BRACKETS} brackets are open here")


def _check_depth(text: str, tree: ast.expr, indent: int) -> None:
    level: list[Any] = [tree]
    for _ in range(_MAX_DEPTH):
        level = [child for node in level for child in ast.iter_child_nodes(node)]
    deep = next((node for node in level if hasattr(node, "col_offset")), None)
    if deep is not None:
        _refuse(text, indent + deep.col_offset, f"this is nested more than {_MAX_DEPTH} levels deep")


def _refuse(text: str, column: int, why: str) -> NoReturn:
    rest = text[column:].rstrip()
    shown = rest[:_EXCERPT] + ("..." if len(rest) > _EXCERPT else "")
    # What a terminal would obey rather than show has no place in a message.
    shown = "".join(letter if letter.isprintable() else "?" for letter in shown)
    where = f'column {column + 1}, at "{shown}"' if shown else "at its end"
    raise ValueError(f"{where}: {why}" + ("" if why.endswith("?") else ".")) from None


# --- what the syntax tree may hold ---


class _Translation:
    """Translates the syntax tree of one text; `_refuse` sees where it is."""

    def __init__(self, text: str, indent: int, parameters: Mapping[str, float]) -> None:
        self.text, self.indent, self.parameters = text, indent, parameters

    def formula(self, node: ast.expr) -> Formula:
        """The formula of a node and all below it."""
        match node:
            case ast.Constant():
                return self._constant(node)
            case ast.Name():
                return self._name(node)
            case ast.UnaryOp():
                return self._unary(node)
            case ast.BinOp():
                return self._binary(node)
            case ast.BoolOp():
                return self._logic(node)
            case ast.Compare():
                return self._comparison(node)
            case ast.IfExp():
                pieces = (self.formula(part) for part in (node.test, node.body, node.orelse))
                return self._apply(node, np.where, *pieces)
            case ast.Call():
                return self._function(node)
        self._refuse(node, f"{_spoken(node)} has no place in a formula{_cure(node)}")

    def _constant(self, node: ast.Constant) -> Formula:
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            self._refuse(node, f"{str(node.value)!r} is not a real number")
        try:
            return self._finite(node, float(node.value))
        except OverflowError:
            self._refuse(node, "this number is too large")

    def _name(self, node: ast.Name) -> Formula:
        if node.id == "t":
            return Time()
        known = {**CONSTANTS, **self.parameters}
        if node.id in known:
            return known[node.id]
        if node.id in FUNCTIONS:
            self._refuse(node, f"{node.id} is a function; write {node.id}(...)")
        self._unknown(node, "name", node.id, ["t", *known])

    def _unary(self, node: ast.UnaryOp) -> Formula:
        if type(node.op) not in UNARY:
            self._refuse(node, "this operator has no place in a formula")
        return self._apply(node, UNARY[type(node.op)], self.formula(node.operand))

    def _binary(self, node: ast.BinOp) -> Formula:
        if type(node.op) not in BINARY:
            self._refuse(node, "this operator has no place in a formula")
        return self._apply(node, BINARY[type(node.op)], self.formula(node.left), self.formula(node.right))

    def _logic(self, node: ast.BoolOp) -> Formula:
        join = both if isinstance(node.op, ast.And) else either
        return self._joined(node, join, [self.formula(value) for value in node.values])

    def _comparison(self, node: ast.Compare) -> Formula:
        sides = [self.formula(side) for side in (node.left, *node.comparators)]
        pairs = []
        for op, left, right in zip(node.ops, sides[:-1], sides[1:], strict=True):
            if type(op) not in COMPARISONS:
                self._refuse(node, "only <, <=, >, >=, == and != compare in a formula")
            pairs.append(self._apply(node, COMPARISONS[type(op)], left, right))
        return self._joined(node, both, pairs)

    def _joined(self, node: ast.expr, join: Callable[..., Any], parts: list[Formula]) -> Formula:
        return reduce(lambda first, other: self._apply(node, join, first, other), parts)

    def _function(self, node: ast.Call) -> Formula:
        name = self._function_name(node)
        function, count = FUNCTIONS[name]
        if len(node.args) != count:
            wanted = f"{count} argument{'s' if count > 1 else ''}"
            self._refuse(node, f"{name} takes {wanted}; it has {len(node.args)} here")
        if name == "interp":
            knots, heights = self._table(node)
            return self._apply(node, partial(function, xp=knots, fp=heights), self.formula(node.args[0]))
        return self._apply(node, function, *(self.formula(argument) for argument in node.args))

    def _function_name(self, node: ast.Call) -> str:
        if not isinstance(node.func, ast.Name):
            self._refuse(node.func, f"only functions by name can be called{_cure(node.func)}")
        name = node.func.id
        if name not in FUNCTIONS:
            self._unknown(node, "function", name, list(FUNCTIONS))
        if node.keywords:
            self._refuse(node, f"{name} takes its arguments by position, without names")
        return name

    def _table(self, node: ast.Call) -> tuple[Any, Any]:
        knots, heights = (self._numbers(argument) for argument in node.args[1:])
        if len(knots) != len(heights) or len(knots) < 2:
            sizes = f"{len(knots)} and {len(heights)}"
            self._refuse(node, f"interp takes two lists of the same length, 2 or more; it has {sizes} here")
        if (np.diff(knots) <= 0.0).any():
            self._refuse(node.args[1], "the first list of interp must increase from number to number")
        return knots, heights

    def _numbers(self, node: ast.expr) -> Any:
        if not isinstance(node, ast.List | ast.Tuple):
            self._refuse(node, "interp takes lists of numbers here, as in interp(t, [0, 1, 2], [0, 5, 0])")
        numbers = [self.formula(item) for item in node.elts]
        for item, number in zip(node.elts, numbers, strict=True):
            if not isinstance(number, float):
                self._refuse(item, "the lists of interp hold numbers that do not depend on t")
        return np.array(numbers, dtype=np.float64)

    def _apply(self, node: ast.expr, function: Callable[..., Any], *operands: Formula) -> Formula:
        """A call, worked out at once where no operand depends on time."""
        if not all(isinstance(operand, float) for operand in operands):
            return Call(function, operands)
        with np.errstate(all="ignore"):
            return self._finite(node, float(function(*operands)))

    def _finite(self, node: ast.expr, value: float) -> float:
        if not np.isfinite(value):
            self._refuse(node, f"this is {value}, which is not a finite number")
        return value

    def _unknown(self, node: ast.expr, what: str, name: str, known: list[str]) -> NoReturn:
        near = difflib.get_close_matches(name, known, n=1)
        few = f", known are {', '.join(known)}" if len(known) < 20 else ""
        self._refuse(node, f"unknown {what} {name!r}" + (f", did you mean {near[0]!r}?" if near else few))

    def _refuse(self, node: ast.expr, why: str) -> NoReturn:
        _refuse(self.text, self.indent + node.col_offset, why)


def _spoken(node: ast.expr) -> str:
    words = {
        ast.Attribute: "a dot after a name",
        ast.Subscript: "an index in square brackets",
        ast.List: "a list",
        ast.Tuple: "a comma",
        ast.Starred: "a star before an argument",
    }
    return words.get(type(node), f"Python's {type(node).__name__.lower()}")


def _cure(node: ast.expr) -> str:
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr in FUNCTIONS:
        return f"; write {node.attr}(...)" if node.value.id in ("np", "numpy", "math") else ""
    return ""
