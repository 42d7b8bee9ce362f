"""Turns the arguments of `kreisel simulate` into a trajectory: poses in a file, waypoints, or a motion profile."""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.cli.inputs import add_max_gap, read_input
from kreisel.cli.values import UsageError, as_typed, number, one_of, typed
from kreisel.data.checks import Array, choice
from kreisel.data.frames import to_enu_flu
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses, Trajectory, even_count, even_times, some_even_times
from kreisel.data.waypoint import Waypoint
from kreisel.files.units import scale

KINDS = ("poses", "waypoints", "profile")

# Option -> the kinds it applies to.
_OPTIONS = {
    "max_speed": ("waypoints",),
    "max_acceleration": ("waypoints",),
    "max_jerk": ("waypoints",),
    "minimum": ("waypoints",),
    "closed": ("waypoints",),
    "banked": ("waypoints", "profile"),
    "ramp": ("profile",),
    "heading": ("profile",),
    **dict.fromkeys(
        ("method", "noise", "max_gap", "from_format", "kind", "column", "input_rate", "times"), ("poses",)
    ),
}

_ORIENTATIONS = {
    "poses": ("tangent", "transport"),
    "waypoints": ("tangent", "level"),
    "profile": ("tangent", "level"),
}


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """What a file gave, and the times at which it is wanted."""

    trajectory: Trajectory
    told: str  # what it holds, for the summary
    span: tuple[float, float]  # s
    rate_hz: float | None
    t: Array | None = None  # (n,) s, where there is no rate: those of the poses

    def __len__(self) -> int:
        return even_count(*self.span, self.rate_hz) if self.rate_hz else len(self.own)

    @property
    def own(self) -> Array:
        """(n,) s, times of the poses."""
        assert self.t is not None  # the rate is left out for poses only
        first, last = self.span
        return self.t[(self.t >= first) & (self.t <= last)]

    @property
    def motion(self) -> Motion:
        """All of it."""
        return self.trajectory.sample(even_times(*self.span, self.rate_hz) if self.rate_hz else self.own)

    def blocks(self, rows: int) -> Iterator[Motion]:
        """The same, so many rows at a time."""
        for first in range(0, len(self), rows):
            numbers = range(first, min(first + rows, len(self)))
            if self.rate_hz:
                times = some_even_times(*self.span, self.rate_hz, numbers)
            else:
                times = self.own[numbers.start : numbers.stop]
            yield self.trajectory.sample(times)


def add_course_arguments(parser: ArgumentParser) -> None:
    """--as, and what shapes a path that is no list of poses."""
    parser.add_argument(
        "--as",
        dest="kind_of_path",
        default="poses",
        type=one_of(KINDS),
        metavar="KIND",
        help="what the rows of the input are: poses (default), waypoints to pass smoothly, or a motion profile "
        "(drive, turn, climb, stop, rest; also gnss-ins-sim's motion definitions); docs/motion.md",
    )
    group = parser.add_argument_group("noisy poses")
    group.add_argument(
        "--noise",
        metavar="LENGTH[,ANGLE]",
        type=typed(parse_noise),
        help="noise of the poses where it is known, such as 0.1mm or 0.1mm,0.01deg; x/y/z for one per axis, such as "
        "0.1/0.1/0.3mm (default: found from the poses)",
    )
    add_max_gap(group)
    group = parser.add_argument_group("waypoints and profiles")
    limit = number(above=0.0)
    group.add_argument("--max-speed", type=limit, metavar="M/S", help="limit on the way along waypoints")
    group.add_argument("--max-acceleration", type=limit, metavar="M/S^2", help="the same for acceleration")
    group.add_argument("--max-jerk", type=limit, metavar="M/S^3", help="the same for jerk")
    group.add_argument(
        "--minimum",
        type=one_of(("jerk", "snap")),
        help="jerk (default) or snap: what the path through waypoints has least of",
    )
    group.add_argument(
        "--closed", action="store_true", default=None, help="from the last waypoint back to the first"
    )
    group.add_argument(
        "--banked", action="store_true", default=None, help="roll into turns, as aeroplanes do"
    )
    group.add_argument(
        "--ramp",
        type=number("seconds", above=0.0),
        metavar="S",
        help="time in which turns of a profile come on (default 1)",
    )
    group.add_argument(
        "--heading",
        type=number("degrees"),
        metavar="DEG",
        help="at the begin of a profile: 0 east (default), 90 north",
    )


def read_course(args: Namespace) -> Course:
    """The course that the arguments name. ValueError for options that do not belong to its kind."""
    kind = args.kind_of_path
    if args.orientation is not None:
        with as_typed():
            choice("--orientation", args.orientation, _ORIENTATIONS[kind])
    given = {name: getattr(args, name) for name in _OPTIONS if getattr(args, name) is not None}
    for name in given:
        if kind not in _OPTIONS[name]:
            option = name.removesuffix("_format").replace("_", "-")
            raise UsageError(
                f"--{option} does not apply to {kind}. Leave it out, or say --as {_OPTIONS[name][0]}."
            )
    if kind == "poses":
        return _poses(args)
    if args.rate is None:
        raise UsageError(f"--as {kind} needs a sampling rate: give --rate HZ.")
    trajectory, told = (_waypoints if kind == "waypoints" else _profile)(args, given)
    first, last = trajectory.span if np.isfinite(trajectory.span).all() else (0.0, trajectory.lap)
    return Course(trajectory, f"{told} over {last - first:.4g} s", (first, last), args.rate)


