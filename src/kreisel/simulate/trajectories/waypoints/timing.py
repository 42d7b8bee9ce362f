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

    Where the path may have corners at rests, or has no rests, it is the curve of least jerk or snap in time itself.
    Elsewhere its clock is the one of least jerk or snap that shows every waypoint at its time and has the speeds that
    are given; where that would run back, because a slow leg follows upon a fast one, it is taken through the waypoints
    at rates between those of the legs.
    Raises ValueError where a limit is not kept, or a speed does not go with the times.
    """
    plan = _plan(route, minimum, corners)
    _check_forward(route, plan)
    _check_limits(route, plan, bounds)
    return plan


def _plan(route: Route, minimum: str, corners: bool) -> Plan:
    given = (route.speed > 0.0).any()
    if not given and (corners or not route.rests.any()):
        return _in_time(route, minimum)
    curve = curve_through(route, minimum, corners)
    knots = _knots(route, curve)
    m = DERIVATIVE[minimum]
    clock = _clock(
        route, knots, np.append(knots.rate[:, None], np.full((len(knots.t), m - 2), np.nan), axis=1)
    )
    if _runs_back(clock).any():
        slopes = np.where(np.isnan(knots.rate), even_slopes(knots.t, knots.u, route.closed), knots.rate)
        clock = _clock(route, knots, np.append(slopes[:, None], np.zeros((len(knots.t), m - 2)), axis=1))
    return Plan(curve, clock, knots.leg, np.arange(len(curve.breaks)))


def _in_time(route: Route, minimum: str) -> Plan:
    """The curve of least jerk or snap in time, and a clock that shows the time."""
    t, rows = _times(route)
    m = DERIVATIVE[minimum]
    known = np.full((len(t), m - 1, 3), np.nan)
    known[route.rests[rows]] = 0.0
    curve = smoothest_through(t, route.points[rows], m, route.closed, known)
    clock = Polynomials(t, np.stack([t[:-1], np.ones(len(t) - 1)], axis=1)[..., None])
    return Plan(curve, clock, _legs(rows), rows)


class _Knots(NamedTuple):
    """What the clock has to show when; two for a waypoint at which the body stands."""

    t: Array  # (k,) s
    u: Array  # (k,) m
    rate: Array  # (k,) NaN: free
    leg: npt.NDArray[np.int64]  # (k - 1,)


def _knots(route: Route, curve: Polynomials) -> _Knots:
    nodes = curve.breaks
    rates = route.speed / np.linalg.norm(curve(nodes, 1)[1], axis=1)
    rates[route.rests] = 0.0
    t, rows = _times(route)
    return _Knots(t, nodes[rows], rates[rows], _legs(rows))


def _times(route: Route) -> tuple[Array, npt.NDArray[np.int64]]:
    """When (k,) s the body is at, or leaves, which waypoint (k,): twice for one at which it stands."""
    assert route.t is not None
    stands = route.stop > 0.0
    if route.closed:
        stands[-1] = False
    rows = np.repeat(np.arange(len(stands)), np.where(stands, 2, 1))
    leaves = np.append(rows[1:] != rows[:-1], True) & stands[rows]
    return np.where(leaves, route.t[rows] + route.stop[rows], route.t[rows]), rows


def _legs(rows: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    return np.where(rows[1:] == rows[:-1], -1, rows[:-1])


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
    way = np.linalg.norm(route.points[k + 1] - route.points[k])
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
