"""Where a body was and how it was turned: the Trajectory protocol, and Poses as a source delivers them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from kreisel.data.checks import Array, finite, increasing, read_only, rotations, same_length, shaped
from kreisel.data.motion import Motion
from kreisel.data.tables import Tabular
from kreisel.maths.knots import knot_rate


@runtime_checkable
class Trajectory(Protocol):
    """A path with attitude that can be asked for its motion at any time in its span."""

    @property
    def span(self) -> tuple[float, float]:
        """First and last time it can be sampled at, s; infinite where it has no end."""
        ...

    def sample(self, t: Array) -> Motion:
        """Motion at times `t` (n,), s, increasing and inside the span."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Poses(Tabular):
    """Positions and attitudes of the body at time stamps, as motion capture or a file gives them."""

    t: Array  # (n,) s after t0_ns, strictly increasing
    p_NB: Array  # (n, 3) m
    R_NB: Array | None = None  # (n, 3, 3); None where the source has positions only
    v_NB: Array | None = None  # (n, 3) m/s; None where the source has no velocity
    t0_ns: int = 0  # epoch of t = 0, ns
    name: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", increasing("t", shaped("t", self.t, ("n",))))
        put(self, "p_NB", finite("p_NB", shaped("p_NB", self.p_NB, ("n", 3))))
        if self.R_NB is not None:
            put(self, "R_NB", rotations("R_NB", shaped("R_NB", self.R_NB, ("n", 3, 3))))
        if self.v_NB is not None:
            put(self, "v_NB", finite("v_NB", shaped("v_NB", self.v_NB, ("n", 3))))
        put(self, "t0_ns", int(self.t0_ns))
        same_length(self.t, p_NB=self.p_NB, R_NB=self.R_NB, v_NB=self.v_NB)

    def __len__(self) -> int:
        return len(self.t)

    def camera_rate(self) -> float | None:
        """Rate, Hz, of what the positions were interpolated between, on straight lines; None where they were not.

        Such poses err together: `thinned(rate)` takes as many as were seen. Rates up to 0.47 of that of the poses are
        found, from a few hundred of them that move or have noise.
        """
        return knot_rate(self.t, self.p_NB)

    def thinned(self, rate_hz: float) -> Poses:
        """Every k-th pose, k the least that leaves no more than `rate_hz` a second.

        For files that were interpolated to a higher rate than the cameras had: their poses err together, which
        smoothing would take for motion. Raises ValueError for a rate that is not positive.
        """
        if not 0.0 < rate_hz < np.inf:
            raise ValueError(f"rate_hz must be a positive number; got {rate_hz!r}.")
        step = float(np.median(np.diff(self.t))) if len(self) > 1 else np.inf
        # The allowance is for a rate that is a whole fraction but for round-off.
        every = slice(None, None, max(1, int(np.ceil(1.0 / (rate_hz * step) - 1e-6))))
        columns = (self.p_NB, self.R_NB, self.v_NB)
        p, R, v = (None if x is None else read_only(np.ascontiguousarray(x[every])) for x in columns)
        assert p is not None  # poses have positions
        return Poses(self.t[every], p, R, v, self.t0_ns, self.name)


# 4 GB of motion: whatever asks for more has mistaken a unit.
_MOST_SAMPLES = 20_000_000


def even_times(first: float, last: float, rate_hz: float) -> Array:
    """Times (n,) s from `first` on at `rate_hz`, up to `last`.

    Raises ValueError for a rate that is not positive, and for more samples than memory holds.
    """
    count = even_count(first, last, rate_hz)
    if not count <= _MOST_SAMPLES:
        raise ValueError(
            f"{last - first:.6g} s at {rate_hz:.6g} Hz are {count:.3g} samples; at most {_MOST_SAMPLES:.3g} are made."
        )
    return some_even_times(first, last, rate_hz, range(count))


def even_count(first: float, last: float, rate_hz: float) -> int:
    """How many times `even_times` has; ValueError for a rate that is not positive."""
    if not 0.0 < rate_hz < 1e7:
        raise ValueError(f"the rate must be a positive number of hertz; got {rate_hz:g}.")
    # The allowance is for round-off in a span that is a whole number of steps.
    return int(min(np.floor((last - first) * rate_hz + 1e-6), 1e18)) + 1


def some_even_times(first: float, last: float, rate_hz: float, numbers: range) -> Array:
    """Those of `even_times` with these numbers."""
    # Counted, not accumulated, so that the last step is as long as the first.
    return np.minimum(first + np.arange(numbers.start, numbers.stop) / rate_hz, last)
