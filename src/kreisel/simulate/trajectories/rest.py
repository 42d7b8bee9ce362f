"""Turns a place and an attitude into a body that stays there."""

from __future__ import annotations

from collections.abc import Sequence

from kreisel.data.trajectory import Trajectory
from kreisel.simulate.trajectories.functions import FunctionTrajectory


def rest(position: Sequence[float] = (0.0, 0.0, 0.0), phi: Sequence[float] = (0.0, 0.0, 0.0)) -> Trajectory:
    """A body at rest at `position` (3,) m in N with Euler angles `phi` (3,) rad."""
    return FunctionTrajectory(tuple(position), tuple(phi), name="rest")


def example() -> Trajectory:
    """Level at the origin."""
    return rest()
