"""A row of a motion profile, as scenario files, tables and Python write it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Segment:
    """Something that a body does for a while; what is None is not asked for.

    `do` is "drive", "turn", "climb", "stop" or "rest"; docs/motion.md says what each of them takes.
    """

    do: str
    duration: float | None = None  # s
    distance: float | None = None  # m over ground
    speed: float | None = None  # m/s over ground, to reach
    acceleration: float | None = None  # m/s^2, the most on the way there
    angle_deg: float | None = None  # to the left
    rate_deg_s: float | None = None  # the most in the turn
    radius: float | None = None  # m, the smallest in the turn
    height: float | None = None  # m, upwards
    climb_rate: float | None = None  # m/s, the most on the way up or down
