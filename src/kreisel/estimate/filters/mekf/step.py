"""Turns gyro, accelerometer and magnetometer samples into attitude by the error-state filter.

Each sample turns R_NS by Exp and adds to the sums of a short window, which corrects the attitude when it closes.
"""

from kreisel.estimate.answers import Columns, tell
from kreisel.estimate.filters.mekf import layout as at
from kreisel.estimate.filters.mekf.one import step
from kreisel.estimate.filters.mekf.rival import attend
from kreisel.maths.kernels import inlined, kernel
from kreisel.maths.vectors import Array, load


@kernel
def update(state: Array, params: Array, sample: Array, dt: float) -> None:
    """One step, `sample` (9,) being gyro, accel and mag."""
    gyro, accel, mag = load(sample, 0), load(sample, 3), load(sample, 6)
    step(state, params, gyro, accel, mag, dt)
    if state[at.DUE] > 0.0:
        attend(state, params, gyro, accel, mag, dt)


@inlined
def tell_all(state: Array, out: Columns, i: int) -> None:
    """Put all that a state says in row i of `out`."""
    tell(state, out, i)
    out.gyro_bias[i, 0], out.gyro_bias[i, 1], out.gyro_bias[i, 2] = load(state, at.GYRO_BIAS)
    out.sigma[i, 0], out.sigma[i, 1], out.sigma[i, 2] = load(state, at.SIGMA)


@kernel
def batch(state: Array, params: Array, t: Array, gyro: Array, accel: Array, mag: Array, out: Columns) -> None:
    """The steps through all samples, and what the state says after each."""
    for i in range(t.shape[0]):
        g = gyro[i, 0], gyro[i, 1], gyro[i, 2]
        a = accel[i, 0], accel[i, 1], accel[i, 2]
        m = mag[i, 0], mag[i, 1], mag[i, 2]
        dt = t[i] - t[max(i - 1, 0)]
        step(state, params, g, a, m, dt)
        if state[at.DUE] > 0.0:
            attend(state, params, g, a, m, dt)
        tell_all(state, out, i)
