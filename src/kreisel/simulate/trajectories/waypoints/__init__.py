"""Turns waypoints with times, speeds, stops and limits into a smooth path with the attitude of a body on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kreisel.data.checks import Array, choice, increasing, read_only, shaped
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.motion import Motion, Note
from kreisel.data.waypoint import Waypoint
from kreisel.maths.bank import banked as with_bank
from kreisel.maths.composition import composed
from kreisel.simulate.trajectories.waypoints.allocation import planned_by_limits
from kreisel.simulate.trajectories.waypoints.limits import UNITS, limits
from kreisel.simulate.trajectories.waypoints.nose import AlongThePath, Nose, by_headings
from kreisel.simulate.trajectories.waypoints.plan import DERIVATIVE, Plan
from kreisel.simulate.trajectories.waypoints.route import Route, headings, places, route
from kreisel.simulate.trajectories.waypoints.timing import planned_by_times


@dataclass(frozen=True, eq=False)
class WaypointTrajectory:
    """A smooth path through points, to the last bit, that keeps limits on speed, acceleration and jerk.

    t: (n,) s, when the body arrives at each point; or None, and it goes as fast as the limits let it, from t = 0.
    position: (n, 3) m in N; `from_geodetic` takes latitudes and longitudes.
    orientation: "tangent", x axis along the path and y axis level; "level", heading along the path without pitch; or
        (n,) rad, headings at the points (0 east, pi/2 north; NaN: free), turned between the shorter way, level.
    banked: whether the body rolls until it feels no sideways force, as aeroplanes, motorcycles and drones do.
    speed: (n,) m/s, at the points; NaN: left to the limits; one number: at all of them. Where nothing is said the body
        begins and ends at rest.
    stop: (n,) s, for which the body stands at the points; 0: it passes.
    closed: whether the path leads back to its first point and goes round for ever.
    max_speed, max_acceleration, max_jerk: m/s, m/s^2, m/s^3, of the point that moves; None: free. With times they
        are checked, without they are used up.
    minimum: "jerk", or "snap", which is smoother and swings out farther.

    The points are joined by the curve of least jerk or snap (polynomials of degree 5 or 7), and a clock of the same
    kind leads along it; through stops too the curve has no corner, so that a nose along it does not turn at rest.
    With headings of its own a body may turn a corner where it rests, and goes straight from one rest to the next.
    docs/decisions/0041 says why.

    Raises ValueError for points and times that make no path, and for waypoints that cannot be reached within the
    limits: which, and by how much.
    """

    t: Any
    position: Any
    orientation: Any = "tangent"
    banked: bool = False
    speed: Any = None
    stop: Any = None
    closed: bool = False
    max_speed: float | None = None
    max_acceleration: float | None = None
    max_jerk: float | None = None
    minimum: str = "jerk"
    t0_ns: int = field(default=0, kw_only=True)
    name: str = field(default="", kw_only=True)
    _route: Route = field(init=False, repr=False)
    _plan: Plan = field(init=False, repr=False)
    _nose: Nose = field(init=False, repr=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        choice("minimum", self.minimum, tuple(DERIVATIVE))
        bounds = limits(self.max_speed, self.max_acceleration, self.max_jerk)
        way = route(self.t, self.position, self.speed, self.stop, self.closed)
        heading = self._headings(way)
        # What cannot be reached is refused here rather than at the first sample.
        plan = (planned_by_limits if way.t is None else planned_by_times)(
            way, bounds, self.minimum, heading is not None
        )
        nose: Nose
        if heading is None:
            nose = AlongThePath(plan, way.closed, level=self.orientation == "level")
        else:
            nose = by_headings(plan, heading, way.closed)
        put(self, "t", way.t)
        put(self, "position", way.points)
        put(self, "_route", way)
        put(self, "_plan", plan)
        put(self, "_nose", nose)

    def _headings(self, way: Route) -> Array | None:
        if isinstance(self.orientation, str):
            choice("orientation", self.orientation, ("tangent", "level"))
            return None
        given = len(np.atleast_1d(self.orientation))
        found = headings(self.orientation, len(way.points) - (way.closed and given < len(way.points)))
        return np.append(found, found[0]) if len(found) < len(way.points) else found

    @classmethod
    def from_geodetic(
        cls, t: Any, latitude_deg: Any, longitude_deg: Any, height_m: Any = 0.0, **options: Any
    ) -> WaypointTrajectory:
        """Through places (n,) by latitude and longitude, deg, WGS 84, and height above the ellipsoid, m.

        N has its origin at the first place, and is the plane that touches the Earth there: exact, so that the same
        height 10 km away lies 8 m below. `options` are those of the class.
        """
        return cls(t, places(latitude_deg, longitude_deg, height_m), **options)

    @property
    def span(self) -> tuple[float, float]:
        """From the first waypoint to the end of a stop at the last, s; a closed path goes on for ever."""
        if self.closed:
            return -np.inf, np.inf
        return float(self._plan.clock.breaks[0]), float(self._plan.clock.breaks[-1])

    @property
    def lap(self) -> float:
        """Time from the first waypoint to the last, or once round a closed path, s."""
        return float(self._plan.clock.breaks[-1] - self._plan.clock.breaks[0])

    @property
    def arrivals(self) -> Array:
        """(n,) s, when the body arrives at each waypoint; of a closed path, at the first again as the last."""
        return read_only(self._plan.arrivals)

    def sample(self, t: Array) -> Motion:
        """Motion at times t (n,) s, increasing and inside the span."""
        times = increasing("t", shaped("t", t, ("n",)))
        self._inside(times)
        u, rounds = self._clock(times)
        path = composed(self._plan.curve(u[0], 4), u)
        attitude, notes = self._nose.attitude(u, rounds)
        if self.banked:
            force = path[2:] - np.array([[[0.0, 0.0, -STANDARD_GRAVITY]], np.zeros((1, 3)), np.zeros((1, 3))])
            attitude = with_bank(attitude, force)
        p, v, a, R, omega, alpha = map(read_only, (*path[:3], *attitude))
        notes = (Note("method", self._told()), *notes)
        return Motion(times, p, v, a, R, omega, alpha, self.t0_ns, self.name, notes)

    def _clock(self, times: Array) -> tuple[Array, Array]:
        """The clock's reading within its round, and four derivatives (5, n); and the number of the round (n,)."""
        clock = self._plan.clock
        rounds = np.floor((times - clock.breaks[0]) / self.lap) if self.closed else np.zeros(len(times))
        within = np.clip(times - rounds * self.lap, clock.breaks[0], clock.breaks[-1])
        return clock(within, 4)[..., 0], rounds

    def _inside(self, times: Array) -> None:
        first, last = self.span
        outside = (times < first) | (times > last)
        if outside.any():
            k = int(np.argmax(outside))
            raise ValueError(
                f"t must lie between the first and the last waypoint, {first:.9g} to {last:.9g} s; "
                f"row {k} is {times[k]:.9g}."
            )

    def _told(self) -> str:
        """How the path came to be, in one line."""
        sizes = self._plan.looks().max(axis=(1, 2))
        most = ", ".join(f"{x:.4g} {unit}" for x, unit in zip(sizes, UNITS, strict=True))
        once = "once round" if self.closed else "passed"
        n = len(self._route.points) - self.closed
        return (
            f"{n} waypoints {once} in {self.lap:.4g} s by the curve of least {self.minimum}; at most {most}"
        )


