"""Turns a velocity into a straight path at that velocity."""

from __future__ import annotations

from collections.abc import Sequence

from kreisel.data.checks import finite, shaped
from kreisel.data.trajectory import Trajectory
from kreisel.simulate.trajectories.functions import FunctionTrajectory


def line(velocity: Sequence[float] = (1.0, 0.0, 0.0), start: Sequence[float] = (0.0, 0.0, 0.0)) -> Trajectory:
    """A straight path from `start` (3,) m at t = 0 with `velocity` (3,) m/s, in N; nose along it."""
    v, p = (
        finite("velocity", shaped("velocity", velocity, (3,))),
        finite("start", shaped("start", start, (3,))),
    )
    return FunctionTrajectory(lambda t: tuple(p[k] + v[k] * t for k in range(3)), name="line")


def example() -> Trajectory:
    """Eastwards at 1 m/s."""
    return line()
