"""Turns noisy samples into the smoothness they show: that of greatest restricted likelihood.

Sources: Wahba 1985; Wood 2011, J. R. Stat. Soc. B 73. Unlike plain cross-validation it seldom under-smooths, and it
can tell correlated noise, whose spectrum falls by two powers of frequency, from motion, for which it falls by ten.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.derivatives import noise_level
from kreisel.maths.smoothing.bands import DEGREE, knots_at
from kreisel.maths.smoothing.system import TYPICAL_LENGTHS, Samples, Smoothness, System

Array = npt.NDArray[np.float64]

# log10 of the penalty in units of the knot spacing. Above the upper end the normal equations, whose
# condition is 4^ORDER times the penalty, lose nine digits; the knots are spread instead.
_LOWEST, _HIGHEST = -7.0, 4.0

# The likelihood is taken over this many stretches of this many samples at most: enough to know the noise
# level to a few per cent, at a cost that does not grow with the recording.
_STRETCHES, _STRETCH = 8, 4096

# Time constants of noise that are looked for: from the first many steps of the samples up to the time below, s, as
# filters of motion capture leave them (what lasts longer may be motion); and, in steps, where the search begins.
_LONGEST = 0.05
_SHORTEST, _BEGINS = 0.1, (0.7, 2.5, 8.0)

# What memory must gain, as minus twice the logarithm of a likelihood: one white recording in six hundred does.
_WORTH = 10.0


# Of the residuals of white noise half are below 0.67 of its level; a smoothness that leaves this many times more
# than differences of high order do takes for noise what is motion. Correlated noise leaves up to three times more.
_NO_NOISE = 5.0

# Where these differences are taken: their median is good to a tenth.
_PLACES = 300

# The new part of correlated noise, sample by sample, is of the size that white noise would have; where it is more
# than this many times that, it has motion in it.
_NO_NEWS = 1.5


class Choice(NamedTuple):
    """A smoothness, and the spacing of knots (s) in whose units it is."""

    smoothness: Smoothness
    spacing: float


def most_likely(segments: Sequence[Samples], memory: float = 0.0) -> Choice:
    """The smoothness common to all `segments`, behind noise of that memory (s): white noise where it is nil."""
    stretches = _stretches(segments)
    longest = max(s.t[-1] - s.t[0] for s in stretches)
    spacing = _step(stretches)
    highest = _NO_NOISE * _noise(stretches)
    while True:
        search = _Search(stretches, spacing)
        start = search.coarsely(_step(stretches), memory, highest)
        if start.penalty < 10.0 ** (_HIGHEST - 0.5) or spacing > longest / (2 * DEGREE):
            return Choice(search.refined(start, free_memory=False), spacing)
        spacing *= 2.0


def remembering(segments: Sequence[Samples], white: Choice) -> Choice:
    """`white`, or a smoothness behind correlated noise where that is clearly more likely."""
    stretches = _stretches(segments)
    search, step = _Search(stretches, white.spacing), _step(stretches)
    # What white noise has to explain as motion becomes noise again: the penalty can only rise.
    starts = [
        white.smoothness._replace(penalty=white.smoothness.penalty * rise, memory=steps * step)
        for steps in _BEGINS
        for rise in (1.0, 10.0, 100.0)
    ]
    best, level = min(starts, key=search.cost), search.cost(white.smoothness)
    if search.cost(best) > level:
        return white
    found = search.refined(best, free_memory=True)
    if found.memory < _SHORTEST * step or search.cost(found) > level - _WORTH:
        return white
    news = search.level(found) * np.sqrt(-np.expm1(-2.0 * step / found.memory))
    return white._replace(smoothness=found) if news < _NO_NEWS * search.level(white.smoothness) else white


def _step(stretches: Sequence[Samples]) -> float:
    return float(np.median(np.concatenate([np.diff(s.t) for s in stretches])))


def _noise(stretches: Sequence[Samples]) -> float:
    """Standard deviation in a dimension that differences of high order show; infinite where they show none."""
    middle = stretches[len(stretches) // 2]
    level = float(np.sqrt(np.square(noise_level(middle.t, middle.x, _PLACES)).sum() / middle.dimensions))
    return level if level > 0.0 else np.inf


class _Search:
    """The stretches in which a smoothness is looked for, with knots at one spacing."""

    def __init__(self, stretches: Sequence[Samples], spacing: float) -> None:
        # A mean of nil keeps digits where the body is far from the origin.
        centred = [s._replace(x=s.x - s.x.mean(axis=0)) for s in stretches]
        self.systems = [System(s, knots_at(s.t, spacing), spacing) for s in centred]

    def cost(self, smoothness: Smoothness) -> float:
        """Minus twice the logarithm of the likelihood."""
        return sum(system.minus_log_likelihood(smoothness) for system in self.systems)

    def level(self, smoothness: Smoothness) -> float:
        """Standard deviation of the noise in a dimension."""
        free = sum(system.samples.degrees_of_freedom for system in self.systems)
        return float(np.sqrt(sum(system.solve(smoothness).energy for system in self.systems) / free))

    def coarsely(self, step: float, memory: float, highest: float) -> Smoothness:
        """The best of a grid: there can be a second optimum where a tone sits above the motion.

        highest: level of the noise that may be left, half of the time.
        """
        # Noise of a rate is of the order of that of a difference over some tens of samples.
        weight = (30.0 * step) ** 2
        grid = [Smoothness(10.0**k, memory, weight) for k in np.arange(_LOWEST, _HIGHEST + 0.5)]
        for smoothness in sorted(grid, key=self.cost):
            if self._left(smoothness) < highest:
                return smoothness
        return grid[0]

    def refined(self, start: Smoothness, free_memory: bool) -> Smoothness:
        """The nearest optimum, of the memory too where it is free."""
        from scipy.optimize import minimize

        middle = np.log10([start.penalty, start.weight, max(start.memory, 1e-12)])
        # A weight without rates changes nothing.
        free = np.array([True, self.systems[0].samples.rate is not None, free_memory])
        low = np.array([_LOWEST, middle[1] - 6.0, -np.inf])
        high = np.array([_HIGHEST, middle[1] + 6.0, np.log10(_LONGEST)])

        def at(z: Array) -> Smoothness:
            full = middle.copy()
            full[free] = z
            full = np.clip(full, low, high)
            return Smoothness(
                10.0 ** full[0], 10.0 ** full[2] if free_memory else start.memory, 10.0 ** full[1]
            )

        begin = middle[free]
        simplex = np.vstack([begin, begin + np.diag(np.where(begin > 0.5 * _HIGHEST, -0.4, 0.4))])
        found = minimize(
            lambda z: self.cost(at(z)),
            begin,
            method="Nelder-Mead",
            options={"xatol": 0.02, "fatol": 0.05, "initial_simplex": simplex},
        )
        return at(found.x)

    def _left(self, smoothness: Smoothness) -> float:
        """Median length of the residuals, per that of normal variables of variance 1."""
        parts = [system.residuals(system.solve(smoothness).coefficients) for system in self.systems]
        lengths = np.concatenate([np.linalg.norm(part, axis=1) for part in parts])
        return float(np.median(lengths)) / TYPICAL_LENGTHS[self.systems[0].samples.dimensions][0]


def _stretches(segments: Sequence[Samples]) -> list[Samples]:
    total = sum(len(s.t) for s in segments)
    if total <= _STRETCHES * _STRETCH:
        return list(segments)
    starts = np.cumsum([0] + [len(s.t) for s in segments])
    places = np.linspace(_STRETCH // 2, total - _STRETCH // 2, _STRETCHES).astype(int)
    owners = np.searchsorted(starts, places, "right") - 1
    return [_around(segments[k], place - starts[k]) for place, k in zip(places, owners, strict=True)]


def _around(samples: Samples, place: int) -> Samples:
    first = max(0, min(place - _STRETCH // 2, len(samples.t) - _STRETCH))
    return samples.part(slice(first, first + _STRETCH))
