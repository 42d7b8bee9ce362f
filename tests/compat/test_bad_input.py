"""Wrong input is told in one sentence: what, received, what to do."""

from collections.abc import Callable

import numpy as np
import pytest

from kreisel.compat import my_ang, my_imu, my_lin, my_rotate, my_tang

T = np.arange(5) * 0.1
X = np.cos(T[:, None] * [1.0, 2.0, 3.0])
NAN = np.where(np.arange(15).reshape(5, 3) == 7, np.nan, X)
STILL = np.array([0.0, 0.1, 0.1, 0.2, 0.3])
FUNCTIONS = (np.cos, np.sin, np.cos)

REFUSED: dict[str, tuple[type[Exception], str, Callable[[], object]]] = {
    "transposed": (ValueError, r"s must be \(n, 3\); got \(3, 5\).*s\.T", lambda: my_lin(X.T, "num", T)),
    "option": (
        ValueError,
        "option must be one of 'num', 'sym'; got 'numeric'",
        lambda: my_lin(X, "numeric", T),
    ),
    "nan": (ValueError, "s must be finite; row 2", lambda: my_lin(NAN, "num", T)),
    "still": (ValueError, "t_ must increase strictly; it stands still", lambda: my_lin(X, "num", STILL)),
    "back": (ValueError, "t_ must increase strictly; it runs back", lambda: my_ang(X, "num", T[::-1])),
    "length": (
        ValueError,
        "s must have one row per time stamp; got 5 rows for 4",
        lambda: my_lin(X, "num", T[:4]),
    ),
    "one stamp": (ValueError, "t_ must hold two stamps or more", lambda: my_ang(X[:1], "num", T[:1])),
    "time matrix": (ValueError, r"t must be \(n,\); got \(5, 3\)", lambda: my_tang(X, X)),
    "functions as samples": (TypeError, 'Use option "sym"', lambda: my_lin(FUNCTIONS, "num", T)),
    "samples as functions": (TypeError, "three functions of time", lambda: my_lin(X, "sym", T)),
    "a number among functions": (
        TypeError,
        r"got \(a function, a function, 0\); write a constant as a function too",
        lambda: my_lin([np.cos, np.sin, 0], "sym", T),
    ),
    "two functions": (TypeError, "got 2 items", lambda: my_ang(FUNCTIONS[:2], "sym", T)),
    "one function": (TypeError, "got function", lambda: my_ang(lambda t: t, "sym", T)),
    "words": (TypeError, "phi must be an array of numbers", lambda: my_ang([["a", "b", "c"]], "num", T)),
    "rest": (ValueError, "v must not be zero: row 3 is", lambda: my_tang(X * [[1], [1], [1], [0], [1]], T)),
    "convention": (ValueError, "convention must be one of", lambda: my_rotate(X, X, T, convention="physics")),
    "angles": (ValueError, "phi must be finite", lambda: my_rotate(NAN, X, T)),
    "lever arm": (ValueError, r"r must be \(3,\); got \(2,\)", lambda: my_imu(X, X, X, [1.0, 2.0], T)),
    "lever arm nan": (ValueError, "r must be finite", lambda: my_imu(X, X, X, [1.0, 2.0, np.inf], T)),
}


@pytest.mark.parametrize("case", REFUSED, ids=str)
def test_refused(case: str) -> None:
    error, message, call = REFUSED[case]
    with pytest.raises(error, match=message):
        call()


def test_inputs_are_left_alone() -> None:
    before = X.copy()
    s, _, _ = my_lin(X, "num", T)
    s += 1.0
    phi, omega, alpha = my_ang(X, "num", T)
    phi += 1.0
    my_imu(my_rotate(X, X, T), omega, alpha, [1.0, 0.0, 0.0], T)
    np.testing.assert_array_equal(X, before)