def waypoints(
    points: Sequence[Waypoint],
    orientation: str | None = None,
    banked: bool = False,
    closed: bool = False,
    max_speed: float | None = None,
    max_acceleration: float | None = None,
    max_jerk: float | None = None,
    minimum: str = "jerk",
) -> WaypointTrajectory:
    """A `WaypointTrajectory` through points that each say what they know: place, time, speed, stop, heading.

    orientation: "tangent" or "level"; where points have headings, these hold, and "tangent" where none has.
    The other parameters are those of the class.
    """
    points = tuple(points)
    heading = _column("heading_deg", points)
    if orientation is not None and heading is not None:
        raise ValueError(
            f"points have headings (heading_deg), so that orientation {orientation!r} has no meaning."
        )
    t = _column("t", points)
    if t is not None and np.isnan(t).any():
        k = int(np.argmax(np.isnan(t)))
        raise ValueError(
            f"waypoint {k + 1} has no t while others have. Give all of them, or none and limits."
        )
    return WaypointTrajectory(
        t,
        _positions(points),
        _nose(heading) if heading is not None else orientation or "tangent",
        banked,
        _column("speed", points),
        np.array([point.stop for point in points]),
        closed,
        max_speed,
        max_acceleration,
        max_jerk,
        minimum,
        name="waypoints",
    )


def _column(name: str, points: Sequence[Waypoint]) -> Array | None:
    """(n,), NaN where a point does not say; None where none does."""
    values = [getattr(point, name) for point in points]
    if all(value is None for value in values):
        return None
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def _nose(heading_deg: Array) -> Array:
    if np.nanmax(np.abs(heading_deg)) > 360.0:
        k = int(np.nanargmax(np.abs(heading_deg)))
        raise ValueError(
            f"heading_deg of waypoint {k + 1} must lie between -360 and 360; got {heading_deg[k]:g}."
        )
    return np.deg2rad(heading_deg)


def _positions(points: Sequence[Waypoint]) -> Array:
    """(n, 3) m in N, from positions or from latitudes and longitudes."""
    for k, point in enumerate(points):
        somewhere = point.latitude_deg is not None and point.longitude_deg is not None
        if (point.position is not None) == somewhere:
            raise ValueError(
                f"waypoint {k + 1} needs either a position or a latitude_deg with a longitude_deg."
            )
    flat = [point.position for point in points if point.position is not None]
    if flat and len(flat) < len(points):
        raise ValueError(
            "some waypoints have positions and others latitudes: give all of them in the same way."
        )
    if flat:
        return np.array(flat, dtype=np.float64)
    columns = ("latitude_deg", "longitude_deg", "height_m")
    return places(*([getattr(point, name) for point in points] for name in columns))


def example() -> WaypointTrajectory:
    """Round a garden, banked, with a stop at the far end, as fast as the limits let it."""
    return WaypointTrajectory(
        None,
        [[0.0, 0.0, 0.0], [3.0, 0.5, 0.5], [5.0, 3.0, 1.0], [3.0, 5.0, 1.5], [0.0, 4.0, 1.0]],
        banked=True,
        stop=[0.0, 0.0, 0.5, 0.0, 0.0],
        max_speed=3.0,
        max_acceleration=4.0,
    )
