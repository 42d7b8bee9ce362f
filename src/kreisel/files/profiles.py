"""Turns a table of segments, or a motion definition of gnss-ins-sim, into what a body is to do."""

from __future__ import annotations

from pathlib import Path

from kreisel.data.motion_definition import Command, MotionDefinition
from kreisel.data.segment import Segment
from kreisel.files.doors import PathLike
from kreisel.files.named_rows import Known, Row, header_of, named_rows
from kreisel.files.text import TextFile, is_number, read_text, split_row

_COLUMNS = {
    "do": Known("", others=("segment", "what", "kind")),
    "duration": Known("time", "s", ("time", "t")),
    "distance": Known("length", "m"),
    "speed": Known("speed", "m/s"),
    "acceleration": Known("acceleration", "m/s^2"),
    "angle": Known("angle", "deg", ("angle_deg",), unit_needed=True),
    "rate": Known("rate", "deg/s", ("rate_deg_s",), unit_needed=True),
    "radius": Known("length", "m"),
    "height": Known("length", "m", ("climb",)),
    "climb_rate": Known("speed", "m/s"),
}

# As the first line of a motion definition has it.
_INITIAL = "ini lat"


def read_profile(path: PathLike) -> tuple[Segment, ...] | MotionDefinition:
    """The segments in a table with a header: do, duration, distance, speed, acceleration, angle, rate, radius, height,
    climb_rate; units in brackets behind the names. Or, by its first line, a motion definition of gnss-ins-sim.

    Raises ValueError with file, line and column, OSError where there is no file.
    """
    source = Path(path)
    if header_of(source)[0] == _INITIAL:
        return _definition(read_text(source))
    file, rows = named_rows(source, _COLUMNS)
    return tuple(_segment(file, k, row) for k, row in enumerate(rows))


def _segment(file: TextFile, k: int, row: Row) -> Segment:
    if "do" not in row:
        raise file.error(k, "nothing to do: drive, turn, climb, stop or rest is needed.", "do")
    names = {"angle": "angle_deg", "rate": "rate_deg_s"}
    rest = {names.get(name, name): float(value) for name, value in row.items() if name != "do"}
    return Segment(str(row["do"]).lower(), **rest)


def _definition(file: TextFile) -> MotionDefinition:
    """Two headers, each with its rows below: the state at the begin, and the commands."""
    rows = [split_row(row, ",") for row in file.rows]
    if len(rows) < 4:
        raise ValueError(f"{file.path} is no motion definition: it has no commands below its third line.")
    numbers = {k: _numbers(file, k, rows[k]) for k in (1, *range(3, len(rows)))}
    initial = numbers.pop(1)
    return MotionDefinition(
        tuple(_command(file, k, row) for k, row in numbers.items()),
        (initial[3], initial[4], initial[5]),
        (initial[6], initial[7], initial[8]),
        initial[0],
        initial[1],
        initial[2],
        file.path.stem,
    )


def _numbers(file: TextFile, k: int, fields: list[str]) -> list[float]:
    """The nine numbers of a row; those that are empty are reserved, and 0."""
    if len(fields) != 9:
        raise file.error(k, f"{len(fields)} fields where 9 are expected. Repair or remove that line.")
    wrong = next((field for field in fields if field and not is_number(field)), None)
    if wrong is not None:
        raise file.error(k, f"{wrong!r} is not a number. Repair or remove that line.")
    return [float(field or 0.0) for field in fields]


def _command(file: TextFile, k: int, row: list[float]) -> Command:
    kind, yaw, pitch, roll, vx, vy, vz, duration, _ = row
    if kind not in (1, 2, 3, 4, 5):
        raise file.error(k, f"command type {kind:g} is none; there are 1 to 5.")
    if not 0.0 < duration < float("inf"):
        raise file.error(k, f"a command needs a duration above 0; got {duration:g} s.")
    return Command(int(kind), (yaw, pitch, roll), (vx, vy, vz), duration)
