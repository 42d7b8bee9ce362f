"""Turns plain Python functions into compiled kernels, and holds the SO(3) primitives they share.

The one place that names numba. The policy: cached on disk, no fast-math (streaming and batch stay
bit-identical, NaN keeps its meaning), IEEE division, no Python exceptions, GIL released.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_F = TypeVar("_F", bound=Callable[..., object])


def kernel(function: _F) -> _F:
    """Compile `function` at its first call; the machine code is cached on disk."""
    return cast(_F, numba.njit(cache=True, fastmath=False, nogil=True, error_model="numpy")(function))


def argument(x: npt.ArrayLike) -> Array:
    """`x` as kernels take their inputs: contiguous, float64, read-only whoever made it.

    numba compiles writable and read-only arrays apart; with one kind there is one compilation.
    """
    view = np.ascontiguousarray(x, dtype=np.float64).view()
    view.flags.writeable = False
    return view


def inlined(function: _F) -> _F:
    """The same for the small functions of an inner loop, which LLVM is told to dissolve in their callers.

    Left to itself it keeps many of them as calls, each dearer than the sums inside; pass numbers and tuples of
    numbers rather than arrays, whose reference counts cost more still (a filter step of 60 ns took 260).
    """
    compiled = numba.njit(cache=True, fastmath=False, nogil=True, error_model="numpy", forceinline=True)
    return cast(_F, compiled(function))
