"""Turns plain Python functions into compiled kernels, and holds the SO(3) primitives they share.

The one place that names numba. The policy: cached on disk, no fast-math (streaming and batch stay
bit-identical, NaN keeps its meaning), IEEE division, no Python exceptions, GIL released. Where the usual folders
for the cache cannot be written, it goes to one for temporary files.
"""

from __future__ import annotations

import os
import stat
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba.extending import intrinsic

from kreisel.maths.sources import stamp

Array = npt.NDArray[np.float64]

_CONFIG: Any = numba.config

_F = TypeVar("_F", bound=Callable[..., object])


def kernel(function: _F) -> _F:
    """Compile `function` at its first call; the machine code is cached on disk."""
    return _compiled(function)


def _compiled(function: _F, **options: Any) -> _F:
    def compiled(cache: bool) -> _F:
        policy = numba.njit(cache=cache, fastmath=False, nogil=True, error_model="numpy", **options)
        return cast(_F, policy(function))

    try:
        return _fresh(compiled(cache=True), function)
    except RuntimeError as error:
        # Neither the package's own folder nor the user's cache can be written: numba refuses at once.
        if "locator" not in str(error):
            raise
    _cache_elsewhere()
    return _fresh(compiled(cache=bool(_CONFIG.CACHE_DIR)), function)


def _fresh(dispatcher: _F, function: _F) -> _F:
    """`dispatcher`, whose cache is out of date as soon as any source is that its kernel is made of.

    numba looks at the kernel's own file alone, and runs old code where a function of another file has changed.
    """
    index: Any = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    # Not of numba's public face: where another version keeps it elsewhere, caches are what they are without this.
    if hasattr(index, "_source_stamp"):
        index._source_stamp = stamp(Path(function.__code__.co_filename))
    return dispatcher


def _cache_elsewhere() -> None:
    """Have numba cache in a folder for temporary files, or say once that nothing is cached."""
    try:
        folder = Path(tempfile.gettempdir()) / f"kreisel-numba-{_user()}"
        folder.mkdir(mode=0o700, exist_ok=True)
        usable = os.access(folder, os.W_OK) and (os.name != "posix" or _mine_alone(folder))
    except OSError:
        usable = False
    # Loading a cache runs what is in it: a folder that somebody else may write to is not used.
    if usable:
        _CONFIG.CACHE_DIR = str(folder)
        return
    warnings.warn(
        "compiled code cannot be cached, so that every start takes seconds longer: set NUMBA_CACHE_DIR to a folder "
        "that can be written.",
        stacklevel=2,
    )


def _mine_alone(folder: Path) -> bool:
    there = folder.lstat()
    return stat.S_ISDIR(there.st_mode) and there.st_uid == os.geteuid() and not there.st_mode & 0o022


def _user() -> str:
    return str(os.geteuid()) if os.name == "posix" else "user"


def argument(x: npt.ArrayLike) -> Array:
    """`x` as kernels take their inputs: contiguous, float64, read-only whoever made it.

    numba compiles writable and read-only arrays apart; with one kind there is one compilation.
    """
    if type(x) is np.ndarray and x.dtype == np.float64 and x.flags.c_contiguous and not x.flags.writeable:
        return x
    view = np.ascontiguousarray(x, dtype=np.float64).view()
    view.flags.writeable = False
    return view


LANES = 16
"""Runs that go abreast, one in each lane of vector instructions: two vectors of 512 bits, or four of 256."""

ROW = 768
"""Numbers in a row of three axes over and over: enough that a loop over one is worth its vectors."""


@kernel
def row_of_axes(parameter: Array) -> Array:
    """A value (3,) per axis, repeated along a row (768,) beside which readings (256, 3) lie flat.

    LLVM makes vectors of a loop over such rows, but not of one over samples and their three axes.
    """
    row = np.empty(ROW)
    for k in range(0, ROW, 3):
        row[k], row[k + 1], row[k + 2] = parameter[0], parameter[1], parameter[2]
    return row


def inlined(function: _F) -> _F:
    """The same for the small functions of an inner loop, which LLVM is told to dissolve in their callers.

    Left to itself it keeps many of them as calls, each dearer than the sums inside; pass numbers and tuples of
    numbers rather than arrays, whose reference counts cost more still (a filter step of 60 ns took 260).
    """
    return _compiled(function, forceinline=True)


def _fused(context: Any, a: Any, b: Any, c: Any) -> Any:
    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fma(*arguments)

    return numba.types.float64(*[numba.types.float64] * 3), generate


fused: Callable[[float, float, float], float] = cast(Any, intrinsic)(_fused)
"""a b + c of (a, b, c), rounded once as IEEE 754 defines it: the same bits everywhere, in one instruction.

Asked for by name where a polynomial is worth it; the compiler makes none by itself, or results would depend on it.
"""


@cast(Any, intrinsic)
def put_in_lanes(context: Any, out: Any, place: Any, a: Any, b: Any, x: Any, source: Any) -> Any:
    """out[place + j] = a + b x[source + j] for all LANES; of flat arrays whose ends nobody checks.

    LLVM makes scalars of a loop so short: it unrolls it, and then cannot know that `out` and `x` are two arrays.
    """

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = ir.VectorType(ir.DoubleType(), LANES)

        def at(array: int, index: Any) -> Any:
            data = target.make_array(signature.args[array])(target, builder, arguments[array]).data
            return builder.bitcast(builder.gep(data, [index]), lanes.as_pointer())

        def all_over(number: Any) -> Any:
            one = builder.insert_element(
                ir.Constant(lanes, ir.Undefined), number, ir.Constant(ir.IntType(32), 0)
            )
            mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
            return builder.shuffle_vector(one, ir.Constant(lanes, ir.Undefined), mask)

        _, index, shift, factor, _, begin = arguments
        product = builder.fmul(all_over(factor), builder.load(at(4, begin), align=8))
        builder.store(builder.fadd(all_over(shift), product), at(0, index), align=8)
        return target.get_dummy_value()

    flat, index, number = numba.types.Array(numba.float64, 1, "C"), numba.types.intp, numba.types.float64
    return numba.types.none(flat, index, number, number, flat, index), generate


@cast(Any, intrinsic)
def wide_vectors(context: Any) -> Any:
    """Called in a kernel: its loops may use the widest vectors there are, 512 bits where the compiler prefers 256.

    For loops over lanes whose operations wait for each other: half as many vectors wait half as long. Widths change
    no result. The kernel that such a kernel is called from must call this as well, for it may swallow the other.
    """

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        # Past llvmlite's list of names: it knows no attribute with a value, but writes what it is given. A version
        # that keeps them elsewhere leaves vectors as they are.
        if isinstance(builder.function.attributes, set):
            set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return target.get_dummy_value()

    return numba.types.none(), generate
