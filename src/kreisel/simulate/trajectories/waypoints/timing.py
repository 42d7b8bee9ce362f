"""Turns waypoints with times into a curve and the clock that keeps them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.maths.polynomials import Polynomials, even_slopes, smoothest_through
from kreisel.simulate.trajectories.waypoints.limits import Limits, worst
from kreisel.simulate.trajectories.waypoints.plan import DERIVATIVE, LOOKS, Plan, curve_through, inside
from kreisel.simulate.trajectories.waypoints.route import Route


def planned_by_times(route: Route, bounds: Limits, minimum: str, corners: bool) -> Plan:
    """The plan that is at every waypoint when it is due.

    Its clock is the one of least jerk or snap that shows every waypoint at its time and has the speeds that are given.
    Where it would run back, because a slow leg follows upon a fast one, it is taken through the waypoints at rates
    between those of the legs.
    Raises ValueError where a limit is not kept, or a speed does not go with the times.
    """
    curve = curve_through(route, minimum, corners)
    knots = _knots(route, curve)
    m = DERIVATIVE[minimum]
    clock = _clock(
        route, knots, np.append(knots.rate[:, None], np.full((len(knots.t), m - 2), np.nan), axis=1)
    )
    if _runs_back(clock).any():
        slopes = np.where(np.isnan(knots.rate), even_slopes(knots.t, knots.u, route.closed), knots.rate)
        clock = _clock(route, knots, np.append(slopes[:, None], np.zeros((len(knots.t), m - 2)), axis=1))
    plan = Plan(curve, clock, knots.leg)
    _check_forward(route, plan)
    _check_limits(route, plan, bounds)
    return plan


class _Knots(NamedTuple):
    """What the clock has to show when; two for a waypoint at which the body stands."""

    t: Array  # (k,) s
    u: Array  # (k,) m
    rate: Array  # (k,) NaN: free
    leg: npt.NDArray[np.int64]  # (k - 1,)


def _knots(route: Route, curve: Polynomials) -> _Knots:
    assert route.t is not None
    nodes = curve.breaks
    rates = route.speed / np.linalg.norm(curve(nodes, 1)[1], axis=1)
    rates[route.rests] = 0.0
    stands = route.stop > 0.0
    if route.closed:
        stands[-1] = False
    rows = np.repeat(np.arange(len(nodes)), np.where(stands, 2, 1))
    leaves = np.append(rows[1:] != rows[:-1], True) & stands[rows]
    t = np.where(leaves, route.t[rows] + route.stop[rows], route.t[rows])
    return _Knots(t, nodes[rows], rates[rows], np.where(rows[1:] == rows[:-1], -1, rows[:-1]))


def _clock(route: Route, knots: _Knots, known: Array) -> Polynomials:
    # At rest nothing changes, with all its derivatives.
    known[knots.rate == 0.0] = 0.0
    m = known.shape[1] + 1
    return smoothest_through(knots.t, knots.u[:, None], m, route.closed, known[..., None])


def _runs_back(clock: Polynomials) -> npt.NDArray[np.bool_]:
    """(k,) pieces in which the clock runs back."""
    rate = clock(inside(clock.breaks), 1)[1, :, 0].reshape(-1, LOOKS)
    return np.asarray((rate < -1e-9 * rate.max()).any(axis=1))


def _check_forward(route: Route, plan: Plan) -> None:
    """Refuse speeds for which the clock has to run back."""
    back = _runs_back(plan.clock)
    if not back.any():
        return
    k = int(plan.leg[int(np.argmax(back))])
    way = plan.curve.breaks[k + 1] - plan.curve.breaks[k]
    mean = way / np.diff(plan.clock.breaks)[plan.leg == k][0]
    speeds = " and ".join(f"{s:g} m/s" for s in route.speed[k : k + 2] if s > 0.0)
    raise ValueError(
        f"from {route.name_of[k]} to the next there are {way:.4g} m in the time given, {mean:.4g} m/s, and the body "
        f"would have to turn back on the way to pass at {speeds}. Lower the speed, or leave it out."
    )


def _check_limits(route: Route, plan: Plan, bounds: Limits) -> None:
    found = worst(plan, bounds)
    if found is None:
        return
    duration = float(np.diff(plan.clock.breaks)[plan.leg == found.leg].sum())
    raise ValueError(
        f"{found.sentence(route)}. The leg takes {duration:.4g} s by the times given and would need about "
        f"{duration * found.longer:.4g} s."
    )
