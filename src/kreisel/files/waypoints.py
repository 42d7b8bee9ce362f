"""Turns a table of waypoints into waypoints."""

from __future__ import annotations

from pathlib import Path

from kreisel.data.waypoint import Waypoint
from kreisel.files.doors import PathLike
from kreisel.files.named_rows import Known, Row, named_rows
from kreisel.files.text import TextFile

_COLUMNS = {
    "t": Known("time", "s", ("time",)),
    "x": Known("length", "m", ("p_x", "east")),
    "y": Known("length", "m", ("p_y", "north")),
    "z": Known("length", "m", ("p_z", "up")),
    "latitude": Known("angle", "deg", ("lat", "latitude_deg")),
    "longitude": Known("angle", "deg", ("lon", "lng", "longitude_deg")),
    "height": Known("length", "m", ("alt", "altitude", "height_m")),
    "speed": Known("speed", "m/s"),
    "stop": Known("time", "s", ("wait", "dwell")),
    "heading": Known("angle", "deg", ("yaw", "phi_z"), unit_needed=True),
    "compass": Known("angle", "deg", ("course", "bearing"), unit_needed=True),
}


def read_waypoints(path: PathLike) -> tuple[Waypoint, ...]:
    """The waypoints in a table: x, y, z or latitude, longitude, height; t, speed, stop; heading or compass.

    Units stand in brackets behind the names; docs/motion.md has all of them. Heading counts from east to the
    left, compass from north to the right. Raises ValueError with file, line and column, OSError where there is no file.
    """
    file, rows = named_rows(Path(path), _COLUMNS)
    return tuple(_waypoint(file, k, row) for k, row in enumerate(rows))


def _waypoint(file: TextFile, k: int, row: Row) -> Waypoint:
    values = {name: float(value) for name, value in row.items()}
    heading = values.pop("heading", None)
    if "compass" in values:
        if heading is not None:
            raise file.error(k, "both a heading and a compass course. Give one of the two.")
        heading = 90.0 - values.pop("compass")
    at = [values.pop(name, None) for name in ("x", "y", "z")]
    position = None
    if at[0] is not None or at[1] is not None:
        if at[0] is None or at[1] is None:
            raise file.error(k, "x and y are needed. Fill the cell that is empty.")
        position = (at[0], at[1], at[2] or 0.0)
    names = {"latitude": "latitude_deg", "longitude": "longitude_deg", "height": "height_m"}
    rest = {names.get(name, name): value for name, value in values.items()}
    if position is None and not {"latitude_deg", "longitude_deg"} <= rest.keys():
        raise file.error(k, "no place. Needed are x and y, or latitude and longitude.")
    return Waypoint(position, heading_deg=_wrapped(heading), **rest)


def _wrapped(heading: float | None) -> float | None:
    """A heading within a turn: 90 deg less a course of 359 deg is no mistake."""
    return heading if heading is None or abs(heading) > 450.0 else (heading + 180.0) % 360.0 - 180.0
