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
        first, once_round = float(self.plan.curve.breaks[0]), self.plan.once_round
        # Round-off may take the clock back by a bit where it all but stands.
        whole, rows = np.unique(u[0] + rounds * once_round, return_inverse=True)
        span = (-np.inf, np.inf) if self.closed else (first, first + once_round)
        found = follow(self._path, whole, span)
        attitude = turned_by(Attitude(*(column[rows] for column in found.attitude)), u)
        return attitude, path_notes(found._replace(joints=self._in_time(found.joints)))

    def _path(self, u: Array, order: int) -> Array:
        if self.closed:
            u = u - self._rounds(u) * self.plan.once_round
        out = self.plan.curve(u, order)
        if self.level:
            out[..., 2] = 0.0
        return out

    def _in_time(self, joints: Joints) -> Joints:
        """Joints by time, with rates in time, without those that pass at rest without a turn."""
        rounds = self._rounds(joints.t)
        t, clock = self.plan.when(joints.t - rounds * self.plan.once_round)
        sides = (turned_by(side, clock) for side in (joints.before, joints.after))
        found = Joints(t + rounds * self.plan.lap, *sides)
        real = (found.turns > TURN) | (found.rate_steps > RATE)
        before, after = (Attitude(*(column[real] for column in side)) for side in found[1:])
        return Joints(found.t[real], before, after)

    def _rounds(self, u: Array) -> Array:
        if not self.closed:
            return np.zeros(len(u))
        return np.asarray(np.floor((u - self.plan.curve.breaks[0]) / self.plan.once_round))


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


def _held_at_rest(plan: Plan, heading: Array) -> Array:
    """Headings (k,) at the breaks of the curve; a free one where the body stands lies between its neighbours."""
    found = heading[plan.at]
    known = np.flatnonzero(np.isfinite(found))
    stands = np.append(plan.at[1:] == plan.at[:-1], False)
    free = np.flatnonzero(stands & np.isnan(found))
    between = np.interp(plan.curve.breaks[free], plan.curve.breaks[known], np.unwrap(found[known]))
    found[free] = found[free + 1] = between
    return found


def by_headings(plan: Plan, heading: Array, closed: bool) -> ByHeadings:
    """A nose through headings (n,) rad at the waypoints, NaN where free, from each to the next by the shorter way.

    Between two waypoints it turns one way only, and steadily where the headings go on as they came.
    """
    nodes, heading = plan.curve.breaks, _held_at_rest(plan, heading)
    known = np.flatnonzero(np.isfinite(heading[: len(heading) - closed]))
    x, angles = nodes[known], heading[known]
    if len(known) == 1:
        return ByHeadings(Polynomials(nodes[[0, -1]], np.array([[[angles[0]]]])), 0.0)
    if closed:
        # From a heading round to it again, and one more before it: the first waypoint may have none.
        x, angles = np.append(x, x[0] + plan.once_round), np.unwrap(np.append(angles, angles[0]))
        once_round, slopes = angles[-1] - angles[0], even_slopes(x, angles, closed=True)
        x, slopes = np.append(x[-2] - plan.once_round, x), np.append(slopes[-2], slopes)
        angles = np.append(angles[-2] - once_round, angles)
    else:
        # Before the first heading and after the last these are kept.
        x = np.concatenate([nodes[:1] - 1.0, x, nodes[-1:] + 1.0])
        angles = np.unwrap(np.concatenate([angles[:1], angles, angles[-1:]]))
        once_round, slopes = 0.0, even_slopes(x, angles)
    ends = np.stack([angles, slopes, np.zeros(len(x))], axis=1)
    return ByHeadings(hermite(x, np.stack([ends[:-1], ends[1:]], axis=1)[..., None]), float(once_round))
