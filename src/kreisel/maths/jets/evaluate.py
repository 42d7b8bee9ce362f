"""Turns a user's function of time and the times asked for into arrays of its value and derivatives."""

from collections.abc import Callable
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kreisel.maths.jets import blame, refusals
from kreisel.maths.jets.jet import Jet, Packed
from kreisel.maths.jets.series import Array, Series

# Long enough to hide the cost of calling NumPy, short enough for the rows of several jets to stay in cache.
BLOCK = 8192

# A sample computed alone may differ in its last bits from itself in a block: vector loops have tails.
_SAME = 1e-9


def differentiate(function: Callable[[Any], Any], t: ArrayLike, order: int) -> NDArray[np.float64]:
    """Value and derivatives 0..order in time of a function written with NumPy, exact to round-off.

    function : called with a `Jet` that stands for the time in s. It returns one quantity, or three: a tuple
               or list of three, an (n, 3) or (3, n) array, np.array([x, y, z]). Plain numbers are constants.
    t        : (n,) s, finite.
    returns  : (order + 1, n), or (order + 1, n, 3).

    Infinite or undefined values come out as inf and nan, without warnings; for kinks see the package.
    TypeError : the function calls what has no derivative rule, or what would lose the derivatives.
    ValueError: t, order or the returned shape are wrong, or the function is not one of time alone.
    """
    times = _checked_times(t)
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 0:
        raise ValueError(f"order must be a whole number, 0 or more; got {order!r}.")
    if not callable(function):
        raise TypeError(
            f"function must be a function of time; got {type(function).__name__}. Write lambda t: ..."
        )
    first = _parts_at(function, times[:BLOCK], int(order))
    result = np.zeros((int(order) + 1, times.size, *([3] if len(first) == 3 else [])))
    _write(first, result[:, :BLOCK])
    _check_independence(function, times[:BLOCK], result[:, :BLOCK])
    for start in range(BLOCK, times.size, BLOCK):
        block = slice(start, start + BLOCK)
        _write(_parts_at(function, times[block], int(order)), result[:, block])
    return result


def _checked_times(t: ArrayLike) -> NDArray[np.float64]:
    times = np.asarray(t, dtype=np.float64)
    if times.ndim != 1 or not np.all(np.isfinite(times)):
        raise ValueError(f"t must be (n,) and finite; got shape {times.shape}. Did you mean np.ravel(t)?")
    return times


def _parts_at(function: Callable[[Any], Any], times: NDArray[np.float64], order: int) -> list[Series]:
    """The one or three quantities that the function makes of a block of times."""
    # Only a block of another length than 3 can tell (n, 3) from (3, n).
    padded = np.append(times, times[-1]) if times.size == 3 else times
    with np.errstate(all="ignore"):
        try:
            answer = function(Jet.variable(padded, order))
        except (TypeError, ValueError) as error:
            better = blame.explained(error, lambda: function(padded))
            if better is None:
                raise
            raise better from error
        return _parts(answer, padded.size)


def _write(parts: list[Series], result: NDArray[np.float64]) -> None:
    """Write derivatives from normalised coefficients into (order + 1, n) or (order + 1, n, 3) zeros."""
    n = result.shape[1]
    if len(parts) != (3 if result.ndim == 3 else 1):
        raise ValueError("the function returns one quantity at some times and three at others.")
    for i, rows in enumerate(parts):
        target = result[..., i] if result.ndim == 3 else result
        for k, row in enumerate(rows):
            np.multiply(row if np.ndim(row) == 0 else row[:n], float(factorial(k)), out=target[k])


# --- what a function may return ---


def _parts(answer: Any, n: int) -> list[Series]:
    """The one or three quantities in what the function returned."""
    if isinstance(answer, Jet):
        return _columns(answer, n)
    if isinstance(answer, tuple | list):
        return _three([_single(part, n) for part in answer])
    if isinstance(answer, np.ndarray) and answer.dtype == object:
        if answer.size != 3:
            raise refusals.taken_as_plain_array()
        return _three([_single(part, n) for part in answer.ravel()])
    array = _numbers(answer)
    if array.shape == (3,):
        return [(component,) for component in array]
    return _columns(Jet((_unchanging(array, n),), 0), n)


def _three(parts: list[Series]) -> list[Series]:
    if len(parts) != 3:
        raise ValueError(f"a function of time returns one quantity or three; got {len(parts)}.")
    return parts


def _columns(answer: Jet, n: int) -> list[Series]:
    if np.iscomplexobj(answer.value):
        raise TypeError("the function of time is complex; return its .real or .imag part, or np.abs of it.")
    if answer.shape in ((), (n,)):
        return [answer.rows]
    if answer.shape not in ((n, 3), (3, n)):
        raise ValueError(
            f"a function of time must return ({n},) or ({n}, 3) for {n} samples; got {answer.shape}."
        )
    across = answer if answer.shape == (3, n) else answer.T
    return [across[i].rows for i in range(3)]


def _single(part: Any, n: int) -> Series:
    whole = part.jet if isinstance(part, Packed) else part
    jet = whole if isinstance(whole, Jet) else Jet((_unchanging(_numbers(whole), n),), 0)
    if jet.ndim > 1:
        raise ValueError(f"each of three quantities must be ({n},); got {jet.shape}.")
    return _columns(jet, n)[0]


def _numbers(answer: Any) -> Array:
    if answer is None:
        raise TypeError("the function of time returned None. Did you forget `return`?")
    if isinstance(answer, Packed):
        raise refusals.taken_as_plain_array()
    array = np.asarray(answer)
    if array.dtype.kind not in "biuf":
        raise TypeError(f"a function of time returns numbers; got {type(answer).__name__} {answer!r:.60}.")
    return array


def _unchanging(array: Array, n: int) -> Array:
    """A plain array that is the same at all samples; any other is a table, whose derivatives are unknown."""
    samples = array if array.ndim == 1 or array.shape[:1] == (n,) else array.T
    if (
        array.ndim
        and len(samples)
        and not np.array_equal(samples, np.broadcast_to(samples[0], samples.shape), True)
    ):
        raise TypeError(
            "the function returned plain numbers that change from sample to sample; their derivatives are "
            "unknown. Calculate them from t with NumPy functions, or give samples to SampledTrajectory."
        )
    return array


# --- one function, one value per time ---


def _check_independence(function: Callable[[Any], Any], times: NDArray[np.float64], block: Array) -> None:
    """One sample evaluated alone must come out as it did among the others.

    Sums over samples, len(t) and random numbers do not: their results depend on the length of the blocks.
    """
    if times.size < 2:
        return
    m = times.size // 2
    alone = np.zeros((block.shape[0], 1, *block.shape[2:]))
    try:
        _write(_parts_at(function, times[m : m + 1], block.shape[0] - 1), alone)
    except (TypeError, ValueError, IndexError) as error:
        raise refusals.not_of_time_alone(times[m]) from error
    # Reducing with where= is thirty times slower than taking the rest out first.
    scale = np.max(np.where(np.isfinite(block), np.abs(block), 0.0), axis=1)
    if not np.all(_alike(alone[:, 0], block[:, m], scale)):
        raise refusals.not_of_time_alone(times[m])


def _alike(a: Array, b: Array, scale: Array) -> Array:
    with np.errstate(invalid="ignore"):
        return np.asarray((a == b) | (np.isnan(a) & np.isnan(b)) | (np.abs(a - b) <= _SAME * scale))
