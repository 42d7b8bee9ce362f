"""A point on the way of a body, as scenario files, tables and Python write it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Waypoint:
    """Where a body passes, and what it does there; what is None is left to the trajectory.

    Either `position`, m east, north and up, or latitude, longitude (deg, WGS 84) and height (m above the ellipsoid).
    """

    position: tuple[float, float, float] | None = None  # m in N
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    height_m: float = 0.0
    t: float | None = None  # s, when the body arrives
    speed: float | None = None  # m/s, when it passes
    stop: float = 0.0  # s, for which it stands there; 0: it passes
    heading_deg: float | None = None  # 0 east, 90 north
