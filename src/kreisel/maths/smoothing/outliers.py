"""Turns the residuals of a smoothed recording into single samples that do not belong to it, and lasting jumps.

What is left of a sample and what is left of all samples after it are the matched filters for an outlier and for a
step (Chen and Liu 1993, J. Am. Stat. Assoc. 88); each is judged against its own median, which few outliers move.
Where one stands out, the samples around it are smoothed again without a few of them, or in two, and the explanation
that leaves less is taken, provided that it leaves no more than noise. A motion that is rough for a while is explained
by neither: nothing of it is set aside.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.maths.smoothing.axes import along_axes
from kreisel.maths.smoothing.bands import ORDER, correlated, inverse_band, knots_at, whitened
from kreisel.maths.smoothing.blocks import Piece
from kreisel.maths.smoothing.likelihood import Choice
from kreisel.maths.smoothing.system import TYPICAL_LENGTHS, Samples, System

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

FEWEST = 20
"""Samples between two breaks; fewer are outliers."""

# Standard deviations. Gaussian noise passes 5.5 once in thirty million samples, and in longer recordings more is asked;
# a step is looked for with more freedom, so that a little more is asked of it as well.
_OUTLIER, _STEP = 5.5, 6.5

# In one round only what is at least this share of the largest: lesser ones may be its echo.
_SHARE = 0.3

AROUND = 40
"""Samples on either side of an event that are smoothed again."""

# Samples taken together as one event, and samples taken out of it at most, altogether and in a row.
_TOGETHER, _MOST, _RUN = 8, 6, 3

# What an explanation costs per sample it takes out, in squares per variance and dimension; and what a break does in
# such samples, for it says more about a recording than three outliers.
_PRICE, _BREAK = 12.0, 3


class Division(NamedTuple):
    """Which samples belong to a recording, and where it is broken."""

    kept: Mask  # (n,)
    breaks: tuple[int, ...] = ()  # samples before which there is a break, in order
    met: tuple[int, ...] = ()  # places where the path bends, but does not jump
    left: tuple[
        int, ...
    ] = ()  # places where neither outliers nor a jump make it smooth: nothing is taken out

    @property
    def edges(self) -> list[tuple[int, int]]:
        """First and last sample, not included, between any two breaks."""
        places = [0, *self.breaks, len(self.kept)]
        return list(pairwise(places))

    def segments(self, samples: Samples) -> list[Samples]:
        """What is kept, between any two breaks."""
        return [samples.part(slice(a, b)).part(self.kept[a:b]) for a, b in self.edges]


@dataclass(frozen=True, slots=True)
class Fit:
    """Columns that share their smoothness, smoothed."""

    samples: Samples  # all of them
    choice: Choice
    pieces: tuple[Piece, ...]  # between any two breaks
    sigma: float  # standard deviation of the noise in a dimension
    spread: Array  # (k,) of the noise along each axis, per their mean square


class Event(NamedTuple):
    """Samples that stand out together."""

    rows: Indices
    steps: tuple[int, ...]  # the most likely places of steps, none to two
    within: tuple[int, int]  # up to the events, breaks or ends before and after


def divide(fits: Sequence[Fit], before: Division) -> Division:
    """`before` with those events taken out that single samples, a burst of them or a jump explain."""
    kept, breaks, unexplained = before.kept.copy(), set(before.breaks), []
    for event in _events(fits, before):
        if _near(event.rows, before.left):
            continue
        best = min(_explanations(fits, before, event), key=lambda e: e.cost, default=None)
        if best is None or best.bends:
            unexplained.append(event)
        else:
            kept[list(best.out)] = False
            breaks |= {best.step} - {0}
    after = _tidy(before._replace(kept=kept, breaks=tuple(sorted(breaks))))
    # Without what was explained the noise is less, and the rest may be explained in the next round.
    return after if not same(after, before) else _left_as_they_are(before, unexplained)


def same(a: Division, b: Division) -> bool:
    """Whether two divisions are alike."""
    return a.breaks == b.breaks and a.left == b.left and bool(np.array_equal(a.kept, b.kept))


def _left_as_they_are(division: Division, unexplained: Sequence[Event]) -> Division:
    kept = division.kept.copy()
    for event in unexplained:
        kept[max(0, event.rows[0] - AROUND) : event.rows[-1] + AROUND + 1] = True
    places = tuple(int(event.rows[len(event.rows) // 2]) for event in unexplained)
    return division._replace(kept=kept, left=division.left + places)


def _events(fits: Sequence[Fit], division: Division) -> list[Event]:
    """What stands out most: at least a share of the largest."""
    pulses, steps = (
        np.max(scores, axis=0) for scores in zip(*(_scores(fit, division) for fit in fits), strict=True)
    )
    least = max(_SHARE * max(pulses.max(), steps.max()), np.sqrt(2.0 * np.log(100.0 * len(pulses))))
    loud = np.flatnonzero((pulses > max(_OUTLIER, least)) | (steps > max(_STEP, least)))
    if not loud.size:
        return []
    groups = np.split(loud, np.flatnonzero(np.diff(loud) > _TOGETHER) + 1)
    ends = [0, *(int(rows[-1]) + 1 for rows in groups[:-1])]
    begins = [*(int(rows[0]) for rows in groups[1:]), len(division.kept)]
    found = []
    for rows, end, begin in zip(groups, ends, begins, strict=True):
        first, last = next(edges for edges in division.edges if edges[0] <= rows[0] < edges[1])
        found.append(Event(rows, _peaks(rows, steps), (max(first, end), min(last, begin))))
    return found


def _peaks(rows: Indices, steps: Array) -> tuple[int, ...]:
    """The highest of `rows` and the highest of those further away from it than outliers in a row."""
    top = int(rows[np.argmax(steps[rows])])
    if steps[top] < _STEP:
        return ()
    others = rows[np.abs(rows - top) > _RUN]
    if not others.size or steps[others].max() < _STEP:
        return (top,)
    return (top, int(others[np.argmax(steps[others])]))


def _near(rows: Indices, places: Sequence[int]) -> bool:
    return any(rows[0] - _TOGETHER <= place <= rows[-1] + _TOGETHER for place in places)


def _tidy(division: Division) -> Division:
    """Stretches of a few samples are none of their own: they do not count."""
    kept, breaks = division.kept.copy(), list(division.breaks)
    for a, b in division.edges:
        if kept[a:b].sum() < FEWEST and (a, b) != (0, len(kept)):
            kept[a:b] = False
            # Whether what comes after goes on from what was before shows in the next round.
            breaks = [k for k in breaks if k not in (a, b)]
    return division._replace(kept=kept, breaks=tuple(breaks))


def _scores(fit: Fit, division: Division) -> tuple[Array, Array]:
    """(n,) how far every sample, and all samples from there to the next break, stand out; 0 where set aside."""
    pulses, steps = np.zeros((2, len(division.kept)))
    found = [_matched(piece) for piece in fit.pieces]
    for score, parts in zip((pulses, steps), zip(*found, strict=True), strict=True):
        size = np.abs(np.concatenate(parts))
        # Half of a recording may be at rest, or its noise have heavy tails: then the loud part sets the measure.
        usual = np.quantile(size, (0.5, 0.9), axis=0) / np.array(TYPICAL_LENGTHS[1])[:, None]
        least = 0.1 * np.sqrt(np.mean(np.square(size), axis=0))
        score[division.kept] = np.max(size / np.maximum(np.maximum(*usual), least + 1e-300), axis=1)
    return pulses, steps


def _matched(piece: Piece) -> tuple[Array, Array]:
    """(n, k) products of the residuals with a pulse and with a step at every sample, weighted as noise asks."""
    t, x = piece.samples.t, piece.samples.x
    value = np.empty((1, *x.shape))
    piece(t, 0, value)
    kept, new = correlated(t, piece.first_coefficients(t), piece.smoothness.memory)
    pulse = whitened(x + piece.centre - value[0], kept, new) / new[:, None]
    pulse[:-1] -= kept[1:, None] * pulse[1:]
    step = np.cumsum(pulse[::-1], axis=0)[::-1].copy()
    step[0] = 0.0
    return along_axes(value[0], pulse), along_axes(value[0], step)


class _Explanation(NamedTuple):
    """What makes the samples around an event noise."""

    cost: float
    out: tuple[int, ...]  # samples that do not count
    step: int = 0  # sample before which there is a break
    bends: bool = False  # it is the motion whose velocity steps: nothing is wrong with the samples


def _explanations(fits: Sequence[Fit], division: Division, event: Event) -> Iterator[_Explanation]:
    first = max(event.within[0], event.rows[0] - AROUND)
    last = min(event.within[1], event.rows[-1] + AROUND + 1)
    rows = first + np.flatnonzero(division.kept[first:last])
    price = _PRICE * sum(fit.samples.dimensions for fit in fits)
    for step in (0, *(event.steps[0] + k for k in (-1, 0, 1) if event.steps)):
        if step and _near(event.rows, division.met):
            continue
        made = [_quiet(fits, part) for part in ([rows[rows < step], rows[rows >= step]] if step else [rows])]
        if None in made:
            continue
        energy = sum(quiet.energy for quiet in made if quiet)
        out = tuple(k for quiet in made if quiet for k in quiet.out)
        if _longest_run(~division.kept[first:last], np.array(out, dtype=int) - first) <= _RUN:
            yield _Explanation(energy + price * (len(out) + _BREAK * (step > 0)), out, step)
    yield _Explanation(_bend(fits, rows, event) + price, (), bends=True)
    for begin, end in _bursts(event):
        energy = _burst(fits, rows, begin, end)
        if energy < np.inf:
            yield _Explanation(energy + _BREAK * price, tuple(rows[(rows >= begin) & (rows < end)]))


def _bend(fits: Sequence[Fit], rows: Indices, event: Event) -> float:
    """Penalised squares per variance, with a step of velocity at the best place of the event."""
    t = fits[0].samples.t[rows]
    # Near an end a bend would explain whatever is there.
    inner = (t >= t[ORDER]) & (t <= t[-1 - ORDER])
    near = t[inner & (rows >= event.rows[0] - 1) & (rows <= event.rows[-1] + 1)]
    if not near.size:
        return np.inf
    places = np.union1d(near, 0.5 * (near[1:] + near[:-1]))
    ramps = np.maximum(t[:, None] - places, 0.0) / (t[-1] - t[0])
    left = np.zeros(len(places))
    for fit in fits:
        system = _system(fit.samples.part(rows), fit.choice, ramps)
        solution = system.solve(fit.choice.smoothness)
        new, rest = system.news(solution.coefficients, fit.choice.smoothness.memory)
        columns = fit.samples.x.shape[1]
        products = rest[:, columns:].T @ new[:, :columns]
        gains = np.square(products).sum(axis=1) / np.einsum("nk,nk->k", rest[:, columns:], new[:, columns:])
        alone = system.penalised_squares(solution.coefficients, fit.choice.smoothness, columns=columns)
        left += (alone - gains) / fit.sigma**2
    return float(left.min())


def _system(samples: Samples, choice: Choice, more: Array) -> System:
    """The equations of some samples alone, about their mean, with `more` (n, m) columns."""
    x = np.column_stack([samples.x - samples.x.mean(axis=0), more])
    return System(samples._replace(x=x, rate=None), knots_at(samples.t, choice.spacing), choice.spacing)


def _longest_run(away: Mask, out: Indices) -> int:
    """How many samples in a row are away with `out` among them: the longest row that holds one of these."""
    away = away.copy()
    away[out] = True
    edges = np.flatnonzero(np.diff(np.concatenate([[False], away, [False]]).astype(np.int8)))
    return max(
        (b - a for a, b in zip(edges[::2], edges[1::2], strict=True) if any((out >= a) & (out < b))),
        default=0,
    )


def _bursts(event: Event) -> Iterator[tuple[int, int]]:
    """First sample of what may be a burst of outliers, and first after it."""
    if len(event.steps) == 2:
        a, b = sorted(event.steps)
        yield from ((a + j, b + k) for j in (-1, 0, 1) for k in (-1, 0, 1))


def _burst(fits: Sequence[Fit], rows: Indices, begin: int, end: int) -> float:
    """Penalised squares per variance without the samples from `begin` up to `end`; infinite where these are no burst.

    They are one where they lie to one side, from the first to the last: where a path bends they leave it slowly.
    """
    inside = (rows >= begin) & (rows < end)
    quiet = _quiet(fits, rows[~inside])
    if quiet is None or quiet.out or not inside.any():
        return np.inf
    away = [_beside(fit, rows[~inside], rows[inside]) for fit in fits]
    lengths = np.linalg.norm(np.concatenate(away, axis=1), axis=1)
    return quiet.energy if lengths.min() > max(_OUTLIER, 0.5 * lengths.max()) else np.inf


def _beside(fit: Fit, rows: Indices, others: Indices) -> Array:
    """(n, k) differences of some samples from the spline through other `rows`, per standard deviation of noise."""
    piece = Piece(fit.samples.part(rows), fit.choice)
    value = np.empty((1, len(others), fit.samples.x.shape[1]))
    piece(fit.samples.t[others], 0, value)
    return along_axes(value[0], fit.samples.x[others] - value[0]) / (fit.sigma * fit.spread)


class _Quiet(NamedTuple):
    """Samples that are noise around a spline."""

    energy: float  # penalised squares per variance
    out: tuple[int, ...]  # those that had to be taken out


def _quiet(fits: Sequence[Fit], rows: Indices) -> _Quiet | None:
    """`rows` without the few samples that make them loud; None where these are not few, or no spline is theirs."""
    out: list[int] = []
    while len(out) <= min(_MOST, len(rows) - 2 * ORDER):
        rest = rows[~np.isin(rows, out)]
        try:
            energies, loudness = zip(*(_alone(fit, rest) for fit in fits), strict=True)
        except np.linalg.LinAlgError:
            # A few samples behind a step, hardly held by the penalty: their spline is lost in round-off.
            return None
        loudest = np.max(loudness, axis=0)
        if loudest.max() < _OUTLIER:
            return _Quiet(sum(energies), _truly(fits, rest, np.array(sorted(out), dtype=np.intp)))
        out.append(int(rest[np.argmax(loudest)]))
    return None


def _truly(fits: Sequence[Fit], rest: Indices, out: Indices) -> tuple[int, ...]:
    """Those of `out` that lie off the spline through the rest: a good sample between bad ones may have been louder."""
    if not out.size:
        return ()
    away = np.concatenate([_beside(fit, rest, out) for fit in fits], axis=1)
    return tuple(int(k) for k in out[np.abs(away).max(axis=1) > _OUTLIER])


def _alone(fit: Fit, rows: Indices) -> tuple[float, Array]:
    """Penalised squares per variance of some samples alone, and (n,) residuals per standard deviation."""
    samples = fit.samples.part(rows)
    centre = samples.x.mean(axis=0)
    samples = samples._replace(x=samples.x - centre)
    system = System(samples, knots_at(samples.t, fit.choice.spacing), fit.choice.spacing)
    solution = system.solve(fit.choice.smoothness)
    known = system.variance(samples.t, 0, inverse_band(system.factor(fit.choice.smoothness)))
    residual = system.residuals(solution.coefficients)
    size = np.abs(along_axes(samples.x - residual + centre, residual)) / (fit.sigma * fit.spread)
    # A sample that no other vouches for is its own spline.
    return solution.energy / fit.sigma**2, size.max(axis=1) / np.sqrt(np.maximum(1.0 - known, 0.05))
