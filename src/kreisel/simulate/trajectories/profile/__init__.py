"""Turns a table of what a body does (drive, turn, climb, stop, rest) into its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import comb

import numpy as np

from kreisel.data.checks import Array, choice, finite, finite_number, increasing, read_only, shaped
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.motion import Motion, Note
from kreisel.data.segment import Segment
from kreisel.maths.bank import banked as with_bank
from kreisel.maths.channels import cell_edges, channel
from kreisel.maths.following.tangent import Attitude, Directions, attitude_along
from kreisel.maths.polynomials import Polynomials
from kreisel.maths.running_integral import RunningIntegral
from kreisel.simulate.notes import end_note
from kreisel.simulate.trajectories.profile.segments import Ramps, ramps_of


@dataclass(frozen=True, eq=False)
class MotionProfile:
    """A body that does what its segments say, one after the other, from t = 0.

    segments: what to do; every one begins and ends straight ahead, level and at a steady speed.
    speed: m/s over ground, at the begin. heading: rad, at the begin (0 east, pi/2 north). position: (3,) m in N.
    orientation: "tangent", nose along the path, up and down too; or "level".
    banked: whether the body rolls until it feels no sideways force, as aeroplanes and motorcycles do.
    ramp: s, in which a turn, a climb and an acceleration come on, and go; half a segment where that is shorter.

    Speed, heading and height are polynomials of time, so smooth that jerk and angular acceleration are continuous; the
    way east and north is their integral to round-off.
    Raises ValueError with the number of the segment that cannot be.
    """

    segments: Sequence[Segment]
    speed: float = 0.0
    heading: float = 0.0
    position: Sequence[float] = (0.0, 0.0, 0.0)
    orientation: str = "tangent"
    banked: bool = False
    ramp: float = 1.0
    name: str = field(default="", kw_only=True)
    _ramps: Ramps = field(init=False, repr=False)
    _channels: tuple[Polynomials, Polynomials, Polynomials] = field(init=False, repr=False)
    _way: RunningIntegral = field(init=False, repr=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        choice("orientation", self.orientation, ("tangent", "level"))
        finite_number("ramp", self.ramp, above=0.0)
        heading = finite_number("heading", self.heading)
        if abs(heading) > 2.0 * np.pi + 1e-9:
            raise ValueError(
                f"heading is in rad, from -2 pi to 2 pi; got {heading:g}. Are these degrees? Then give np.deg2rad of "
                "it."
            )
        if finite_number("speed", self.speed) < 0.0:
            raise ValueError(f"speed must be 0 or more; got {self.speed:g}.")
        put(self, "segments", tuple(self.segments))
        put(self, "position", finite("position", shaped("position", self.position, (3,))))
        ramps = ramps_of(self.segments, self.speed, self.ramp, self.orientation == "level")
        speeds = channel(self.speed, ramps.speeds)
        headings = channel(heading, ramps.headings)
        # A bank in a turn follows the vertical acceleration, and its angular acceleration two derivatives more.
        heights = channel(self.position[2], ramps.heights, smooth=4)
        put(self, "_ramps", ramps)
        put(self, "_channels", (speeds, headings, heights))
        edges = cell_edges([headings], [speeds, heights])
        put(self, "_way", RunningIntegral(lambda t: self._level_velocity(t, 0)[0], edges))

    @property
    def span(self) -> tuple[float, float]:
        """From 0 to the end of the last segment, s."""
        return 0.0, self._ramps.ends[-1]

    @property
    def ends(self) -> Array:
        """(n,) s, when the segments end."""
        return read_only(np.array(self._ramps.ends))

    def sample(self, t: Array) -> Motion:
        """Motion at times t (n,) s, increasing and inside the span."""
        times = increasing("t", shaped("t", t, ("n",)))
        first, last = self.span
        if len(times) and not first <= times[0] <= times[-1] <= last:
            raise ValueError(
                f"t must lie within the profile, 0 to {last:.9g} s; got {times[0]:.9g} to {times[-1]:.9g}."
            )
        p, v, a, jerk, snap = self._path(times)
        attitude = self._attitude(times)
        if self.banked:
            attitude = with_bank(attitude, np.stack([a + np.array([0.0, 0.0, STANDARD_GRAVITY]), jerk, snap]))
        p, v, a, R, omega, alpha = map(read_only, (p, v, a, *attitude))
        return Motion(times, p, v, a, R, omega, alpha, name=self.name, notes=(self._end(),))

    def _path(self, t: Array) -> Array:
        """Position and four derivatives (5, n, 3) in N."""
        out = np.empty((5, len(t), 3))
        out[0, :, :2] = self.position[:2] + self._way(t)
        out[1:, :, :2] = self._level_velocity(t, 3)
        out[:, :, 2] = self._channels[2](t, 4)[..., 0]
        return out

    def _level_velocity(self, t: Array, order: int) -> Array:
        """Velocity east and north with derivatives (order + 1, n, 2)."""
        h, psi = (channel(t, order)[..., 0] for channel in self._channels[:2])
        # As complex numbers: v = h exp(i psi), and exp(i psi)' = i psi' exp(i psi).
        turn = [np.exp(1j * psi[0])]
        for k in range(order):
            turn.append(sum(1j * comb(k, j) * psi[j + 1] * turn[k - j] for j in range(k + 1)))
        v = np.stack([sum(comb(k, j) * h[j] * turn[k - j] for j in range(k + 1)) for k in range(order + 1)])
        return np.stack([v.real, v.imag], axis=-1)

    def _attitude(self, t: Array) -> Attitude:
        """Nose along the path, without bank."""
        (h, dh, ddh), (psi, dpsi, ddpsi) = (channel(t, 2)[..., 0] for channel in self._channels[:2])
        heading = np.stack([np.cos(psi), np.sin(psi), dpsi, ddpsi], axis=1)
        level = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], (len(t), 1))
        if self.orientation == "level":
            return attitude_along(Directions(heading, level))
        _, w, dw, ddw = self._channels[2](t, 3)[..., 0]
        climb = np.stack([h, dh, ddh, w, dw, ddw], axis=1)
        # On the level the nose is level, at rest too.
        climbs = np.any(climb[:, 3:] != 0.0, axis=1)
        return attitude_along(Directions(heading, np.where(climbs[:, None], climb, level)))

    def _end(self) -> Note:
        last = self.ends[-1:]
        heading = float(self._channels[1](last, 0)[0, 0, 0])
        return end_note(
            len(self.segments), "segment", last[0], self._path(last)[0, 0], heading, self._ramps.speed
        )


def profile(
    segments: Sequence[Segment],
    speed: float = 0.0,
    heading_deg: float = 0.0,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    orientation: str = "tangent",
    banked: bool = False,
    ramp: float = 1.0,
) -> MotionProfile:
    """A `MotionProfile` with its heading in degrees: 0 east, 90 north."""
    heading = np.deg2rad(np.remainder(finite_number("heading_deg", heading_deg), 360.0))
    return MotionProfile(
        segments, speed, float(heading), position, orientation, banked, ramp, name="motion profile"
    )


def example() -> MotionProfile:
    """Off from rest, up a ramp, round to the left and to a halt."""
    return MotionProfile(
        (
            Segment("drive", duration=1.5, speed=4.0),
            Segment("climb", height=0.5, duration=1.0),
            Segment("turn", angle_deg=120.0, duration=1.2),
            Segment("stop", duration=0.8),
            Segment("rest", duration=0.5),
        ),
        banked=True,
        ramp=0.3,
    )
