"""Turns a radius, a pitch and a period into a path that winds upwards."""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import finite_number
from kreisel.data.trajectory import Trajectory
from kreisel.simulate.trajectories.functions import FunctionTrajectory


def helix(radius: float = 1.0, pitch: float = 0.5, period: float = 4.0) -> Trajectory:
    """A helix of `radius` m around z that rises by `pitch` m in every turn of `period` s; nose along it."""
    finite_number("radius", radius)
    finite_number("pitch", pitch)
    rate = 2.0 * np.pi / finite_number("period", period, zero=False)
    return FunctionTrajectory(
        (
            lambda t: radius * np.cos(rate * t),
            lambda t: radius * np.sin(rate * t),
            lambda t: pitch / period * t,
        ),
        name="helix",
    )


def example() -> Trajectory:
    """Radius 1 m, rising 0.5 m a turn."""
    return helix()
