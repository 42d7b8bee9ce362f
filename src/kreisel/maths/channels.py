"""Turns rates that are kept for a while, and ramps between them, into a smooth quantity over time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.polynomials import Polynomials, hermite

Array = npt.NDArray[np.float64]

RAMP_SLOPE = 1.875
"""Largest slope of a ramp of the rate from 0 to 1 in one second."""


SHORTEST = 1e-12
"""s; what is shorter is round-off of times that add up."""


class Ramp(NamedTuple):
    """The rate of a quantity runs from one value to another, without a jolt; or stays."""

    duration: float  # s
    before: float  # 1/s
    after: float  # 1/s


def change(by: float, duration: float, ramp: float) -> list[Ramp]:
    """A change `by` within `duration` s from no rate to none, which comes on and goes within `ramp` s each."""
    ramp = min(ramp, 0.5 * duration)
    rate = by / (duration - ramp)
    return [Ramp(ramp, 0.0, rate), Ramp(duration - 2.0 * ramp, rate, rate), Ramp(ramp, rate, 0.0)]


def lasts(ramps: list[Ramp]) -> float:
    """Time that ramps take together, s."""
    return sum(ramp.duration for ramp in ramps)


def channel(start: float, ramps: list[Ramp], smooth: int = 3) -> Polynomials:
    """The quantity over time from t = 0 on: from `start`, by ramps one after the other.

    It has as many continuous derivatives as `smooth` says. With 3, ramps of its rate are the quintics without slope
    and curvature at both ends.
    """
    kept = [ramp for ramp in ramps if ramp.duration > SHORTEST]
    duration, before, after = (np.array(column) for column in zip(*kept, strict=True))
    breaks = np.concatenate([[0.0], np.cumsum(duration)])
    values = start + np.concatenate([[0.0], np.cumsum(0.5 * (before + after) * duration)])
    ends = np.zeros((len(kept), 2, smooth + 1, 1))
    ends[:, 0, 0, 0], ends[:, 1, 0, 0] = values[:-1], values[1:]
    ends[:, 0, 1, 0], ends[:, 1, 1, 0] = before, after
    return hermite(breaks, ends)


def cell_edges(angles: list[Polynomials], others: list[Polynomials], most: float = 0.5) -> Array:
    """Times (m + 1,) s between which no quantity has a break and the `angles` together turn by `most` rad or less."""
    edges = np.unique(np.concatenate([part.breaks for part in (*angles, *others)]))
    # A rate between two breaks is largest at one of them.
    inside = np.array([edges[:-1], edges[1:]]) + np.diff(edges) * np.array([[1e-9], [-1e-9]])
    turned = sum(np.abs(angle(side, 1)[1, :, 0]) for angle in angles for side in inside) * np.diff(edges)
    parts = np.maximum(np.ceil(turned / most), 1.0).astype(int)
    cuts = [
        np.linspace(a, b, n, endpoint=False) for a, b, n in zip(edges[:-1], edges[1:], parts, strict=True)
    ]
    return np.append(np.concatenate(cuts), edges[-1])
