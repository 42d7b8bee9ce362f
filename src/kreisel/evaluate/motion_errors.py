"""Turns a true and an estimated motion into the errors between them: position, velocity, attitude."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.cards import Card, Shown, course
from kreisel.data.checks import SAME_INSTANT, Array, read_only
from kreisel.data.motion import Motion
from kreisel.maths.rotations import log_so3


@dataclass(frozen=True, slots=True, eq=False)
class MotionErrors(Shown):
    """Estimate minus truth at the stamps of the truth, in N; attitude as R_est = Exp(dtheta_N) R_true."""

    t: Array  # (n,) s after t0_ns
    dp_N: Array  # (n, 3) m
    dv_N: Array  # (n, 3) m/s
    dtheta_N: Array  # (n, 3) rad, rotation vector
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""

    def __len__(self) -> int:
        return len(self.t)

    def card(self) -> Card:
        """RMSE, the largest and the last of position, velocity and attitude."""
        parts = (
            ("position, m", self.position),
            ("velocity, m/s", self.velocity),
            ("attitude, rad", self.attitude),
        )
        rows = [
            (name, *(f"{value:.3g}" for value in (np.sqrt(np.mean(np.square(x))), x.max(), x[-1])))
            for name, x in parts
        ]
        return Card(course(self, self.t), ("error", "rmse", "max", "at the end"), rows)

    @property
    def position(self) -> Array:
        """(n,) m, length of the position error."""
        return np.asarray(np.linalg.norm(self.dp_N, axis=1))

    @property
    def velocity(self) -> Array:
        """(n,) m/s, length of the velocity error."""
        return np.asarray(np.linalg.norm(self.dv_N, axis=1))

    @property
    def attitude(self) -> Array:
        """(n,) rad, angle of the attitude error."""
        return np.asarray(np.linalg.norm(self.dtheta_N, axis=1))


def motion_errors(truth: Motion, estimate: Motion) -> MotionErrors:
    """Errors of `estimate` against `truth`, two motions of one frame at the same stamps.

    Nothing is interpolated or aligned. Raises ValueError where the stamps differ.
    """
    shift = (estimate.t0_ns - truth.t0_ns) / 1e9
    if len(truth) != len(estimate) or np.any(np.abs(estimate.t + shift - truth.t) > SAME_INSTANT):
        raise ValueError(
            f"truth and estimate must have the same stamps; got {len(truth)} and {len(estimate)} rows"
            " or different times. Sample the truth at the estimate's stamps."
        )
    return MotionErrors(
        t=truth.t,
        dp_N=read_only(estimate.p_NB - truth.p_NB),
        dv_N=read_only(estimate.v_NB - truth.v_NB),
        dtheta_N=read_only(log_so3(estimate.R_NB @ np.swapaxes(truth.R_NB, -1, -2))),
        t0_ns=truth.t0_ns,
        name=estimate.name,
    )
