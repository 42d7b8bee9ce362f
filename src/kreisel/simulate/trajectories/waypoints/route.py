"""Turns what a user gave about waypoints into a checked route, with a sentence about what makes none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array, finite, increasing, read_only, shaped

# An aircraft's hour; farther away a plane that touches the Earth is a poor map, and likelier two numbers were swapped.
FARTHEST = 1_000_000.0  # m


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """Waypoints in order; a closed route has its first one again as the last."""

    points: Array  # (n, 3) m in N
    t: Array | None  # (n,) s, of arrival
    speed: Array  # (n,) m/s; NaN: left to the limits
    stop: Array  # (n,) s
    closed: bool

    @property
    def rests(self) -> npt.NDArray[np.bool_]:
        """(n,) where the body comes to rest."""
        return (self.stop > 0.0) | (self.speed == 0.0)

    @property
    def name_of(self) -> list[str]:
        """What errors call the waypoints."""
        n = len(self.points) - self.closed
        return [f"waypoint {k % n + 1} of {n}" for k in range(len(self.points))]


def route(t: Any, position: Any, speed: Any, stop: Any, closed: bool) -> Route:
    """The checked route; ValueError, one sentence, for what makes none."""
    points = finite("position", shaped("position", position, ("n", 3)))
    n = len(points)
    if n < 2:
        raise ValueError(f"a path needs two waypoints or more; got {n}. A body that stays is rest().")
    times = None if t is None else increasing("t", shaped("t", t, ("n",)))
    speeds, stops = _column("speed", speed, n, np.nan), _column("stop", stop, n, 0.0)
    _same_number(n, t=times, speed=speeds, stop=stops)
    for name, column in (("speed", speeds), ("stop", stops)):
        if (column < 0.0).any() or np.isinf(column).any():
            k = int(np.argmax((column < 0.0) | np.isinf(column)))
            raise ValueError(f"{name} of waypoint {k + 1} must be 0 or more and finite; got {column[k]:g}.")
    found = Route(points, times, speeds, np.nan_to_num(stops), closed)
    return _checked(_closed(found) if closed else _at_rest_at_the_ends(found))


def _column(name: str, value: Any, n: int, default: float) -> Array:
    """(n,) from one value per waypoint, one for all, or none."""
    if value is None or np.ndim(value) == 0:
        return shaped(name, np.full(n, default if value is None else value), ("n",)).copy()
    return shaped(name, value, ("n",)).copy()


def _same_number(n: int, **columns: Array | None) -> None:
    for name, column in columns.items():
        if column is not None and len(column) != n:
            raise ValueError(f"{name} must have one value per waypoint; got {len(column)} for {n} waypoints.")


def _at_rest_at_the_ends(given: Route) -> Route:
    """A body begins and ends at rest unless a speed is given there."""
    given.speed[[0, -1]] = np.nan_to_num(given.speed[[0, -1]])
    return given


def _closed(given: Route) -> Route:
    """The route with its first point as its last, whether it was given so or not."""
    same = bool((given.points[0] == given.points[-1]).all())
    if given.t is not None and not same:
        raise ValueError(
            "a closed path with times needs the time of the return: give the first waypoint again as the last."
        )
    if len(given.points) - same < 3:
        raise ValueError(f"a closed path needs three different waypoints; got {len(given.points) - same}.")
    rows = np.append(np.arange(len(given.points) - same), 0)
    columns = (read_only(column[rows]) for column in (given.points, given.speed, given.stop))
    points, speed, stop = columns
    return Route(points, given.t, speed, stop, closed=True)


def _checked(given: Route) -> Route:
    names, steps = given.name_of, np.linalg.norm(np.diff(given.points, axis=0), axis=1)
    if (steps == 0.0).any():
        k = int(np.argmin(steps))
        raise ValueError(
            f"{names[k]} and the next are the same place, {_place(given.points[k])}. "
            "Drop one; a body that waits there has a stop (s) at it."
        )
    moving = ~((given.stop > 0.0) & (np.nan_to_num(given.speed) > 0.0))
    if not moving.all():
        k = int(np.argmin(moving))
        raise ValueError(
            f"{names[k]} has a stop of {given.stop[k]:g} s and a speed of {given.speed[k]:g} m/s. Give one of the two."
        )
    if given.t is not None:
        spare = np.diff(given.t) - given.stop[:-1]
        if spare.min() <= 0.0:
            k = int(np.argmax(spare <= 0.0))
            raise ValueError(
                f"{names[k]}: its stop of {given.stop[k]:g} s leaves no time to reach the next, which is due "
                f"{given.t[k + 1] - given.t[k]:g} s after it."
            )
    return given


def _place(point: Array) -> str:
    return "(" + ", ".join(f"{x:g}" for x in point) + ") m"


def headings(heading: Any, n: int) -> Array:
    """(n,) rad, NaN where free; ValueError for degrees."""
    found = shaped("orientation", heading, ("n",))
    if len(found) != n:
        raise ValueError(
            f"orientation must have one heading per waypoint; got {len(found)} for {n} waypoints."
        )
    if not np.isfinite(found).any():
        raise ValueError('orientation has no heading at all; give "tangent" for a nose along the path.')
    # Between two headings the body takes the shorter way: whole turns more would mean nothing.
    if np.nanmax(np.abs(found)) > 2.0 * np.pi + 1e-9:
        k = int(np.nanargmax(np.abs(found)))
        raise ValueError(
            f"headings are in rad, from -2 pi to 2 pi; waypoint {k + 1} has {found[k]:g}. Are these degrees? Then give "
            "np.deg2rad of them."
        )
    return found


def places(latitude_deg: Any, longitude_deg: Any, height_m: Any) -> Array:
    """Positions (n, 3) m in N, the first one at the origin; ValueError for places that are none."""
    from kreisel.maths.geodetic import local_position

    latitude = finite("latitude_deg", shaped("latitude_deg", latitude_deg, ("n",)))
    longitude = finite("longitude_deg", shaped("longitude_deg", longitude_deg, ("n",)))
    height = finite("height_m", _column("height_m", height_m, len(latitude), 0.0))
    _same_number(len(latitude), longitude_deg=longitude, height_m=height)
    for name, column, most in (("latitude", latitude, 90.0), ("longitude", longitude, 360.0)):
        if (np.abs(column) > most).any():
            k = int(np.argmax(np.abs(column) > most))
            hint = " Are latitude and longitude swapped?" if name == "latitude" else ""
            raise ValueError(
                f"the {name} of waypoint {k + 1} must lie between -{most:g} and {most:g} deg; got {column[k]:g}.{hint}"
            )
    found = local_position(np.deg2rad(latitude), np.deg2rad(longitude), height)
    distance = np.linalg.norm(found, axis=1)
    if distance.size and distance.max() > FARTHEST:
        k = int(np.argmax(distance))
        raise ValueError(
            f"waypoint {k + 1} at latitude {latitude[k]:g}, longitude {longitude[k]:g} deg is "
            f"{distance[k] / 1000.0:,.0f} km from the first. Are latitude and longitude swapped somewhere? N is a "
            f"plane that touches the Earth: it serves for {FARTHEST / 1000.0:,.0f} km."
        )
    return found
