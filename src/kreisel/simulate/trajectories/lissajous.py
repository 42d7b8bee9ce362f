"""Turns amplitudes, harmonics and phases into a Lissajous loop, by default that of figure 1."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kreisel.data.checks import Array, finite, finite_number, shaped
from kreisel.data.trajectory import Trajectory
from kreisel.simulate.trajectories.functions import FunctionTrajectory


def lissajous(
    amplitude: Sequence[float] = (0.8, 0.8, 0.3),
    harmonic: Sequence[float] = (1.0, 1.0, 3.0),
    phase: Sequence[float] = (0.0, -0.5 * np.pi, 0.0),
    frequency: float = 1.0,
) -> Trajectory:
    """Position amplitude cos(2 pi frequency harmonic t + phase) in each axis of N, nose along the path.

    amplitude: (3,) m; harmonic: (3,); phase: (3,) rad; frequency: Hz.
    The default is figure 1 of document 000: (0.8 cos, 0.8 sin, 0.3 cos 3) at 1 Hz.
    """
    size, multiple, shift = (
        finite(name, shaped(name, value, (3,)))
        for name, value in (("amplitude", amplitude), ("harmonic", harmonic), ("phase", phase))
    )
    rate = 2.0 * np.pi * finite_number("frequency", frequency) * multiple
    return FunctionTrajectory(lambda t: _waves(t, size, rate, shift), name="lissajous")


def _waves(t: Array, size: Array, rate: Array, shift: Array) -> tuple[Array, ...]:
    return tuple(size[k] * np.cos(rate[k] * t + shift[k]) for k in range(3))


def example() -> Trajectory:
    """The loop of figure 1."""
    return lissajous()