def _poses(args: Namespace) -> Course:
    from kreisel.simulate.trajectories.sampled import SampledTrajectory

    try:
        poses = read_input(args, kind="poses")
    except ValueError as error:
        raise ValueError(f"{error}{_meant(args.input)}") from None
    assert isinstance(poses, Poses)  # the kind asked for
    smoothing = dict(args.noise or {})
    if args.max_gap is not None:
        smoothing["max_gap"] = args.max_gap
    trajectory = SampledTrajectory.from_poses(poses, args.orientation, args.method or "auto", **smoothing)
    first, last = trajectory.span
    told = f"{len(poses)} poses over {last - first:.4g} s"
    return Course(trajectory, told, (first, last), args.rate, trajectory.t)


def parse_noise(text: str) -> dict[str, Any]:
    """Options of a SampledTrajectory that "LENGTH[,ANGLE]" stands for, each "0.1mm" or "0.1/0.1/0.3mm"."""
    names = (("position_noise", "length"), ("attitude_noise", "angle"))
    parts = text.split(",")
    if len(parts) > 2:
        raise ValueError(f"--noise takes LENGTH[,ANGLE], such as 0.1mm,0.01deg; got {text!r}.")
    return {name: _level(part, quantity) for part, (name, quantity) in zip(parts, names, strict=False)}


def _level(text: str, quantity: str) -> list[float]:
    """The numbers before a unit, in ours."""
    match = re.fullmatch(r"\s*([-+0-9.eE/]*[0-9.])\s*([a-zA-Z]+)\s*", text)
    try:
        assert match is not None
        numbers = np.array([float(number) for number in match[1].split("/")])
    except (AssertionError, ValueError):
        raise ValueError(
            f"--noise takes numbers with their unit, such as 0.1mm,0.01deg; got {text!r}."
        ) from None
    if not (numbers > 0.0).all():
        raise ValueError(
            f"--noise must be above 0; got {text!r}. Leave it out to have it found from the poses."
        )
    if len(numbers) not in (1, 3):
        raise ValueError(f"--noise takes one number or three, x/y/z; got {text!r}.")
    scaled = scale(match[2], quantity)(numbers).tolist()
    return scaled * 3 if len(scaled) == 1 else scaled


def _meant(path: str) -> str:
    """What a file that holds no poses looks like."""
    from kreisel.files.named_rows import header_of

    try:
        header = header_of(Path(path))
    except (ValueError, OSError):
        return ""
    if header[0] in ("do", "ini lat"):
        return " It looks like a motion profile: say --as profile."
    waypoints = {"latitude", "lat", "stop", "compass", "heading"} & {*header}
    return " It looks like waypoints: say --as waypoints." if waypoints else ""


def _waypoints(args: Namespace, given: dict[str, Any]) -> tuple[Any, str]:
    from kreisel.files.waypoints import read_waypoints
    from kreisel.simulate.trajectories.waypoints import waypoints

    points = in_our_axes(read_waypoints(args.input), args.frame)
    return waypoints(points, orientation=args.orientation, **given), f"{len(points)} waypoints"


def _profile(args: Namespace, given: dict[str, Any]) -> tuple[Any, str]:
    from kreisel.data.motion_definition import MotionDefinition
    from kreisel.files.profiles import read_profile
    from kreisel.simulate.trajectories.gnss_ins_sim import CommandedMotion
    from kreisel.simulate.trajectories.profile import profile

    found = read_profile(args.input)
    if isinstance(found, MotionDefinition):
        if given or args.orientation:
            name = next(iter(given), "orientation").replace("_", "-")
            raise UsageError(
                f"{args.input} is a motion definition of gnss-ins-sim: --{name} does not apply. Leave it out."
            )
        return CommandedMotion(found), f"{len(found.commands)} commands"
    if "heading" in given:
        given["heading_deg"] = given.pop("heading")
    return profile(found, orientation=args.orientation or "tangent", **given), f"{len(found)} segments"


def in_our_axes(points: Sequence[Waypoint], world: str) -> list[Waypoint]:
    """Waypoints of another world with their positions and headings in ours; latitudes stay as they are."""
    from kreisel.maths.rotations import euler_from_matrix, matrix_from_euler

    out = []
    for point in points:
        phi_z = np.deg2rad([0.0, 0.0, point.heading_deg or 0.0])
        place = np.array([point.position or (0.0, 0.0, 0.0)])
        turned = to_enu_flu(Poses(np.zeros(1), place, matrix_from_euler(phi_z)[None]), world)
        assert turned.R_NB is not None  # it went in
        heading = (
            None if point.heading_deg is None else float(np.rad2deg(euler_from_matrix(turned.R_NB)[0, 2]))
        )
        x, y, z = turned.p_NB[0].tolist()
        out.append(replace(point, position=point.position and (x, y, z), heading_deg=heading))
    return out
