"""Turns a function of time written with ordinary NumPy into its exact derivatives of any order.

A `Jet` is an array of truncated Taylor series in time. It meets NumPy through `__array_ufunc__` and
`__array_function__`, so `lambda t: 0.8 * np.cos(2 * np.pi * f * t)` works on it unchanged. `differentiate` is
the door most callers want.

Conventions where a function has no derivative (kinks and jumps):

* `abs`, `minimum`, `maximum`, `fmin`, `fmax`, `clip` and `interp` give the derivative from the right,
  in time: `abs(t)` has slope +1 at 0, and so has `abs(-t)`.
* `where`, `select`, `piecewise` follow their condition, which looks at values alone:
  `where(t > 1, a, b)` is `b` at 1. Assigning, `x[t > 1] = a`, works likewise on what `zeros_like(t)` made.
* `floor`, `ceil`, `trunc`, `round`, `sign`, `heaviside`, `//` and comparisons are constant between
  their jumps; the jump itself has no derivative here. `%` and `fmod` have the slopes of their pieces.
* `sqrt`, `cbrt` and fractional powers have infinite derivatives at 0 and give inf (or nan, where an inner
  derivative is 0). `hypot`, `linalg.norm` and `arctan2` of a vector that vanishes give nan: neither its
  length nor its direction is smooth there. No warnings are shown.
"""

from kreisel.maths.jets import arithmetic, functions, pieces, smooth  # noqa: F401  (they register the rules)
from kreisel.maths.jets.evaluate import differentiate
from kreisel.maths.jets.jet import Jet

__all__ = ["Jet", "differentiate"]
