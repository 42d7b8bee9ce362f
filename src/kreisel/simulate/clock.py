"""Turns the times of a motion into the stamps of a recording, and into when each sensor takes its samples."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from kreisel.data.cards import Shown
from kreisel.data.checks import Array, read_only, scalar
from kreisel.maths.random import Stream
from kreisel.maths.window import mean_over_window

Rows = slice | npt.NDArray[np.int64]
"""Rows of a motion at which a sensor takes samples; a slice means all."""

JITTER, LOSS = 0, 1
"""Channels of the clock's stream."""


@dataclass(frozen=True, slots=True)
class Sampling:
    """When one sensor takes its samples, and over which time it collects each.

    rate: Hz; where it is below that of the motion, the rows in between are NaN.
    latency: s; the sample stamped t holds what was there at t - latency.
    window: s; it is the mean over that time, ending there.

    Between the samples of the motion a cubic through four of them is taken; before the first, the first.
    """

    rate: float = np.inf
    latency: float = 0.0
    window: float = 0.0

    def __post_init__(self) -> None:
        if not self.rate > 0.0:
            raise ValueError(f"rate must be positive, Hz; got {self.rate!r}.")
        for name in ("latency", "window"):
            object.__setattr__(self, name, scalar(name, getattr(self, name), "s", 0.0))

    def rows(self, t: Array) -> Rows:
        """Rows of times t (n,) s at which there is a sample: the first after every period begins."""
        if self.rate == np.inf:
            return slice(0, len(t))
        # The allowance is for round-off in stamps that are whole periods apart.
        period = np.floor((t - t[0]) * self.rate + 1e-6)
        return np.flatnonzero(np.diff(period, prepend=-1.0) > 0.0)

    def check(self, t: Array) -> None:
        """ValueError for times t (n,) s between which nothing can be so late, or collected for so long."""
        if self.latency == 0.0 and self.window == 0.0:
            return
        if len(t) < 4:
            raise ValueError(f"latency and window need a motion of four samples or more; got {len(t)}.")
        back, span = self.latency + self.window, float(t[-1] - t[0])
        if back > span:
            raise ValueError(
                f"latency and window, {back:g} s together, reach back beyond the whole motion of {span:g} s."
            )

    def collect(self, t: Array, x: Array, rows: Rows) -> Array:
        """Readings (m, 3) at `rows` from the ideal ones x (n, 3) at times t (n,) s."""
        if self.latency == 0.0 and self.window == 0.0:
            return x[rows]
        self.check(t)
        return mean_over_window(t, x, t[rows] - self.latency, self.window)


@dataclass(frozen=True, slots=True)
class Clock(Shown):
    """What an IMU's clock makes of time.

    offset: s, and rate_offset (5e-5 is 50 ppm, fast): true time t is stamped t + offset + rate_offset (t - t[0]).
    jitter: s; stamps are wrong by anything from -jitter to jitter, independently, evenly distributed.
    loss: probability that a sample of all sensors is lost; its row is NaN.
    gyro, accel, mag: when each sensor takes its samples.
    """

    offset: float = 0.0
    rate_offset: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0
    gyro: Sampling = field(default_factory=Sampling)
    accel: Sampling = field(default_factory=Sampling)
    mag: Sampling = field(default_factory=Sampling)

    def __post_init__(self) -> None:
        for name, unit, *bounds in (
            ("offset", "s"),
            ("rate_offset", "relative", -0.5, 0.5),
            ("jitter", "s", 0.0),
            ("loss", "probability", 0.0, 1.0),
        ):
            object.__setattr__(self, name, scalar(name, getattr(self, name), unit, *bounds))

    def check_contiguous(self) -> None:
        """Refuse what increments, which span all the time between the stamps, cannot be sampled by."""
        for sensor in ("gyro", "accel"):
            if getattr(self, sensor) != Sampling():
                raise ValueError(
                    f"increments follow each other without a gap, from stamp to stamp of the motion: rate, latency and "
                    f"window of clock.{sensor} do not apply. Leave its Sampling out, and sample the motion at the rate "
                    "at which the unit delivers."
                )

    def check(self, t: Array) -> None:
        """ValueError for times t (n,) s that do not suit the jitter, or the sampling of a sensor."""
        for sensor in (self.gyro, self.accel, self.mag):
            sensor.check(t)
        shortest = float(np.diff(self._steady(t)).min(initial=np.inf))
        if self.jitter and not 2.0 * self.jitter < shortest:
            raise ValueError(
                f"jitter must be below half the shortest step, {0.5 * shortest:.3g} s, or stamps would run back; "
                f"got {self.jitter:g} s."
            )

    def _steady(self, t: Array) -> Array:
        """Stamps without jitter."""
        return t + self.offset + self.rate_offset * (t - t[0]) if self.offset or self.rate_offset else t

    def stamps(self, t: Array, stream: Stream) -> Array:
        """Stamps (n,) s, strictly increasing, of samples taken at true times t (n,) s."""
        self.check(t)
        stamped = self._steady(t)
        if self.jitter == 0.0:
            return stamped
        return stamped + self.jitter * (2.0 * stream.uniforms(0, len(t), 1, JITTER)[:, 0] - 1.0)

    def lost(self, count: int, stream: Stream) -> npt.NDArray[np.bool_]:
        """Which of `count` samples (count,) never arrive."""
        if self.loss == 0.0:
            return np.zeros(count, dtype=bool)
        return stream.uniforms(0, count, 1, LOSS)[:, 0] < self.loss


def steps(t: Array) -> Array:
    """Time (n,) s since the sample before, at times t (n,); the first sample has that of the second."""
    dt = np.empty_like(t)
    dt[1:] = np.diff(t)
    dt[0] = dt[1] if len(t) > 1 else np.inf
    return read_only(dt)


def count(rows: Rows) -> int:
    """How many samples `rows` picks."""
    return rows.stop - rows.start if isinstance(rows, slice) else len(rows)


def part(rows: Rows, block: slice) -> Rows:
    """Those of `rows` that a block of them, counted from their first, holds."""
    return (
        slice(rows.start + block.start, rows.start + block.stop) if isinstance(rows, slice) else rows[block]
    )


def spread(x: Array, rows: Rows, n: int) -> Array:
    """`x` (m, 3) with n rows: these at `rows`, NaN in between."""
    if isinstance(rows, slice):
        return x
    out = np.full((n, 3), np.nan)
    out[rows] = x
    return out
