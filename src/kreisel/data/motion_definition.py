"""A motion definition of gnss-ins-sim: where a vehicle begins, and its commands, in the axes of that tool."""

from __future__ import annotations

from dataclasses import dataclass

Three = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Command:
    """One row of commands; N is north, east, down there, and B forward, right, down."""

    kind: int  # 1 to 5: what the numbers are, see docs/motion.md
    ypr_deg: Three  # yaw, pitch, roll: deg, or deg/s for kind 1
    velocity: Three  # m/s in B, or m/s^2 for kind 1
    duration: float  # s; for kinds 2 to 5 the most


@dataclass(frozen=True, slots=True)
class MotionDefinition:
    """A whole file."""

    commands: tuple[Command, ...]
    velocity: Three = (0.0, 0.0, 0.0)  # m/s in B, at the begin
    ypr_deg: Three = (0.0, 0.0, 0.0)  # yaw, pitch, roll at the begin
    latitude_deg: float = 0.0
    longitude_deg: float = 0.0
    height_m: float = 0.0
    name: str = ""
