"""Turns a route into a curve through its points, and that with a clock into a plan of where the body is when."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.maths.composition import composed
from kreisel.maths.polynomials import Polynomials, joined, smoothest_through
from kreisel.simulate.trajectories.waypoints.route import Route

DERIVATIVE = {"jerk": 3, "snap": 4}
"""Whose square is least along the curve and in the clock, as a derivative of position."""

LOOKS = 129
"""Places in a piece at which speed and acceleration are looked at."""

INSIDE = np.append(np.linspace(0.0, 1.0, LOOKS)[:-1], 1.0 - 1e-12)
"""These places; the end of a piece is its own, not the begin of the next."""

# Of the time of a path: until time stamps cannot be told apart.
_HALVINGS = 54


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A body is at curve(clock(t))."""

    curve: Polynomials  # of the clock's reading u
    clock: Polynomials  # of t in s
    leg: npt.NDArray[np.int64]  # (k,) behind which waypoint each piece of the clock lies; -1: at rest
    at: npt.NDArray[np.int64]  # which waypoint each break of the curve is

    @property
    def once_round(self) -> float:
        """Reading at the end less that at the begin."""
        return float(self.curve.breaks[-1] - self.curve.breaks[0])

    @property
    def lap(self) -> float:
        """Time from the first waypoint to the end, s."""
        return float(self.clock.breaks[-1] - self.clock.breaks[0])

    @property
    def arrivals(self) -> Array:
        """(n,) s, at the waypoints."""
        ends = [int(np.flatnonzero(self.leg == k)[-1]) + 1 for k in range(int(self.leg.max()) + 1)]
        return self.clock.breaks[[0, *ends]]

    def when(self, reading: Array) -> tuple[Array, Array]:
        """When the clock first shows `reading` (n,): times (n,) s, and its reading with two derivatives (3, n)."""
        low = np.full(len(reading), self.clock.breaks[0])
        high = np.full(len(reading), self.clock.breaks[-1])
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            short = self.clock(middle, 0)[0, :, 0] < reading
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return high, self.clock(high, 2)[..., 0]

    def looks(self) -> Array:
        """Speed, acceleration and jerk (3, k, LOOKS) in the pieces of the clock: m/s, m/s^2, m/s^3."""
        u = self.clock(inside(self.clock.breaks), 3)[..., 0]
        derivatives = composed(self.curve(u[0], 3), u)[1:]
        return np.linalg.norm(derivatives, axis=2).reshape(3, -1, LOOKS)


def inside(breaks: Array) -> Array:
    """LOOKS places in every piece between `breaks` (k + 1,), in one row."""
    return np.asarray((breaks[:-1, None] + np.diff(breaks)[:, None] * INSIDE).ravel())


def curve_through(route: Route, minimum: str, corners: bool) -> Polynomials:
    """The smoothest curve through the points; with `corners` it may break where the body rests."""
    m = DERIVATIVE[minimum]
    chords = np.linalg.norm(np.diff(route.points, axis=0), axis=1)
    nodes = np.concatenate([[0.0], np.cumsum(chords)])
    if not corners or not route.rests.any():
        return smoothest_through(nodes, route.points, m, route.closed)
    # A closed path begins at a rest: in between it has no ends.
    shift = int(np.argmax(route.rests)) if route.closed else 0
    rows = (np.arange(len(nodes)) + shift) % len(chords) if route.closed else np.arange(len(nodes))
    along = np.concatenate([[0.0], np.cumsum(np.roll(chords, -shift))])
    ends = np.unique(np.concatenate([[0, len(nodes) - 1], np.flatnonzero(route.rests[rows])]))
    parts = [smoothest_through(along[a : b + 1], route.points[rows[a : b + 1]], m) for a, b in pairwise(ends)]
    return Polynomials(nodes, np.roll(joined(parts).coefficients, shift, axis=0))
