"""Turns white numbers into first-order Gauss-Markov processes, discretised exactly."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]

SAME_STEP = 1e-9
"""Steps that differ by less, relatively, use the same decay: stamps of an even clock differ by round-off."""


def markov_state() -> Array:
    """State of a process on three axes before the first sample."""
    return np.zeros(10)


def add_markov(
    block: Array, state: Array, sigma: Array, rate: Array, dt: Array, first: int, white: Array
) -> Array:
    """`block` (n, 3) plus a stationary process; `state`, begun by `markov_state()`, is carried on.

    sigma: (3,) standard deviation; rate: (3,) 1/s, inverse time constant; dt: (n,) s, since the sample before;
    first: number of the first sample: number 0 is drawn from the stationary distribution, sigma * white;
    white: (n, 3) standard normal numbers, in whose place the result is written.
    x_k = exp(-rate dt) x_(k-1) + sigma sqrt(1 - exp(-2 rate dt)) white_k: exact for any dt.
    """
    _add_markov(argument(block), state, argument(sigma), argument(rate), argument(dt), first, white)
    return white


@kernel
def _add_markov(
    block: Array, state: Array, sigma: Array, rate: Array, dt: Array, first: int, out: Array
) -> None:
    begin = 0
    if first == 0:
        begin = 1
        state[0] = 0.0
        for a in range(3):
            state[7 + a] = sigma[a] * out[0, a]
            out[0, a] = block[0, a] + state[7 + a]
    # In local variables, since the compiler cannot know that `out` and `state` do not overlap.
    step, d0, d1, d2, k0, k1, k2, x, y, z = state
    for k in range(begin, dt.shape[0]):
        if abs(dt[k] - step) > SAME_STEP * dt[k]:
            step = dt[k]
            d0, d1, d2 = np.exp(-rate[0] * step), np.exp(-rate[1] * step), np.exp(-rate[2] * step)
            k0 = sigma[0] * np.sqrt(-np.expm1(-2.0 * rate[0] * step))
            k1 = sigma[1] * np.sqrt(-np.expm1(-2.0 * rate[1] * step))
            k2 = sigma[2] * np.sqrt(-np.expm1(-2.0 * rate[2] * step))
        x, y, z = d0 * x + k0 * out[k, 0], d1 * y + k1 * out[k, 1], d2 * z + k2 * out[k, 2]
        out[k, 0], out[k, 1], out[k, 2] = block[k, 0] + x, block[k, 1] + y, block[k, 2] + z
    state[:] = np.array([step, d0, d1, d2, k0, k1, k2, x, y, z])


def markov_allan_deviation(sigma: Array, rate: Array, tau: Array) -> Array:
    """Allan deviation (k, 3) at averaging times tau (k,) s of the sum of processes sigma, rate (m, 3).

    sigma_A^2 = (2 sigma^2 T / tau) (1 - (3 - 4 exp(-y) + exp(-2 y)) / (2 y)), y = tau / T.
    Source: IEEE Std 952, annex C, exponentially correlated (Markov) noise.
    """
    y = tau[:, None, None] * rate
    # Below 1e-3 the closed form cancels; the series leaves less than 1e-6 of the value.
    small = y < 1e-3
    z = np.where(small, 1.0, y)
    closed = 2.0 / z * (1.0 - (3.0 - 4.0 * np.exp(-z) + np.exp(-2.0 * z)) / (2.0 * z))
    variance = sigma**2 * np.where(small, 2.0 / 3.0 * y * (1.0 - 0.75 * y), closed)
    return np.asarray(np.sqrt(variance.sum(axis=1)))
