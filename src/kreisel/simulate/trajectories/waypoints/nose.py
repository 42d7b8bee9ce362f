"""Turns a plan into where the nose of the body points: along the path, or by headings of its own."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Note
from kreisel.maths.composition import turned_by
from kreisel.maths.following.exact import Joints, follow
from kreisel.maths.following.joints import RATE, TURN
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.kinematics import euler_motion
from kreisel.maths.polynomials import Polynomials, even_slopes, hermite
from kreisel.simulate.notes import path_notes
from kreisel.simulate.trajectories.waypoints.plan import Plan

Turning = tuple[Attitude, tuple[Note, ...]]


class Nose(Protocol):
    """Which way the body looks on its path."""

    def attitude(self, u: Array, rounds: Array) -> Turning:
        """Attitude without bank, and notes, at readings u (3 or more, n) with derivatives in time, in `rounds` (n,)."""
        ...


class AlongThePath(NamedTuple):
    """A nose that follows the path, or with `level` its heading alone."""

    plan: Plan
    closed: bool
    level: bool

    def attitude(self, u: Array, rounds: Array) -> Turning:
        """As `Nose` has it. The curve gives it, where the clock never stands still: it is held at rest by itself."""
        first, last = self.plan.curve.breaks[[0, -1]]
        # Round-off may take the clock back by a bit where it all but stands.
        whole, rows = np.unique(u[0] + rounds * (last - first), return_inverse=True)
        span = (-np.inf, np.inf) if self.closed else (float(first), float(last))
        found = follow(self._path, whole, span)
        attitude = turned_by(Attitude(*(column[rows] for column in found.attitude)), u)
        return attitude, path_notes(found._replace(joints=self._in_time(found.joints)))

    def _path(self, u: Array, order: int) -> Array:
        first, last = self.plan.curve.breaks[[0, -1]]
        if self.closed:
            u = u - np.floor((u - first) / (last - first)) * (last - first)
        out = self.plan.curve(u, order)
        if self.level:
            out[..., 2] = 0.0
        return out

    def _in_time(self, joints: Joints) -> Joints:
        """Joints by time, with rates in time, without those that pass at rest without a turn."""
        first, last = self.plan.curve.breaks[[0, -1]]
        rounds = np.floor((joints.t - first) / (last - first)) if self.closed else np.zeros(len(joints.t))
        t, clock = self.plan.when(joints.t - rounds * (last - first))
        sides = (turned_by(side, clock) for side in (joints.before, joints.after))
        found = Joints(t + rounds * self.plan.lap, *sides)
        real = (found.turns > TURN) | (found.rate_steps > RATE)
        before, after = (Attitude(*(column[real] for column in side)) for side in found[1:])
        return Joints(found.t[real], before, after)


class ByHeadings(NamedTuple):
    """A level body with a heading for every reading of the clock."""

    heading: Polynomials  # rad
    once_round: float  # rad, by which it has turned after a round

    def attitude(self, u: Array, rounds: Array) -> Turning:
        """As `Nose` has it."""
        psi = self.heading(u[0], 2)[..., 0]
        zero = np.zeros(u.shape[1])
        angles = (
            psi[0] + rounds * self.once_round,
            psi[1] * u[1],
            psi[2] * u[1] ** 2 + psi[1] * u[2],
        )
        phi, dphi, ddphi = (np.stack([zero, zero, angle], axis=1) for angle in angles)
        return Attitude(*euler_motion(phi, dphi, ddphi)), ()


def by_headings(plan: Plan, heading: Array, closed: bool) -> ByHeadings:
    """A nose through headings (n,) rad at the waypoints, NaN where free, from each to the next by the shorter way.

    Between two waypoints it turns one way only, and steadily where the headings go on as they came.
    """
    known = np.flatnonzero(np.isfinite(heading[: len(heading) - closed]))
    nodes = plan.curve.breaks
    x, angles = nodes[known], heading[known]
    if len(known) == 1:
        return ByHeadings(Polynomials(nodes[[0, -1]], np.array([[[angles[0]]]])), 0.0)
    if closed:
        # From a heading round to it again, and one more before it: the first waypoint may have none.
        x, angles = np.append(x, x[0] + nodes[-1]), np.unwrap(np.append(angles, angles[0]))
        once_round, slopes = angles[-1] - angles[0], even_slopes(x, angles, closed=True)
        x, slopes = np.append(x[-2] - nodes[-1], x), np.append(slopes[-2], slopes)
        angles = np.append(angles[-2] - once_round, angles)
    else:
        # Before the first heading and after the last these are kept.
        x = np.concatenate([nodes[:1] - 1.0, x, nodes[-1:] + 1.0])
        angles = np.unwrap(np.concatenate([angles[:1], angles, angles[-1:]]))
        once_round, slopes = 0.0, even_slopes(x, angles)
    ends = np.stack([angles, slopes, np.zeros(len(x))], axis=1)
    return ByHeadings(hermite(x, np.stack([ends[:-1], ends[1:]], axis=1)[..., None]), float(once_round))
