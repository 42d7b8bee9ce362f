"""Turns the motion of a sensor into what a perfect unit adds up, and sensed mean rates into what a real one does."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array, read_only
from kreisel.data.environment import Environment
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.maths.rotations import log_so3
from kreisel.maths.turning import State, falls, standing_still


def ideal_increments(at_sensor: Motion, world: Environment, name: str) -> ImuIncrements:
    """Increments between the stamps of a sensor's own motion: differences of its states, no integral of rates."""
    t = at_sensor.t
    seen_from_N = State(at_sensor.p_NB, at_sensor.v_NB, at_sensor.R_NB)
    p, v, R = standing_still(t, seen_from_N, world.omega_IN_N)
    dv_g, dp_g = falls(t, world.g_N, world.omega_IN_N)
    v_gain = np.diff(v, axis=0) - dv_g
    p_gain = np.diff(p, axis=0) - np.diff(t)[:, None] * v[:-1] - dp_g
    R_back = np.swapaxes(R[:-1], -1, -2)
    return ImuIncrements(
        t=t,
        dtheta=log_so3(R_back @ R[1:]),
        dv=np.einsum("nij,nj->ni", R_back, v_gain),
        dp=np.einsum("nij,nj->ni", R_back, p_gain),
        t0_ns=at_sensor.t0_ns,
        name=name,
    )


def added_up(
    ideal: ImuIncrements, gyro: Array, accel: Array, stamps: Array, lost: npt.NDArray[np.bool_], exact: bool
) -> ImuIncrements:
    """What is delivered at `stamps` (n + 1,) where the mean rates of `ideal` were sensed as gyro and accel (n, 3).

    lost (n,) : intervals that never arrive. exact : nothing has erred, so that dp is still known.
    """
    means = ideal.mean_rates()
    dtheta = _times_dt(ideal.dtheta, means.gyro, gyro, ideal.t)
    dv = _times_dt(ideal.dv, means.accel, accel, ideal.t)
    dp = np.array(ideal.dp) if exact else None
    for column in (dtheta, dv, *(() if dp is None else (dp,))):
        column[lost] = np.nan
    columns = (read_only(dtheta), read_only(dv), None if dp is None else read_only(dp))
    return ImuIncrements(read_only(stamps), *columns, ideal.t0_ns, ideal.name)


def _times_dt(ideal: Array, mean: Array, sensed: Array, t: Array) -> Array:
    # x / dt * dt may differ from x in its last bit, and what no effect touched is to stay what it was.
    return np.where(sensed == mean, ideal, sensed * np.diff(t)[:, None])
