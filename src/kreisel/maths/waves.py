"""Turns frequencies and coefficients into a sum of waves at any times."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel
from kreisel.maths.sincos import sincos

Array = npt.NDArray[np.float64]


def add_waves(x: Array, t: Array, frequency: Array, cosines: Array, sines: Array) -> Array:
    """x (n, 3) plus sum_i cosines_i cos(2 pi f_i t) + sines_i sin(2 pi f_i t) at times t (n,) s.

    frequency: (m,) Hz; cosines, sines: (m, 3) in the unit of x. The phase errs by the round-off of f t.
    """
    out = np.array(x)
    _add_waves(argument(t), argument(frequency), argument(cosines), argument(sines), out)
    return out


def add_mean_waves(x: Array, t: Array, dt: Array, frequency: Array, cosines: Array, sines: Array) -> Array:
    """x (n, 3) plus the means of the same waves from t - dt to t, both (n,) s: the integral of each over its dt."""
    omega = 2.0 * np.pi * frequency[:, None]
    # The integral of a cos + b sin is (a sin - b cos) / omega.
    integral = (frequency, -sines / omega, cosines / omega)
    area = add_waves(np.zeros_like(x), t, *integral) - add_waves(np.zeros_like(x), t - dt, *integral)
    return np.asarray(x + area / dt[:, None])


@kernel
def _add_waves(t: Array, frequency: Array, cosines: Array, sines: Array, out: Array) -> None:
    angle, sine, cosine = np.empty(t.shape[0]), np.empty(t.shape[0]), np.empty(t.shape[0])
    for i in range(frequency.shape[0]):
        for k in range(t.shape[0]):
            # Whole turns are dropped first: small angles have the fast sine.
            turns = frequency[i] * t[k]
            angle[k] = 2.0 * np.pi * (turns - np.floor(turns))
        sincos(angle, sine, cosine)
        for k in range(t.shape[0]):
            for a in range(3):
                out[k, a] += cosines[i, a] * cosine[k] + sines[i, a] * sine[k]
