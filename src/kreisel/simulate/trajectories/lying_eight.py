"""Turns a period into a figure eight that lies on its side and rises and dips three times on its way."""

from __future__ import annotations

import numpy as np

from kreisel.data.checks import finite_number
from kreisel.data.trajectory import Trajectory
from kreisel.simulate.trajectories.functions import FunctionTrajectory


def lying_eight(period: float = 1.0, length: float = 0.8, height: float = 0.3) -> Trajectory:
    """The path (length cos u, length sin u cos u, height cos 3 u) m with u = 2 pi t / period, nose along it.

    period: s; length: m, half the extent along x; height: m, 0 makes it level.
    """
    finite_number("length", length)
    finite_number("height", height)
    rate = 2.0 * np.pi / finite_number("period", period, zero=False)
    return FunctionTrajectory(
        (
            lambda t: length * np.cos(rate * t),
            lambda t: length * np.sin(rate * t) * np.cos(rate * t),
            lambda t: height * np.cos(3.0 * rate * t),
        ),
        name="lying eight",
    )


figure_eight = lying_eight
"""The same path under the name most people look for."""


def example() -> Trajectory:
    """Once in 8 s, the pace of a hand."""
    return lying_eight(period=8.0)
