"""Turns a radius and a period into a level circle."""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import finite_number
from kreisel.data.trajectory import Trajectory
from kreisel.simulate.trajectories.functions import FunctionTrajectory


def circle(radius: float = 1.0, period: float = 4.0) -> Trajectory:
    """A circle of `radius` m around the origin, once in `period` s, counter-clockwise; nose along it.

    A negative period runs clockwise. The centripetal acceleration is radius (2 pi / period)^2.
    """
    finite_number("radius", radius)
    rate = 2.0 * np.pi / finite_number("period", period, zero=False)
    return FunctionTrajectory(
        (lambda t: radius * np.cos(rate * t), lambda t: radius * np.sin(rate * t), 0.0), name="circle"
    )


def example() -> Trajectory:
    """Radius 1 m, 4 s a turn."""
    return circle()
