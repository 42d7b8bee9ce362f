"""Turns NumPy calls on an array of Taylor series into the rule that each function has, or into an error."""

from collections.abc import Callable, Iterator
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kreisel.maths.jets import refusals
from kreisel.maths.jets.series import Array, Row, Series, derivative, linear, powers

UFUNC_RULES: dict[Any, Callable[..., Any]] = {}
FUNCTION_RULES: dict[Any, Callable[..., Any]] = {}

_MATH = "use NumPy's function of that name (np.sin for math.sin) and NumPy arrays"


class Jet(np.lib.mixins.NDArrayOperatorsMixin):
    """An array of functions of time, each known by its value and derivatives up to `order` at its own time.

    rows  : normalised Taylor coefficients, one row per order; see `series`. Treated as immutable.
    order : highest derivative that is known; rows beyond `len(rows)` are zero.

    Conditions (`t > 1`) are jets too, with boolean values, known to `np.where`, `&` and `x[t > 1] = ...`.
    """

    __slots__ = ("_memo", "order", "rows")

    def __init__(self, rows: Series, order: int) -> None:
        self.rows = rows[: order + 1]
        self.order = order
        self._memo: dict[Any, Any] = {}

    @staticmethod
    def variable(t: ArrayLike, order: int) -> "Jet":
        """The time itself, t in seconds, of any shape."""
        return Jet((np.array(t, dtype=np.float64), 1.0), order)

    def derivative(self, k: int) -> NDArray[np.float64]:
        """The k-th derivative in time, a fresh array of this jet's shape; k = 0 is the value."""
        if not 0 <= k <= self.order:
            raise ValueError(f"this jet knows derivatives 0..{self.order}; got {k}. Ask for a higher order.")
        row = self.rows[k] if k < len(self.rows) else 0.0
        return np.array(np.broadcast_to(np.multiply(row, float(factorial(k))), self.shape))

    def rate(self) -> "Jet":
        """The derivative in time as a jet, of one order less."""
        if self.order == 0:
            raise ValueError("a jet of order 0 knows no derivative. Ask for a higher order.")
        return Jet(derivative(self.rows), self.order - 1)

    def twin(self) -> "Jet":
        """Another jet of the same series, and the same memory; assigning to one leaves the other alone."""
        twin = Jet(self.rows, self.order)
        twin._memo = self._memo
        return twin

    def remember(self, key: Any, make: Callable[[], Any]) -> Any:
        """What `make` returns, computed once per jet: sin and cos of one argument share their work."""
        if key not in self._memo:
            self._memo[key] = make()
        return self._memo[key]

    def powers(self) -> list[dict[int, Row]]:
        """Powers of this jet less its value, shared by all functions of it."""
        table: list[dict[int, Row]] = self.remember("powers", lambda: powers(self.rows, self.order))
        return table

    # --- what NumPy asks ---

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        rule, name = UFUNC_RULES.get(ufunc), refusals.public_name(ufunc)
        if method != "__call__":
            raise refusals.no_rule(f"{name}.{method}")
        if rule is None:
            raise refusals.no_rule(name)
        out = kwargs.pop("out", None)
        if kwargs or (out is not None and out[0] is not self):
            what = f"{name} with out=, where= or dtype=, or x += ... on a plain array,"
            raise refusals.loses_derivatives(what, "write x = x + ...")
        return rule(*inputs)

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        rule = FUNCTION_RULES.get(function)
        if rule is None:
            raise refusals.no_rule(refusals.public_name(function))
        return rule(*args, **kwargs)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if self.dtype == np.bool_:
            return np.array(self.value, dtype=dtype)  # conditions have no derivatives to lose
        if dtype is not None:
            raise refusals.taken_as_plain_array()
        # np.array([x, y, z]) cannot be overridden: it gets a box, to be returned and for nothing else. The box
        # has an axis, because from boxes without one NumPy keeps the jets themselves and calculates with them.
        holder = np.empty(1, dtype=object)
        holder[0] = Packed(self)
        return holder

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or not hasattr(np.ndarray, name):
            raise AttributeError(f"a function of time has no attribute {name!r}")
        if name == "astype" or not hasattr(np, name):
            raise refusals.loses_derivatives(f"t.{name}", "leave it out")
        function = getattr(np, name)
        return lambda *args, **kwargs: function(self, *args, **kwargs)

    # --- what makes it look like an array ---

    @property
    def value(self) -> Array:
        """Row 0; not to be written to."""
        return np.asarray(self.rows[0])

    @property
    def shape(self) -> tuple[int, ...]:
        return np.shape(self.rows[0])

    @property
    def ndim(self) -> int:
        return len(self.shape)

    @property
    def size(self) -> int:
        return int(np.size(self.rows[0]))

    @property
    def dtype(self) -> np.dtype[Any]:
        return self.value.dtype

    @property
    def T(self) -> "Jet":
        return self.arranged(np.transpose)

    @property
    def real(self) -> "Jet":
        return Jet(linear(np.real, [self.rows]), self.order)

    @property
    def imag(self) -> "Jet":
        return Jet(linear(np.imag, [self.rows]), self.order)

    def astype(self, dtype: Any) -> "Jet":
        """Numbers from a condition, (t > 1).astype(float); for anything else it would lose derivatives."""
        if self.dtype != np.bool_ or not np.issubdtype(dtype, np.number):
            raise refusals.loses_derivatives("t.astype", "leave it out")
        return Jet((self.value.astype(dtype),), self.order)

    def reshape(self, *shape: Any) -> "Jet":
        wanted = shape[0] if len(shape) == 1 else shape
        return self.arranged(lambda row: np.reshape(row, wanted))

    def arranged(self, arrange: Callable[[Array], Array]) -> "Jet":
        """This jet with its elements picked or moved by `arrange`, which sees rows of full shape."""
        return Jet(tuple(arrange(np.broadcast_to(row, self.shape)) for row in self.rows), self.order)

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator["Jet"]:
        if self.ndim < 2:
            raise refusals.single_sample("i")
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index: Any) -> "Jet":
        self._check_index(index)
        return self.arranged(lambda row: row[_plain_index(index)])

    def __setitem__(self, index: Any, value: Any) -> None:
        self._check_index(index)
        place = _plain_index(index)
        rows = value.rows if isinstance(value, Jet) else (value,)
        order = min(self.order, value.order) if isinstance(value, Jet) else self.order
        kind = np.result_type(self.value, rows[0])
        changed = []
        for k in range(max(len(self.rows), len(rows))):
            # A fresh row each time: other jets may share the old ones.
            row = np.array(
                np.broadcast_to(self.rows[k] if k < len(self.rows) else 0.0, self.shape), dtype=kind
            )
            row[place] = rows[k] if k < len(rows) else 0.0
            changed.append(row)
        self.rows, self.order, self._memo = tuple(changed[: order + 1]), order, {}

    def _check_index(self, index: Any) -> None:
        if self.ndim != 1:
            return
        for part in index if isinstance(index, tuple) else (index,):
            if not _keeps_samples(part):
                raise refusals.single_sample(part)

    def __contains__(self, time: Any) -> bool:
        raise refusals.no_branch()

    def __repr__(self) -> str:
        return f"Jet(order={self.order}, shape={self.shape}, value={self.value!r})"

    # --- what would lose the derivatives ---

    def __bool__(self) -> bool:
        raise refusals.no_branch()

    def __float__(self) -> float:
        raise refusals.loses_derivatives("float(t), or a function of `math`,", _MATH)

    def __int__(self) -> int:
        raise refusals.loses_derivatives("int(t)", "use np.floor or np.round")

    def __index__(self) -> int:
        raise refusals.loses_derivatives("table[t]", "use np.interp, np.where or np.select")

    def __complex__(self) -> complex:
        raise refusals.loses_derivatives("complex(t), or a function of `cmath`,", _MATH)


def _keeps_samples(part: Any) -> bool:
    if part is None or part is Ellipsis or isinstance(part, slice):
        return not isinstance(part, slice) or part == slice(None)
    return isinstance(part, Jet | np.ndarray) and part.dtype == np.bool_


def _plain_index(index: Any) -> Any:
    if isinstance(index, tuple):
        return tuple(_plain_index(part) for part in index)
    return index.value if isinstance(index, Jet) else index


class Packed(np.lib.mixins.NDArrayOperatorsMixin):
    """A jet inside an object array, as np.array([x, y, z]) makes it: it may be returned and nothing else.

    Calculating with it could go wrong without a word: np.asarray(t) has one element, its maximum being t.
    """

    __slots__ = ("jet",)

    def __init__(self, jet: Jet) -> None:
        self.jet = jet

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        raise refusals.taken_as_plain_array()

    def _refuse(self, *args: Any, **kwargs: Any) -> Any:
        raise refusals.taken_as_plain_array()

    def __getattr__(self, name: str) -> Any:
        # NumPy's loops over objects call a method of the function's name.
        if name.startswith("__"):
            raise AttributeError(name)
        return self._refuse

    __bool__ = __float__ = __int__ = __complex__ = __index__ = __len__ = __iter__ = _refuse
