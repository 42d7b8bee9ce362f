"""Truncated Taylor series to truncated Taylor series: product, quotient, powers and composition, row by row.

A series is a tuple of rows, one per order. Rows hold *normalised* coefficients, x^(k) / k!, because then a
product is a bare convolution, without binomials. Each row need only broadcast against row 0, and zero rows at
the
top are left out: the time itself is (t, 1.0), a linear argument (w t, w) with w a number. So a linear
argument, the usual one, costs one array pass per order where a full series costs one per pair of orders.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Row = Any  # an array or a number; NumPy has no useful type for "either"
Series = tuple[Row, ...]
Term = tuple[float, Row]  # weight and array, kept apart: the weight is often absorbed by a scalar for nothing


def bilinear(join: Callable[[Row, Row], Row], x: Series, y: Series, order: int) -> Series:
    """The series of join(x, y) for a bilinear `join`: the Cauchy product."""
    return tuple(_convolve(join, x, y, k) for k in range(min(order, len(x) + len(y) - 2) + 1))


def _convolve(join: Callable[[Row, Row], Row], x: Series, y: Series, k: int) -> Row:
    first, last = max(0, k - len(y) + 1), min(k, len(x) - 1)
    return total(join(x[j], y[k - j]) for j in range(first, last + 1))


def total(terms: Iterable[Row]) -> Row:
    """The sum of freshly made rows, the first of which is used up: adding in place saves time."""
    rows = iter(terms)
    result: Row = next(rows, 0.0)
    for row in rows:
        if np.shape(result) == np.shape(row) != () and result.dtype == row.dtype:
            result += row
        else:
            result = result + row
    return result


def product(x: Series, y: Series, order: int) -> Series:
    """The series of x * y."""
    return bilinear(np.multiply, x, y, order)


def linear(combine: Callable[..., Row], parts: Sequence[Series]) -> Series:
    """The series of combine(*parts) for a `combine` linear in all parts together; missing rows count as 0."""
    return tuple(combine(*(row_of(x, k) for x in parts)) for k in range(max(map(len, parts))))


def row_of(x: Series, k: int) -> Row:
    """Row k of x, zero where it is left out."""
    return x[k] if k < len(x) else 0.0


def add(x: Series, y: Series) -> Series:
    """The series of x + y; rows that only one of them has are shared, not copied."""
    both = min(len(x), len(y))
    return (*(x[k] + y[k] for k in range(both)), *x[both:], *y[both:])


def subtract(x: Series, y: Series) -> Series:
    """The series of x - y."""
    both = min(len(x), len(y))
    return (*(x[k] - y[k] for k in range(both)), *x[both:], *negate(y[both:]))


def negate(x: Series) -> Series:
    """The series of -x."""
    return tuple(-row for row in x)


def scale(x: Series, factor: Row) -> Series:
    """The series of factor * x, for a factor that does not depend on time."""
    return tuple(row * factor for row in x)


def quotient(x: Series, y: Series, order: int) -> Series:
    """The series of x / y, from x = z y solved order by order."""
    if len(y) == 1:
        return tuple(row / y[0] for row in x)
    z = [x[0] / y[0]]
    inverse = 1.0 / y[0]
    for k in range(1, order + 1):
        carried = total(y[j] * z[k - j] for j in range(1, min(k, len(y) - 1) + 1))
        z.append((row_of(x, k) - carried) * inverse)
    return tuple(z)


def square_root(value: Row, square: Series, order: int) -> Series:
    """The series of sqrt(square), whose row 0 is `value`, from square = root^2 solved order by order."""
    root = [value]
    if len(square) > 1:
        inverse = 0.5 / value
        for k in range(1, order + 1):
            carried = total(root[j] * root[k - j] for j in range(1, k))
            root.append((row_of(square, k) - carried) * inverse)
    return tuple(root)


def derivative(x: Series) -> Series:
    """The series of dx/dt, one order shorter."""
    return tuple(k * x[k] for k in range(1, len(x))) or (np.zeros(np.shape(x[0])),)


def integral(start: Row, rate: Series) -> Series:
    """The series that begins at `start` and whose derivative is `rate`."""
    return (start, *(row / (k + 1) for k, row in enumerate(rate)))


def powers(x: Series, order: int) -> list[dict[int, Row]]:
    """Powers 1..order of x - x[0]: entry p - 1 maps k to row k of (x - x[0])^p, from k = p on."""
    step = {k: x[k] for k in range(1, len(x))}
    table = [step]
    for p in range(2, order + 1):
        table.append(_times(table[-1], step, p, order))
    return table


def _times(x: dict[int, Row], step: dict[int, Row], lowest: int, order: int) -> dict[int, Row]:
    rows: dict[int, Row] = {}
    for k in range(lowest, order + 1):
        terms = [x[k - j] * step[j] for j in step if k - j in x]
        if terms:
            rows[k] = total(terms)
    return rows


def compose(outer: Sequence[Term], table: list[dict[int, Row]], order: int) -> Series:
    """The series of f(x(t)): `outer` is the Taylor series of f at x[0], `table` the powers of x - x[0]."""
    rows: list[Row] = [outer[0][1]]
    inner = [(weight, base, power) for (weight, base), power in zip(outer[1:], table, strict=False)]
    top = max((k for _, _, power in inner for k in power), default=0)
    for k in range(1, min(order, top) + 1):
        rows.append(total(_weigh(weight, base, power[k]) for weight, base, power in inner if k in power))
    return tuple(rows)


def _weigh(weight: float, base: Row, factor: Row) -> Row:
    if np.ndim(factor) == 0:
        return base * (weight * factor)
    return base * factor if weight == 1.0 else base * weight * factor
