"""Turns limits on speed, acceleration and jerk into what is beyond them, where and by how much."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from kreisel.data.checks import Array, finite_number
from kreisel.simulate.trajectories.waypoints.plan import Plan
from kreisel.simulate.trajectories.waypoints.route import Route

NAMES = ("max_speed", "max_acceleration", "max_jerk")
UNITS = ("m/s", "m/s^2", "m/s^3")

# A limit that only just holds is met by a path that was laid out to it.
_SLACK = 1.0 + 1e-9


class Limits(NamedTuple):
    """The most of each, infinite where it is free."""

    speed: float  # m/s
    acceleration: float  # m/s^2
    jerk: float  # m/s^3

    @property
    def ramps(self) -> bool:
        """Whether a change of speed is limited."""
        return bool(np.isfinite(self.acceleration) or np.isfinite(self.jerk))


def limits(*given: Any) -> Limits:
    """Limits from three numbers, None where there is none; ValueError for what is not above 0."""
    return Limits(
        *(
            np.inf if value is None else finite_number(name, value, above=0.0)
            for name, value in zip(NAMES, given, strict=True)
        )
    )


def slowness(sizes: Array, bounds: Limits) -> Array:
    """How many times as long everything would have to take for each of the limits to hold, from sizes (3, ...)."""
    over = np.stack([size / bound for size, bound in zip(sizes, bounds, strict=True)])
    return np.stack([over[0], np.sqrt(over[1]), np.cbrt(over[2])])


class Excess(NamedTuple):
    """A limit that is not kept."""

    which: int  # 0 speed, 1 acceleration, 2 jerk
    leg: int
    value: float
    limit: float

    @property
    def longer(self) -> float:
        """How many times as long the leg would have to take."""
        return float((self.value / self.limit) ** (1.0 / (self.which + 1)))

    def sentence(self, route: Route) -> str:
        """Which leg and by how much, without a full stop."""
        unit, what = UNITS[self.which], NAMES[self.which].removeprefix("max_")
        return (
            f"from {route.name_of[self.leg]} to the next the {what} reaches {self.value:.4g} {unit}, "
            f"{self.value - self.limit:.3g} above {NAMES[self.which]} = {self.limit:g}"
        )


def worst(plan: Plan, bounds: Limits) -> Excess | None:
    """The limit that is exceeded most, or None."""
    most = plan.looks().max(axis=2)
    longer = slowness(most, bounds)
    which, k = (int(i) for i in np.unravel_index(int(np.argmax(longer)), longer.shape))
    if longer[which, k] <= _SLACK:
        return None
    return Excess(which, int(plan.leg[k]), float(most[which, k]), float(bounds[which]))
