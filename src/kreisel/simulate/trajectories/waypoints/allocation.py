"""Turns waypoints and limits into a curve and a clock that leads along it as fast as the limits let it.

On every leg the clock runs up or down to one rate, keeps it, and runs to the rate at the next waypoint. Legs are laid
out one by one to the limits; where a bend and a change of speed add up to more than a limit, they are made
gentler until all of it holds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kreisel.data.checks import Array
from kreisel.maths.polynomials import Polynomials, hermite
from kreisel.simulate.trajectories.waypoints.limits import Limits, slowness, worst
from kreisel.simulate.trajectories.waypoints.plan import DERIVATIVE, LOOKS, Plan, curve_through, inside
from kreisel.simulate.trajectories.waypoints.route import Route

# Largest first and second derivative of a ramp from 0 to 1 in one second, for least jerk and least snap.
_RAMP = {"jerk": (1.5, 6.0), "snap": (1.875, 10.0 / np.sqrt(3.0))}

# Share of a leg's time that a small change of speed takes at least; at once it would be a jolt.
_SOFT = 1.0 / 3.0

# Between 129 looks a maximum may be missed by 3e-4 of it, where jerk runs through a wave.
_DESIGN = 1.0 - 1e-3

_ROUNDS = 60
_BISECTIONS = 40


def planned_by_limits(route: Route, bounds: Limits, minimum: str, corners: bool) -> Plan:
    """The plan for `bounds`. Raises ValueError where a waypoint cannot be reached within them."""
    curve = curve_through(route, minimum, corners)
    _check_speeds(route, curve, bounds)
    inner = Limits(*(_DESIGN * bound for bound in bounds))
    legs = _Legs.of(route, curve, inner, minimum)
    stretches = legs.stretches()
    plan = _plan(curve, stretches, minimum)
    for _ in range(_ROUNDS):
        longer = slowness(plan.looks().max(axis=2), inner)
        if longer.max() <= 1.0:
            break
        legs.ease(stretches, longer)
        stretches = legs.stretches()
        plan = _plan(curve, stretches, minimum)
    else:
        plan = _plan(curve, _slower(route, stretches, float(longer.max())), minimum)
    found = worst(plan, bounds)
    if found is not None:
        raise ValueError(
            f"{found.sentence(route)}, at the speeds given. Lower the speed at one of the two, or raise the limit."
        )
    return plan


class _Stretch(NamedTuple):
    """A piece of the clock: the reading goes on by `rise`, at a rate that runs from one to the other."""

    duration: float  # s
    start: float  # m
    rise: float  # m
    before: float  # m/s
    after: float  # m/s
    leg: int  # -1: at rest


def _plan(curve: Polynomials, stretches: list[_Stretch], minimum: str) -> Plan:
    duration, start, rise, before, after, leg = (np.array(c) for c in zip(*stretches, strict=True))
    ends = np.zeros((len(duration), 2, DERIVATIVE[minimum], 1))
    ends[:, 0, 0, 0], ends[:, 1, 0, 0] = start, start + rise
    ends[:, 0, 1, 0], ends[:, 1, 1, 0] = before, after
    breaks = np.concatenate([[0.0], np.cumsum(duration)])
    return Plan(curve, hermite(breaks, ends), leg.astype(np.int64), np.arange(len(curve.breaks)))


def _slower(route: Route, stretches: list[_Stretch], factor: float) -> list[_Stretch]:
    """All movement slower by one factor, unless that would change a speed that is given."""
    if (route.speed > 0.0).any():
        return stretches
    return [
        s._replace(duration=s.duration * factor, before=s.before / factor, after=s.after / factor)
        if s.leg >= 0
        else s
        for s in stretches
    ]


@dataclass(slots=True, eq=False)
class _Legs:
    """The legs of a curve with what the limits leave of them; `cap` and `gentle` shrink from round to round."""

    route: Route
    bounds: Limits
    nodes: Array  # (n,) m
    rates: Array  # (n,) m/s, of the clock at the waypoints; NaN: free
    stretch: Array  # (n - 1,) largest speed on each leg where the clock runs at rate 1
    cap: Array  # (n - 1,) m/s, rate at which a leg can be run through
    gentle: Array  # (n - 1,) share of the limits that a ramp may take
    ramp: tuple[float, float]

    @classmethod
    def of(cls, route: Route, curve: Polynomials, bounds: Limits, minimum: str) -> _Legs:
        """The legs of a curve, before anything is known of how bends and ramps add up."""
        nodes = curve.breaks
        sizes = np.linalg.norm(curve(inside(nodes), 3)[1:], axis=2).reshape(3, -1, LOOKS).max(axis=2)
        # At rate r they are r, r^2 and r^3 times these.
        with np.errstate(divide="ignore"):
            caps = 1.0 / slowness(sizes, bounds).max(axis=0)
        rates = np.where(route.rests, 0.0, route.speed / np.linalg.norm(curve(nodes, 1)[1], axis=1))
        return cls(route, bounds, nodes, rates, sizes[0], caps, np.ones(len(caps)), _RAMP[minimum])

    def ease(self, stretches: list[_Stretch], longer: Array) -> None:
        """Make gentler what should take longer by factors `longer` (3, k), for speed, acceleration and jerk."""
        for k in np.flatnonzero(longer.max(axis=0) > 1.0).tolist():
            # A little more than needed: what only ever comes closer never arrives.
            leg, factor = stretches[k].leg, 1.003 * float(longer[:, k].max())
            if stretches[k].before != stretches[k].after:
                self.gentle[leg] /= min(factor, 2.0) ** 2
                self.cap[leg] *= factor**-0.25
            else:
                self.cap[leg] /= factor

    def stretches(self) -> list[_Stretch]:
        """The clock of this round."""
        rates, stop = self._rates(), self.route.stop
        rows = []
        for k, (a, b) in enumerate(zip(rates[:-1].tolist(), rates[1:].tolist(), strict=True)):
            if stop[k] > 0.0:
                rows.append(_Stretch(stop[k], self.nodes[k], 0.0, 0.0, 0.0, -1))
            rows += self._leg(k, a, b) if self.bounds.ramps else self._all_the_way(k, a, b)
        if stop[-1] > 0.0 and not self.route.closed:
            rows.append(_Stretch(stop[-1], self.nodes[-1], 0.0, 0.0, 0.0, -1))
        return rows

    def _rates(self) -> Array:
        """Rates at the waypoints: as given, else the highest that the legs and the neighbours let be."""
        ends = (self.cap[-1:], self.cap[:1]) if self.route.closed else (self.cap[:1], self.cap[-1:])
        most = np.minimum(np.append(ends[0], self.cap), np.append(self.cap, ends[1]))
        free = np.isnan(self.rates)
        rates = np.where(free, most, self.rates)
        # Round a closed path twice: what its end leaves open its begin may not.
        for _ in range((1 + self.route.closed) if self.bounds.ramps else 0):
            for k in range(len(self.cap)):
                if free[k + 1]:
                    rates[k + 1] = min(rates[k + 1], self._reach(k, rates[k]))
            self._meet(rates)
            for k in reversed(range(len(self.cap))):
                if free[k]:
                    rates[k] = min(rates[k], self._reach(k, rates[k + 1]))
            self._meet(rates)
        self._check(rates)
        return rates

    def _meet(self, rates: Array) -> None:
        """A closed path leaves its first point as it arrives there."""
        if self.route.closed:
            rates[[0, -1]] = rates[[0, -1]].min()

    def _length(self, k: int, a: float, b: float) -> float:
        """Way of the clock, m, over a ramp from rate a to rate b on leg k."""
        return 0.5 * (a + b) * self._time(k, a, b)

    def _time(self, k: int, a: float, b: float) -> float:
        """Time of that ramp, s."""
        if a == b:
            return 0.0
        speed = abs(b - a) * self.stretch[k] / self.gentle[k]
        slope, bend = self.ramp
        # A start from rest is no small change.
        soft = _SOFT * (self.nodes[k + 1] - self.nodes[k]) * min(a, b) / max(a, b) ** 2
        return float(
            max(slope * speed / self.bounds.acceleration, np.sqrt(bend * speed / self.bounds.jerk), soft)
        )

    def _reach(self, k: int, rate: float) -> float:
        """The highest rate that one ramp over all of leg k joins to `rate`."""
        length = self.nodes[k + 1] - self.nodes[k]
        high = rate + 1.0
        while np.isfinite(high) and self._length(k, rate, high) < length:
            high = rate + 2.0 * (high - rate)
        return _farthest(rate, high, lambda x: self._length(k, rate, x) <= length)

    def _leg(self, k: int, a: float, b: float) -> list[_Stretch]:
        """Ramp, steady run and ramp from rate a to rate b."""
        begin, length = float(self.nodes[k]), float(self.nodes[k + 1] - self.nodes[k])
        top = self._top(k, a, b, length)
        first, last = self._length(k, a, top), self._length(k, top, b)
        steady = length - first - last
        rows = []
        if first > 0.0:
            rows.append(_Stretch(self._time(k, a, top), begin, first, a, top, k))
        # What is left of a run without length is round-off.
        if steady > 1e-9 * length:
            rows.append(_Stretch(steady / top, begin + first, steady, top, top, k))
        if last > 0.0:
            rows.append(_Stretch(self._time(k, top, b), begin + length - last, last, top, b, k))
        return rows

    def _top(self, k: int, a: float, b: float, length: float) -> float:
        """The steady rate on leg k: its cap, or as near as both ramps fit."""

        def fits(x: float) -> bool:
            return self._length(k, a, x) + self._length(k, x, b) <= length

        low, high, cap = min(a, b), max(a, b), float(self.cap[k])
        if cap >= high:
            return _farthest(high, min(cap, max(self._reach(k, a), self._reach(k, b))), fits)
        return _farthest(low, cap, fits) if cap < low else high

    def _all_the_way(self, k: int, a: float, b: float) -> list[_Stretch]:
        """Where changes of speed are free they take all of the leg, or half of it each."""
        begin, length, cap = (
            float(self.nodes[k]),
            float(self.nodes[k + 1] - self.nodes[k]),
            float(self.cap[k]),
        )
        if a + b > 0.0:
            return [_Stretch(2.0 * length / (a + b), begin, length, a, b, k)]
        half = 0.5 * length
        return [
            _Stretch(length / cap, begin, half, 0.0, cap, k),
            _Stretch(length / cap, begin + half, half, cap, 0.0, k),
        ]

    def _check(self, rates: Array) -> None:
        """Refuse what nothing limits, and speeds that are too far apart for their leg."""
        names = self.route.name_of
        for k, (a, b) in enumerate(zip(rates[:-1].tolist(), rates[1:].tolist(), strict=True)):
            at_all = a + b > 0.0 or self.bounds.ramps
            if not np.isfinite(a + b if at_all else self.cap[k]):
                raise ValueError(
                    f"nothing says how fast to go from {names[k]} to the next: give times, speeds, max_speed or "
                    "max_acceleration."
                )
            length, need = (
                self.nodes[k + 1] - self.nodes[k],
                self._length(k, a, b) if self.bounds.ramps else 0.0,
            )
            if need > length * (1.0 + 1e-9):
                raise ValueError(
                    f"{names[k + 1]} cannot be reached within the limits: from {a * self.stretch[k]:.4g} m/s at "
                    f"{names[k]} to {b * self.stretch[k]:.4g} m/s takes {need:.4g} m, {need - length:.3g} more than "
                    f"the {length:.4g} m between them. Bring the speeds closer, or raise the limit."
                )


def _farthest(start: float, end: float, fits: Callable[[float], bool]) -> float:
    """How far one gets from `start`, which fits, towards `end`."""
    if fits(end):
        return end
    for _ in range(_BISECTIONS):
        middle = 0.5 * (start + end)
        start, end = (middle, end) if fits(middle) else (start, middle)
    return start


def _check_speeds(route: Route, curve: Polynomials, bounds: Limits) -> None:
    """Refuse speeds at waypoints that are beyond a limit by themselves."""
    _, v, a = curve(curve.breaks, 2)
    speed = np.nan_to_num(route.speed)
    bend = np.linalg.norm(np.cross(v, a), axis=1) / np.linalg.norm(v, axis=1) ** 3
    for k, name in enumerate(route.name_of):
        if speed[k] > bounds.speed:
            raise ValueError(
                f"{name} is to be passed at {speed[k]:g} m/s, {speed[k] - bounds.speed:.3g} above "
                f"max_speed = {bounds.speed:g}."
            )
        across = speed[k] ** 2 * bend[k]
        if across > bounds.acceleration:
            raise ValueError(
                f"{name} is to be passed at {speed[k]:g} m/s: in the bend there that takes {across:.4g} m/s^2, "
                f"{across - bounds.acceleration:.3g} above max_acceleration = {bounds.acceleration:g}, which allows "
                f"{np.sqrt(bounds.acceleration / bend[k]):.4g} m/s."
            )
