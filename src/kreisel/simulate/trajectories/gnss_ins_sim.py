"""Turns a motion definition of gnss-ins-sim into the motion it commands.

That tool tracks its commands sample by sample with a low-pass filter and a controller, so that its path depends on
the sampling rate. Here the same commands are carried out by smooth ramps within the same three limits;
docs/motion.md has the differences.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from kreisel.data.checks import Array, finite_number, increasing, read_only, shaped
from kreisel.data.motion import Motion, Note
from kreisel.data.motion_definition import Command, MotionDefinition
from kreisel.maths.channels import RAMP_SLOPE, Ramp, cell_edges, change, channel, lasts
from kreisel.maths.kinematics import euler_motion
from kreisel.maths.polynomials import Polynomials
from kreisel.maths.running_integral import RunningIntegral
from kreisel.simulate.notes import end_note

# s, in which a rate of kind 1 and an acceleration come on: what the low-pass filter of that tool takes at 100 Hz.
_RAMP = 0.2

# Its NED and FRD against our ENU and FLU: yaw is counted from north to the right, y and z of the body are mirrored.
_ANGLE_SIGNS = np.array([-1.0, -1.0, 1.0])  # yaw, pitch, roll
_BODY_SIGNS = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class CommandedMotion:
    """The motion of a vehicle that carries out the commands of a motion definition, from t = 0 at the origin of N.

    max_acceleration: m/s^2, along each axis of B, in the mean over a change of speed.
    max_angular_acceleration, max_rate: rad/s^2 and rad/s, of each Euler angle. Commands of kinds 2 to 5 are carried out
        that fast; the defaults are those of gnss-ins-sim.

    N is flat and inertial, as that tool's reference frame 1; the visibility of satellites means nothing to an IMU. The
    notes of a motion name the commands that their time was too short for.
    """

    definition: MotionDefinition
    max_acceleration: float = 1.0
    max_angular_acceleration: float = 0.5
    max_rate: float = 2.0
    _angles: list[Polynomials] = field(init=False, repr=False)
    _speeds: list[Polynomials] = field(init=False, repr=False)
    _way: RunningIntegral = field(init=False, repr=False)
    _notes: tuple[Note, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("max_acceleration", "max_angular_acceleration", "max_rate"):
            finite_number(name, getattr(self, name), above=0.0)
        if not self.definition.commands:
            raise ValueError("a motion definition needs a command.")
        yaw, pitch, roll = np.deg2rad(self.definition.ypr_deg) * _ANGLE_SIGNS
        start = [0.5 * np.pi + yaw, pitch, roll, *(np.array(self.definition.velocity) * _BODY_SIGNS)]
        axes = [_Axis(float(value), self._limits(k < 3)) for k, value in enumerate(start)]
        put = object.__setattr__
        cut = _carried_out(axes, self.definition.commands)
        channels = [channel(value, axis.ramps) for value, axis in zip(start, axes, strict=True)]
        put(self, "_angles", channels[2::-1])
        put(self, "_speeds", channels[3:])
        put(
            self,
            "_way",
            RunningIntegral(lambda t: self._velocity(t)[0], cell_edges(channels[:3], channels[3:])),
        )
        put(self, "_notes", (self._end(), *cut))

    def _end(self) -> Note:
        last = np.array(self.span[1:])
        yaw, speed = (float(part(last, 0)[0, 0, 0]) for part in (self._angles[2], self._speeds[0]))
        return end_note(len(self.definition.commands), "command", last[0], self._way(last)[0], yaw, speed)

    def _limits(self, angle: bool) -> _Limits:
        if angle:
            return _AngleLimits(self.max_rate, self.max_angular_acceleration)
        return _SpeedLimits(self.max_acceleration)

    @property
    def span(self) -> tuple[float, float]:
        """From 0 to the end of the last command, s."""
        return 0.0, float(self._angles[0].breaks[-1])

    def sample(self, t: Array) -> Motion:
        """Motion at times t (n,) s, increasing and inside the span."""
        times = increasing("t", shaped("t", t, ("n",)))
        first, last = self.span
        if len(times) and not first <= times[0] <= times[-1] <= last:
            raise ValueError(
                f"t must lie within the commands, 0 to {last:.9g} s; got {times[0]:.9g} to {times[-1]:.9g}."
            )
        v, a, R, omega, alpha = self._velocity(times)
        p, v, a, R, omega, alpha = map(read_only, (self._way(times), v, a, R, omega, alpha))
        return Motion(times, p, v, a, R, omega, alpha, name=self.definition.name, notes=self._notes)

    def _velocity(self, t: Array) -> tuple[Array, ...]:
        """Velocity and acceleration (n, 3) in N, and the attitude that turns them there."""
        phi = np.stack([part(t, 2)[..., 0] for part in self._angles], axis=-1)
        v_B = np.stack([part(t, 1)[..., 0] for part in self._speeds], axis=-1)
        R, omega, alpha = euler_motion(*phi)
        v, a = (np.einsum("nij,nj->ni", R, x) for x in (v_B[0], v_B[1] + np.cross(omega, v_B[0])))
        return v, a, R, omega, alpha


class _Limits(Protocol):
    """How fast an axis may change."""

    def time(self, by: float) -> tuple[float, float]:
        """Least time of a change `by`, s, and its ramp."""
        ...

    def most(self, duration: float) -> float:
        """The largest change within `duration` s."""
        ...


@dataclass(frozen=True, slots=True)
class _SpeedLimits:
    """Of the mean acceleration: a stop from 10 m/s at 1 m/s^2 takes 10 s there, so that commands count on it."""

    acceleration: float

    def time(self, by: float) -> tuple[float, float]:
        """As `_Limits` has it."""
        duration = abs(by) / self.acceleration
        return duration, min(_RAMP, 0.1 * duration)

    def most(self, duration: float) -> float:
        """As `_Limits` has it."""
        return self.acceleration * duration


@dataclass(frozen=True, slots=True)
class _AngleLimits:
    """Of the rate of an angle, and of the change of that rate."""

    rate: float
    bend: float

    @property
    def ramp(self) -> float:
        """Time in which the full rate comes on, s."""
        return RAMP_SLOPE * self.rate / self.bend

    def time(self, by: float) -> tuple[float, float]:
        """As `_Limits` has it."""
        rate = min(self.rate, float(np.sqrt(abs(by) * self.bend / RAMP_SLOPE)))
        if rate == 0.0:
            return 0.0, 0.0
        ramp = RAMP_SLOPE * rate / self.bend
        return abs(by) / rate + ramp, ramp

    def most(self, duration: float) -> float:
        """As `_Limits` has it."""
        ramp = min(self.ramp, 0.5 * duration)
        return ramp / self.ramp * self.rate * (duration - ramp)


@dataclass(slots=True)
class _Axis:
    """An angle or a component of velocity, with what it has been told to do so far."""

    value: float
    limits: _Limits
    rate: float = 0.0
    ramps: list[Ramp] = field(default_factory=list)

    def go(self, ramps: list[Ramp]) -> None:
        """Do what `ramps` say."""
        self.ramps += ramps
        self.value += sum(0.5 * (ramp.before + ramp.after) * ramp.duration for ramp in ramps)
        self.rate = ramps[-1].after if ramps else self.rate

    def keep_rate(self, rate: float, duration: float) -> None:
        """Kind 1: a rate for a time, which comes on softly."""
        ramp = min(_RAMP, duration) if rate != self.rate else 0.0
        self.go([Ramp(ramp, self.rate, rate), Ramp(duration - ramp, rate, rate)])

    def fade(self, most: float) -> float:
        """Let go of a rate that is left over; the time that takes, s."""
        duration = min(_RAMP, 0.5 * most) if self.rate != 0.0 else 0.0
        self.go([Ramp(duration, self.rate, 0.0)])
        return duration


def _carried_out(axes: list[_Axis], commands: Sequence[Command]) -> list[Note]:
    """Have the axes carry out the commands; what they had no time for."""
    notes, now = [], 0.0
    for number, command in enumerate(commands, start=1):
        angles = np.deg2rad(command.ypr_deg) * _ANGLE_SIGNS
        numbers = [*angles.tolist(), *(np.array(command.velocity) * _BODY_SIGNS).tolist()]
        if command.kind == 1:
            for axis, rate in zip(axes, numbers, strict=True):
                axis.keep_rate(rate, command.duration)
            now += command.duration
            continue
        took, short = _reach(axes, numbers, command)
        now += took
        if short > 1e-9:
            needs = f"it has {command.duration:g} s and would take {took + short:.4g} s"
            notes.append(Note("method", f"command {number} is carried out in part: {needs}", now))
    return notes


def _reach(axes: list[_Axis], numbers: list[float], command: Command) -> tuple[float, float]:
    """Kinds 2 to 5: the time that a command takes, s, and how much it lacked."""
    relative = [command.kind in (3, 5)] * 3 + [command.kind in (3, 4)] * 3
    faded = [axis.fade(command.duration) for axis in axes]
    # An absolute yaw is one in that tool's count, which begins at north.
    zero = [0.5 * np.pi, 0.0, 0.0, 0.0, 0.0, 0.0]
    by = [
        x if steps else z + x - axis.value
        for axis, x, z, steps in zip(axes, numbers, zero, relative, strict=True)
    ]
    needs = [f + axis.limits.time(x)[0] for axis, x, f in zip(axes, by, faded, strict=True)]
    duration = min(max(needs), command.duration)
    for axis, x, f in zip(axes, by, faded, strict=True):
        left = duration - f
        x = float(np.clip(x, -axis.limits.most(left), axis.limits.most(left)))
        time, ramp = axis.limits.time(x)
        ramps = change(x, time, ramp) if x != 0.0 else []
        axis.go([*ramps, Ramp(max(left - lasts(ramps), 0.0), 0.0, 0.0)])
    return duration, max(needs) - duration


def example() -> CommandedMotion:
    """Off to the north, up, and into a turn to the right that it keeps."""
    commands = (
        Command(1, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0),
        Command(5, (0.0, 5.0, 0.0), (1.5, 0.0, 0.0), 2.0),
        Command(1, (30.0, 0.0, 0.0), (0.0, 0.0, 0.0), 2.0),
    )
    return CommandedMotion(MotionDefinition(commands), max_angular_acceleration=2.0)
