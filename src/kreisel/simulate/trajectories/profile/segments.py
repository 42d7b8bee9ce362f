"""Turns the rows of a motion profile into ramps of speed, heading and height, with a sentence about what makes none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from kreisel.data.checks import choice, finite_number
from kreisel.data.segment import Segment
from kreisel.maths.channels import Ramp, change, lasts

TAKES = {
    "drive": ("duration", "distance", "speed", "acceleration"),
    "turn": ("angle_deg", "duration", "rate_deg_s", "radius", "speed", "height"),
    "climb": ("height", "duration", "climb_rate", "speed"),
    "stop": ("duration", "distance", "acceleration"),
    "rest": ("duration",),
}
"""What each kind of segment may have."""

_LENGTHS = ("duration", "distance", "rate_deg_s", "radius", "climb_rate")
_NOT_NEGATIVE = ("duration", "distance", "speed", "acceleration", "rate_deg_s", "radius", "climb_rate")


@dataclass(slots=True)
class Ramps:
    """What the segments so far make of a body."""

    ramp: float  # s
    speed: float  # m/s, at the end so far
    climbs_at_rest: bool
    speeds: list[Ramp] = field(default_factory=list)  # of the speed over ground: m/s^2
    headings: list[Ramp] = field(default_factory=list)  # rad/s
    heights: list[Ramp] = field(default_factory=list)  # m/s
    ends: list[float] = field(default_factory=list)  # s, of the segments

    def add(self, number: int, segment: Segment) -> None:
        """Go on with one segment; ValueError for one that cannot be."""
        name = _checked(number, segment)
        duration = self._duration(name, segment)
        speed = 0.0 if segment.do == "stop" else self.speed if segment.speed is None else segment.speed
        angle, height = np.deg2rad(segment.angle_deg or 0.0), segment.height or 0.0
        if height != 0.0 and min(self.speed, speed) == 0.0 and not self.climbs_at_rest:
            raise ValueError(
                f"{name}: a body with its nose along the path cannot climb at rest. Drive first, or take "
                'orientation "level".'
            )
        by_acceleration = self._to_speed(speed, segment.acceleration, duration)
        if lasts(by_acceleration) > duration * (1.0 + 1e-9):
            raise ValueError(
                f"{name}: from {self.speed:g} to {speed:g} m/s at {segment.acceleration:g} m/s^2 takes "
                f"{lasts(by_acceleration):.4g} s, {lasts(by_acceleration) - duration:.3g} more than there are."
            )
        for column, ramps in (
            (self.speeds, by_acceleration),
            (self.headings, change(float(angle), duration, self.ramp)),
            (self.heights, change(height, duration, self.ramp)),
        ):
            column += [*ramps, Ramp(max(duration - lasts(ramps), 0.0), 0.0, 0.0)]
        self.speed = speed
        self.ends.append((self.ends[-1] if self.ends else 0.0) + duration)

    def _to_speed(self, speed: float, acceleration: float | None, duration: float) -> list[Ramp]:
        """All the time for a change of speed, unless an acceleration makes it shorter."""
        by = speed - self.speed
        if acceleration is None or by == 0.0:
            return change(by, duration, self.ramp)
        return change(by, *self._at_rate(by, acceleration))

    def _at_rate(self, by: float, rate: float) -> tuple[float, float]:
        """Time, s, of a change `by` at `rate`, and its ramp."""
        ramp = min(self.ramp, abs(by) / rate)
        return abs(by) / rate + ramp, ramp

    def _duration(self, name: str, segment: Segment) -> float:
        """How long a segment takes, s."""
        if segment.duration is not None:
            return segment.duration
        if segment.do == "turn":
            return self._turn(name, segment)
        if segment.do == "climb":
            return self._at_rate(segment.height or 0.0, segment.climb_rate or 0.0)[0]
        speed = 0.0 if segment.do == "stop" else self.speed if segment.speed is None else segment.speed
        if segment.distance is None:
            return self._at_rate(speed - self.speed, segment.acceleration or 0.0)[0]
        return self._over(name, segment, speed)

    def _turn(self, name: str, segment: Segment) -> float:
        angle = float(np.deg2rad(segment.angle_deg or 0.0))
        if segment.rate_deg_s is not None:
            return self._at_rate(angle, float(np.deg2rad(segment.rate_deg_s)))[0]
        if self.speed == 0.0 or segment.speed not in (None, self.speed):
            raise ValueError(
                f"{name}: a turn by its radius needs a steady speed above 0. Give duration or rate_deg_s instead."
            )
        assert segment.radius is not None  # one of the lengths is there
        return self._at_rate(angle, self.speed / segment.radius)[0]

    def _over(self, name: str, segment: Segment, speed: float) -> float:
        """How long a distance takes while the speed changes on the way, s."""
        assert segment.distance is not None
        mean = 0.5 * (self.speed + speed)
        if mean == 0.0:
            raise ValueError(
                f"{name}: at rest there is no distance to drive. Give a speed, or rest for a duration."
            )
        if segment.acceleration is None or speed == self.speed:
            return segment.distance / mean
        ramp = self._at_rate(speed - self.speed, segment.acceleration)[0]
        if mean * ramp > segment.distance * (1.0 + 1e-9):
            raise ValueError(
                f"{name}: from {self.speed:g} to {speed:g} m/s at {segment.acceleration:g} m/s^2 takes "
                f"{mean * ramp:.4g} m, {mean * ramp - segment.distance:.3g} more than its distance."
            )
        if speed == 0.0:
            raise ValueError(f"{name}: give a distance or an acceleration to stop by, not both.")
        return ramp + (segment.distance - mean * ramp) / speed


def ramps_of(segments: Sequence[Segment], speed: float, ramp: float, climbs_at_rest: bool) -> Ramps:
    """The ramps of all segments; ValueError with the number of the one that cannot be."""
    if not segments:
        raise ValueError("a motion profile needs a segment, such as drive for a duration.")
    out = Ramps(ramp, speed, climbs_at_rest)
    for number, segment in enumerate(segments, start=1):
        out.add(number, segment)
    return out


def _checked(number: int, segment: Segment) -> str:
    """What errors call the segment, once it has what it needs and nothing else."""
    choice(f"do of segment {number}", segment.do, tuple(TAKES))
    name = f"segment {number} ({segment.do})"
    given = {key: getattr(segment, key) for key in segment.__slots__ if key != "do"}
    given = {key: value for key, value in given.items() if value is not None}
    for key, value in given.items():
        if key not in TAKES[segment.do]:
            raise ValueError(f"{name} has no use for {key}; it takes {', '.join(TAKES[segment.do])}.")
        finite_number(f"{name}: {key}", value)
        if key in _NOT_NEGATIVE and (value < 0.0 or (value == 0.0 and key != "speed")):
            raise ValueError(
                f"{name}: {key} must be {'0 or more' if key == 'speed' else 'above 0'}; got {value:g}."
            )
    _check_needs(name, segment, given)
    return name


def _check_needs(name: str, segment: Segment, given: dict[str, float]) -> None:
    what = {"turn": "angle_deg", "climb": "height"}.get(segment.do)
    if what and not given.get(what):
        raise ValueError(f"{name} needs {what}, and not 0.")
    lengths = [key for key in TAKES[segment.do] if key in _LENGTHS]
    if segment.do == "stop":
        lengths.append("acceleration")
    if segment.do == "drive" and "acceleration" in given and "speed" not in given:
        raise ValueError(f"{name}: an acceleration needs the speed to reach.")
    had = [key for key in lengths if key in given]
    if len(had) != 1:
        got = f"got {' and '.join(had)}" if had else "got none"
        raise ValueError(f"{name} needs one of {', '.join(lengths)}; {got}.")
