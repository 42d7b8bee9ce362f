"""Turns whatever a user passed into checked float64 arrays, or into an error that teaches.

Every `ValueError` and `TypeError` of the public doors about arrays is raised here: what is wrong, what was
received, what to do.
"""

from __future__ import annotations

import operator
import re
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""float64 array; its shape, unit and frame are in the comment beside it."""

SAME_INSTANT = 1e-7
"""Stamps this close (s) are the same instant: files round to a nanosecond or so, clocks jitter by more."""

_FILE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. +-]{0,63}")


def read_only(x: Array) -> Array:
    """A view of `x` that cannot be written to; nouns take such a view as it is, without a copy."""
    view = x.view()
    view.flags.writeable = False
    return view


def as_array(name: str, value: Any) -> Array:
    """`value` as a C-contiguous float64 array, or a TypeError that names it."""
    try:
        array = np.ascontiguousarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name} must be an array of numbers; got {type(value).__name__} ({error})") from None
    return array if np.ndim(value) else array.reshape(())


def shaped(name: str, value: Any, shape: Sequence[int | str]) -> Array:
    """`value` as a read-only array of `shape`; letters such as "n" stand for any length.

    An array that its owner could still write to is copied: what a noun holds does not change behind its back.
    Raises ValueError naming the shape received and, where it would fit, the transpose.
    """
    array = as_array(name, value)
    if isinstance(value, np.ndarray) and value.flags.writeable and np.may_share_memory(array, value):
        array = array.copy()
    if not _fits(array.shape, shape):
        wanted = "(" + ", ".join(map(str, shape)) + ("," if len(shape) == 1 else "") + ")"
        hint = f" Did you mean {name}.T?" if array.ndim > 1 and _fits(array.T.shape, shape) else ""
        raise ValueError(f"{name} must be {wanted}; got {array.shape}.{hint}")
    return read_only(array)


def _fits(shape: tuple[int, ...], wanted: Sequence[int | str]) -> bool:
    return len(shape) == len(wanted) and all(
        isinstance(w, str) or w == s for s, w in zip(shape, wanted, strict=True)
    )


def row_or_column(name: str, value: Any, length: int | str = "n") -> Array:
    """`value` (length,), (length, 1) or (1, length) as a read-only array (length,)."""
    array = as_array(name, value)
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    return shaped(name, array, (length,))


def three_functions(name: str, value: Any) -> Sequence[Callable[[Any], Any]]:
    """`value` itself when it holds three functions, else a TypeError that shows how to write them."""
    if isinstance(value, Sequence) and len(value) == 3 and all(callable(part) for part in value):
        return value
    if isinstance(value, Sequence) and len(value) == 3:
        got = "(" + ", ".join("a function" if callable(x) else repr(x)[:40] for x in value) + ")"
        got += "; write a constant as a function too, lambda t: 0"
    else:
        got = f"{len(value)} items" if isinstance(value, Sequence) else type(value).__name__
    raise TypeError(
        f"{name} must be three functions of time, as in (lambda t: np.cos(t), lambda t: np.sin(t), "
        f'lambda t: 0 * t); got {got}. Samples go with option "num".'
    )


def same_length(t: Array, **columns: npt.NDArray[Any] | None) -> None:
    """Refuse columns that do not have one row per time stamp."""
    for name, column in columns.items():
        if column is not None and len(column) != len(t):
            raise ValueError(
                f"{name} must have one row per time stamp; got {len(column)} rows for {len(t)} stamps."
            )


def finite(name: str, array: Array) -> Array:
    """`array` itself, or a ValueError naming the first row that is NaN or infinite."""
    good = np.isfinite(array)
    if not good.all():
        index = int(np.argwhere(~good)[0][0]) if array.ndim else 0
        raise ValueError(
            f"{name} must be finite; row {index} is {' '.join(str(array[index] if array.ndim else array).split())}. "
            "Remove such rows or fill them before they come in."
        )
    return array


def increasing(name: str, t: Array) -> Array:
    """`t` itself, or a ValueError naming the first place where time stands still or runs back."""
    finite(name, t)
    steps = np.diff(t)
    if steps.size and steps.min() <= 0.0:
        k = int(np.argmax(steps <= 0.0))
        what = "stands still" if steps[k] == 0.0 else "runs back"
        raise ValueError(
            f"{name} must increase strictly; it {what} from {t[k]:.9g} to {t[k + 1]:.9g} s at row {k + 1}. "
            "Sort the rows and drop repeated stamps."
        )
    return t


def rotations(name: str, R: Array, tolerance: float = 1e-6) -> Array:
    """`R` (..., 3, 3) itself, or a ValueError naming the first matrix that is not a proper rotation.

    The tolerance lets six printed digits pass and refuses anything that was scaled, sheared or mirrored.
    """
    # Loaded here: it brings numba, which a look at a file's help need not wait for.
    from kreisel.maths.rotations import rotation_defect

    finite(name, R)
    defect = rotation_defect(R.reshape(-1, 3, 3))
    bad = defect > tolerance
    if bad.any():
        k = int(np.argmax(bad))
        mirrored = np.linalg.det(R.reshape(-1, 3, 3)[k]) < 0.0
        why = "it mirrors (determinant -1)" if mirrored else f"R^T R differs from identity by {defect[k]:.2g}"
        where = f" at row {k}" if R.ndim > 2 else ""
        raise ValueError(f"{name} must hold rotation matrices{where}; {why}.")
    return R


def radians(name: str, phi: Array) -> Array:
    """Euler angles `phi` (n, 3) themselves, with a UserWarning where they look like degrees.

    Nobody counts pitch beyond a whole turn, nor does an angle step by 100 rad from one sample to the next, as degrees
    do where they wrap. Roll and heading may have been unwrapped over many turns.
    """
    pitch = np.abs(phi[:, 1]).max(initial=0.0)
    step = np.abs(np.diff(phi, axis=0)).max(initial=0.0)
    if pitch > 2.0 * np.pi or step > 100.0:
        what = f"an angle steps by {step:.4g}" if step > 100.0 else f"phi_y reaches {pitch:.4g}"
        warnings.warn(
            f"{name} is read as radians, but {what}: are these degrees? Then give np.deg2rad of them, "
            "otherwise matrices.",
            stacklevel=3,
        )
    return phi


def unit_quaternions(name: str, q: Array, tolerance: float = 1e-2) -> Array:
    """`q` (n, 4) scaled to unit length, or a ValueError where a row is too far from it to be round-off.

    Printed quaternions carry three digits or more; a length further than 1 % from one means other data.
    """
    finite(name, q)
    length = np.linalg.norm(q, axis=-1)
    bad = np.abs(length - 1.0) > tolerance
    if bad.any():
        k = int(np.argmax(bad))
        raise ValueError(
            f"{name} must be unit quaternions; row {k} has length {length[k]:.4g}. "
            "Check which columns are the quaternion and their order (wxyz or xyzw)."
        )
    return np.asarray(q / length[:, None], dtype=np.float64)


def file_name(name: str, value: Any) -> str:
    """`value` itself where files can be called so on any system, or a ValueError that names it."""
    if not isinstance(value, str) or not _FILE_NAME.fullmatch(value):
        raise ValueError(
            f"{name} must start with a letter or digit and hold letters, digits, blanks, _ + - . only, "
            f"as files are called by it; got {value!r:.80}."
        )
    return value


def finite_number(name: str, value: Any, above: float | None = None, zero: bool = True) -> float:
    """`value` as a finite float, or a ValueError: not above `above`, or 0 where that has no meaning."""
    try:
        x = np.nan if isinstance(value, bool | str) else float(value)
    except (TypeError, ValueError, OverflowError):
        x = np.nan
    if not np.isfinite(x):
        raise ValueError(f"{name} must be a finite number; got {value!r:.60}.")
    if above is not None and not x > above:
        raise ValueError(f"{name} must be above {above:g}; got {value!r:.60}.")
    if not zero and x == 0.0:
        raise ValueError(f"{name} must not be 0.")
    return x


def whole_number(name: str, value: Any) -> int:
    """`value` as an int, or a ValueError for what is no whole number, 0 or more."""
    try:
        number = -1 if isinstance(value, bool) else operator.index(value)
    except TypeError:
        number = -1
    if number < 0:
        raise ValueError(f"{name} must be a whole number, 0 or more; got {value!r:.60}.")
    return number


def instance(name: str, value: Any, kind: type[Any], cure: str) -> None:
    """Refuse what is not of `kind`; `cure` is how to come by one."""
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be of type {kind.__name__}; got {type(value).__name__}. {cure}")


# A longer list of options would bury the one that was meant.
_MOST_SHOWN = 24


def choice(name: str, value: Any, options: Sequence[str]) -> str:
    """`value` itself when it is one of `options`, else a ValueError that suggests the nearest."""
    if value in options:
        return str(value)
    import difflib

    begun = [option for option in options if value and option.startswith(str(value))]
    near = begun or difflib.get_close_matches(str(value), options, n=1)
    if not near:
        # "nde" is meant for "ned-frd": the first part of a name is what people remember.
        firsts = {option.split("-")[0]: option for option in reversed(options)}
        near = [firsts[first] for first in difflib.get_close_matches(str(value), firsts, n=1)]
    hint = f" Did you mean {near[0]!r}?" if near else ""
    shown = options
    if len(options) > _MOST_SHOWN:
        close = dict.fromkeys([*near, *difflib.get_close_matches(str(value), options, n=4, cutoff=0.4)])
        shown = list(close) or options[:_MOST_SHOWN]
    among = "one of" if shown is options else f"one of {len(options)} names, as"
    raise ValueError(f"{name} must be {among} {', '.join(map(repr, shown))}; got {value!r}.{hint}")


LARGEST = float(np.finfo(np.float64).max)
"""Upper bound of a number that must be finite."""


def per_axis(name: str, value: Any, unit: str, lowest: float = -LARGEST, highest: float = LARGEST) -> Array:
    """`value`, one number or one per axis, as a read-only array (3,); ValueError outside [lowest, highest]."""
    array = as_array(name, value)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name} must be one number or three, one per axis, {unit}; got {array.shape}.")
    if not ((array >= lowest) & (array <= highest)).all():
        raise ValueError(f"{name} must be {_between(lowest, highest)}, {unit}; got {array}.")
    return read_only(np.full(3, array))


def scalar(name: str, value: Any, unit: str, lowest: float = -LARGEST, highest: float = LARGEST) -> float:
    """`value` as a float, or a ValueError outside [lowest, highest] that names the unit."""
    array = as_array(name, value)
    if array.shape != () or not lowest <= float(array) <= highest:
        raise ValueError(f"{name} must be one number, {_between(lowest, highest)}, {unit}; got {value!r}.")
    return float(array)


def _between(lowest: float, highest: float) -> str:
    if highest < LARGEST:
        return f"from {lowest:g} to {highest:g}"
    return "finite" if lowest == -LARGEST else f"{lowest:g} or more"


def vector(name: str, value: Any, unit: str) -> Array:
    """`value` as a read-only array (3,), or a ValueError that names the unit."""
    array = as_array(name, value)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name} must be three finite numbers, {unit}; got {value!r:.80}.")
    return shaped(name, value, (3,))


def interval(start: Any, end: Any) -> tuple[float, float]:
    """`start` and `end` as floats, s, or a ValueError where they do not follow each other; `end` may be infinite."""
    first = scalar("start", start, "s")
    last = np.inf if isinstance(end, float) and end == np.inf else scalar("end", end, "s")
    if not last > first:
        raise ValueError(f"end must be after start, {first:g} s; got {last:g} s.")
    return first, last


def regular(name: str, value: Any, unit: str) -> Array:
    """`value` as a read-only matrix (3, 3), or a ValueError where it loses a direction."""
    matrix = finite(name, shaped(name, value, (3, 3)))
    # Columns that agree to eight digits cannot be told apart by any sensor.
    if not np.linalg.cond(matrix) < 1e8:
        raise ValueError(f"{name} must not be singular, {unit}; it loses a direction: {matrix.tolist()}.")
    return matrix
