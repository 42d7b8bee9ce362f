"""Turns two sides and a corner radius into a level rounded rectangle, driven at constant speed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array, finite_number, increasing, shaped
from kreisel.data.motion import Motion
from kreisel.maths.following.exact import Joints
from kreisel.maths.following.tangent import Attitude
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.notes import joint_notes


@dataclass(frozen=True, eq=False)
class RoundedRectangle:
    """A level rectangle around the origin, counter-clockwise from the middle of its southern side.

    length, width: m, along x and y, corners included; radius: m of the corners; speed: m/s, constant.

    Straight sides and quarter circles meet in joints where the acceleration steps by speed^2 / radius and the
    rate by speed / radius; a row at a joint belongs to the piece that begins there. Calculated from
    the length of the arc, so any number of laps is as good as the first.
    """

    length: float = 1.0
    width: float = 1.0
    radius: float = 0.1
    speed: float = 0.8

    def __post_init__(self) -> None:
        for name in ("length", "width", "radius", "speed"):
            finite_number(name, getattr(self, name), above=0.0)
        if not 2.0 * self.radius <= min(self.length, self.width):
            raise ValueError(
                f"radius must be at most half a side, "
                f"{0.5 * min(self.length, self.width):.9g} m; got {self.radius!r}."
            )

    @property
    def span(self) -> tuple[float, float]:
        """It goes round for ever."""
        return (-np.inf, np.inf)

    @property
    def lap(self) -> float:
        """Time of one lap, s."""
        return float(self._starts[-1]) / self.speed

    @cached_property
    def _starts(self) -> Array:
        """(9,) m, arc length at which side, corner, side, corner ... begin, from the south-western corner."""
        quarter = 0.5 * np.pi * self.radius
        x, y = self.length - 2.0 * self.radius, self.width - 2.0 * self.radius
        return np.concatenate([[0.0], np.cumsum([x, quarter, y, quarter, x, quarter, y, quarter])])

    def sample(self, t: Array) -> Motion:
        """Motion at times t (n,) s, increasing."""
        times = increasing("t", shaped("t", t, ("n",)))
        piece, arc = self._place(times)
        heading = 0.5 * np.pi * (piece // 2) + np.where(piece % 2, arc / self.radius, 0.0)
        c, s, zero = np.cos(heading), np.sin(heading), np.zeros(len(times))
        rate = np.where(piece % 2, self.speed / self.radius, 0.0)
        p, flat = self._position(piece, arc, c, s), np.stack([zero, zero, rate], axis=1)
        v = self.speed * np.stack([c, s, zero], axis=1)
        a = self.speed * rate[:, None] * np.stack([-s, c, zero], axis=1)
        R = matrix_from_euler(np.stack([zero, zero, heading], axis=1))
        return Motion(
            times,
            p,
            v,
            a,
            R,
            flat,
            np.zeros((len(times), 3)),
            name="rounded rectangle",
            notes=joint_notes(self._joints(times)),
        )

    def _place(self, times: Array) -> tuple[npt.NDArray[np.int64], Array]:
        """Piece (n,) 0..7 and the arc length (n,) within it."""
        start = self._starts
        arc = np.mod(self.speed * times + 0.5 * start[1], start[-1])
        # A time stamp at a joint may be rounded to either side of it.
        ahead = arc + 4.0 * np.spacing(self.speed * np.abs(times) + start[-1])
        piece = np.searchsorted(start, ahead, side="right") - 1
        arc = np.where(piece == 8, 0.0, np.maximum(arc - start[piece], 0.0))
        return piece % 8, arc

    def _position(self, piece: npt.NDArray[np.int64], arc: Array, c: Array, s: Array) -> Array:
        """p_NB (n, 3) m: from the centre of the corner that a side leads to, or of the corner itself."""
        r = self.radius
        x, y = 0.5 * self.length - r, 0.5 * self.width - r
        side = piece // 2
        centre_x, centre_y = np.array([x, x, -x, -x])[side], np.array([-y, y, y, -y])[side]
        back = np.where(piece % 2, 0.0, (self._starts[piece + 1] - self._starts[piece]) - arc)
        return np.stack(
            [centre_x + r * s - back * c, centre_y - r * c - back * s, np.zeros(len(arc))], axis=1
        )

    def _joints(self, times: Array) -> Joints:
        """Joints after the first and up to the last of `times`."""
        piece = np.arange(8)
        # Where a side has no length, corner follows corner and nothing steps.
        long = np.diff(self._starts) > 0.0
        piece = piece[long & np.roll(long, 1)]
        around = times[[0, -1]] / self.lap if len(times) else np.zeros(2)
        laps = np.arange(np.floor(around[0]) - 1.0, np.floor(around[1]) + 2.0)
        arc = laps[:, None] * self._starts[-1] + self._starts[piece] - 0.5 * self._starts[1]
        t, piece = arc.ravel() / self.speed, np.tile(piece, len(laps))
        inside = (t > times[0]) & (t <= times[-1]) if len(times) else np.zeros(len(t), dtype=bool)
        t, piece = t[inside], piece[inside]
        heading, corner = 0.5 * np.pi * (piece // 2), piece % 2 == 1
        return Joints(t, self._at_joint(heading, ~corner), self._at_joint(heading, corner))

    def _at_joint(self, heading: Array, turning: npt.NDArray[np.bool_]) -> Attitude:
        zero = np.zeros(len(heading))
        omega = np.stack([zero, zero, np.where(turning, self.speed / self.radius, 0.0)], axis=1)
        R = matrix_from_euler(np.stack([zero, zero, heading], axis=1))
        return Attitude(R, omega, np.zeros((len(heading), 3)))


def rounded_rectangle(
    length: float = 1.0, width: float = 1.0, radius: float = 0.1, speed: float = 0.8
) -> RoundedRectangle:
    """A level rectangle of `length` x `width` m with corners of `radius` m, at constant `speed` m/s.

    By default 6.4 m/s^2 inwards in the corners and none on the sides.
    """
    return RoundedRectangle(length, width, radius, speed)


def example() -> RoundedRectangle:
    """Sides of 1 m, corners of 0.1 m, 0.8 m/s."""
    return rounded_rectangle()
