"""Turns white numbers into first-order Gauss-Markov processes, discretised exactly, one or many at a time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import argument, kernel

Array = npt.NDArray[np.float64]

SAME_STEP = 1e-9
"""Steps that differ by less, relatively, use the same decay: stamps of an even clock differ by round-off."""


def markov_state(processes: int) -> Array:
    """State of that many processes on three axes, before the first sample."""
    return np.zeros(1 + 9 * processes)


def markov_sum(state: Array, sigma: Array, rate: Array, dt: Array, first: int, white: Array) -> Array:
    """Sum (n, 3) of m stationary processes at n samples; `state`, of `markov_state(m)`, is carried on.

    sigma: (m, 3) standard deviations; rate: (m, 3) 1/s, inverse time constants; dt: (n,) s, since the sample before;
    first: number of the first sample: number 0 is drawn from the stationary distribution, sigma * white;
    white: (n, 3 m) standard normal numbers, process by process.
    x_k = exp(-rate dt) x_(k-1) + sigma sqrt(1 - exp(-2 rate dt)) white_k: exact for any dt.
    """
    out = np.empty((len(dt), 3))
    _markov_sum(
        state, argument(sigma.reshape(-1)), argument(rate.reshape(-1)), argument(dt), first, white, out
    )
    return out


@kernel
def _markov_sum(
    state: Array, sigma: Array, rate: Array, dt: Array, first: int, white: Array, out: Array
) -> None:
    m = sigma.shape[0]
    decay, kick, x = state[1 : 1 + m], state[1 + m : 1 + 2 * m], state[1 + 2 * m :]
    for k in range(dt.shape[0]):
        if abs(dt[k] - state[0]) > SAME_STEP * dt[k]:
            state[0] = dt[k]
            for i in range(m):
                decay[i] = np.exp(-rate[i] * dt[k])
                kick[i] = sigma[i] * np.sqrt(-np.expm1(-2.0 * rate[i] * dt[k]))
        if first + k == 0:
            for i in range(m):
                x[i] = sigma[i] * white[0, i]
        else:
            for i in range(m):
                x[i] = decay[i] * x[i] + kick[i] * white[k, i]
        for a in range(3):
            total = 0.0
            for i in range(a, m, 3):
                total += x[i]
            out[k, a] = total


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
