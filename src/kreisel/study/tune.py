"""Turns recordings with truth into a setting for a filter, and says what it gains on recordings left out.

Each recording is left out in turn (of more than five, a fifth of them), the search runs on the others, and its
proposal is scored on what it has not seen: only that says what a setting is worth. Source of the idea: Stone 1974,
J. R. Stat. Soc. B 36, "Cross-validatory choice and assessment of statistical predictions".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from kreisel.data.cards import Card, Shown
from kreisel.data.checks import Array, choice
from kreisel.data.trial import Trial
from kreisel.estimate.run import run
from kreisel.evaluate.attitude_errors import attitude_errors

Score = Literal["total", "heading", "inclination"]

FEWEST = 3
"""Recordings that cross-validation takes at least: with two, each proposal rests on a single one."""

FOLDS = 5
"""Shares in which recordings are left out, one by one where there are no more: each share costs a search."""

STEPS = (2.0, math.sqrt(2.0))
"""Factors by which the search moves a number up and down: the coarse ones first."""

REACH = 16.0
"""No number is moved further from its default than by this factor."""

SIGNIFICANT = 0.05
"""Probability of such a gain by chance, below which it is called significant."""

_EXACT_FLIPS = 14
_FLIPS = 20_000

Rows = npt.NDArray[np.int64]

_Key = tuple[int, ...]  # by how many times sqrt(2) each number is multiplied


@dataclass(frozen=True, slots=True)
class Gain:
    """What a proposal did to one recording that had no part in it."""

    recording: str
    default_deg: float  # RMSE with the filter as it was given
    proposed_deg: float  # RMSE with what the search proposed without this recording


@dataclass(frozen=True, slots=True)
class Tuning(Shown):
    """A setting proposed, and what it is worth."""

    filter: Any  # with the proposal
    score: Score
    changed: dict[str, tuple[float, float]]  # name -> as it was, as proposed
    spread: dict[str, tuple[float, float]]  # name -> least and largest that a fold proposed
    default_deg: float  # mean RMSE over all recordings, as it was
    proposed_deg: float  # with the proposal, on the recordings it was chosen by
    left_out: tuple[Gain, ...]
    p_value: float  # probability of such a mean gain on recordings left out if there were none

    def card(self) -> Card:
        """The numbers that the proposal changes, and the verdict."""
        rows = [
            (name, f"{before:.4g}", f"{after:.4g}", "{:.4g} to {:.4g}".format(*self.spread[name]))
            for name, (before, after) in self.changed.items()
        ]
        title = f"Tuning of {type(self.filter).__name__}: {len(self.left_out)} recordings"
        return Card(title, ("", "as it was", "proposed", "folds proposed"), rows, (self.verdict,))

    @property
    def gain(self) -> float:
        """Share of the mean RMSE that is saved on recordings left out: 0.1 is ten per cent less error."""
        before, after = (sum(getattr(g, n) for g in self.left_out) for n in ("default_deg", "proposed_deg"))
        return 1.0 - after / before

    @property
    def significant(self) -> bool:
        """Whether there is a gain on recordings left out, larger than chance would make it."""
        return self.gain > 0.0 and self.p_value < SIGNIFICANT

    @property
    def verdict(self) -> str:
        """One sentence: use it, or do not."""
        if not self.changed:
            return "Nothing in reach is better than the filter as it is: keep it."
        told = f"On recordings left out the error changes by {-100.0 * self.gain:+.1f} % (p = {self.p_value:.2g})"
        if self.significant:
            return f"{told}: the proposal carries over to recordings it has not seen."
        return f"{told}: not significant. Keep the filter as it is, or bring more recordings."


def tune(
    filter: Any,
    trials: Sequence[Trial],
    *,
    vary: Sequence[str] | None = None,
    score: Score = "total",
    progress: Callable[[int], None] | None = None,
) -> Tuning:
    """Propose a setting of `filter` for recordings like `trials`, by cross-validation over them.

    vary : names of its positive numbers to move, each by factors up to 16 from where it is; by default all.
    score : the error, "total", "heading" or "inclination", whose RMSE (deg), mean over recordings, is to fall.
    progress : called with the number of settings tried so far.

    The search goes along one number after the other, by factors of 2 and then of sqrt(2), as long as that helps.
    Raises ValueError for fewer than three trials, for unknown names and for a number that is not positive.
    """
    choice("score", score, get_args(Score))
    if len(trials) < FEWEST:
        raise ValueError(
            f"tuning takes at least {FEWEST} recordings, or nothing can be left out; got {len(trials)}."
        )
    names = _names(filter, vary)
    errors = _Errors(filter, names, trials, score, progress)
    everything = np.arange(len(trials))
    folds = [part for part in np.array_split(everything, min(len(trials), FOLDS)) if len(part)]
    start = (0,) * len(names)
    proposals = [_search(errors, start, np.setdiff1d(everything, part)) for part in folds]
    best = _search(errors, start, everything)
    before, after = errors(start), errors(best)
    left_out = [
        Gain(trials[k].name or f"{k + 1}", float(before[k]), float(errors(proposal)[k]))
        for part, proposal in zip(folds, proposals, strict=True)
        for k in part
    ]
    proposed = errors.filter(best)
    return Tuning(
        proposed,
        score,
        {n: (getattr(filter, n), getattr(proposed, n)) for n, e in zip(names, best, strict=True) if e},
        _spread(filter, names, proposals),
        float(before.mean()),
        float(after.mean()),
        tuple(left_out),
        _chance(np.array([g.default_deg - g.proposed_deg for g in left_out])),
    )


def tunable(filter: Any) -> list[str]:
    """Names of the positive numbers in a filter's tuning."""
    values = {field.name: getattr(filter, field.name) for field in fields(filter)}
    return [name for name, value in values.items() if isinstance(value, float) and value > 0.0]


def _names(filter: Any, vary: Sequence[str] | None) -> list[str]:
    known = tunable(filter)
    return known if vary is None else [choice("vary", name, known) for name in dict.fromkeys(vary)]


class _Errors:
    """RMSE of each trial by setting, every setting run once."""

    def __init__(
        self,
        filter: Any,
        names: Sequence[str],
        trials: Sequence[Trial],
        score: Score,
        progress: Callable[[int], None] | None,
    ) -> None:
        self._given, self._names, self._trials = filter, names, trials
        self._score, self._progress = score, progress
        self._known: dict[_Key, Array] = {}

    def filter(self, key: _Key) -> Any:
        moved = {
            n: getattr(self._given, n) * 2.0 ** (e / 2) for n, e in zip(self._names, key, strict=True) if e
        }
        return replace(self._given, **moved)

    def __call__(self, key: _Key) -> Array:
        if key not in self._known:
            self._known[key] = np.array([self._rmse(self.filter(key), trial) for trial in self._trials])
            if self._progress is not None:
                self._progress(len(self._known))
        return self._known[key]

    def _rmse(self, filter: Any, trial: Trial) -> float:
        errors = attitude_errors(trial.reference, run(filter, trial.recording))
        # Not the whole summary, whose percentiles would take as long as the filter.
        return float(np.rad2deg(np.sqrt(np.mean(getattr(errors, self._score)[errors.counts] ** 2))))


def _search(errors: _Errors, start: _Key, rows: Rows) -> _Key:
    """The best setting that steps along one number at a time find for the trials in `rows`."""
    best, lowest = start, errors(start)[rows].mean()
    reach = round(2.0 * math.log2(REACH))
    for factor in STEPS:
        step = round(2.0 * math.log2(factor))
        moved = True
        while moved:
            moved = False
            for k, way in product(range(len(start)), (step, -step)):
                key = (*best[:k], best[k] + way, *best[k + 1 :])
                if abs(key[k]) <= reach and (mean := errors(key)[rows].mean()) < lowest:
                    best, lowest, moved = key, mean, True
    return best


def _spread(filter: Any, names: Sequence[str], proposals: Sequence[_Key]) -> dict[str, tuple[float, float]]:
    exponents = np.array(proposals)
    factors = 2.0 ** (np.stack([exponents.min(axis=0), exponents.max(axis=0)], axis=1) / 2)
    moved = (exponents != 0).any(axis=0)
    return {
        name: (getattr(filter, name) * float(low), getattr(filter, name) * float(high))
        for name, (low, high), any_moved in zip(names, factors, moved, strict=True)
        if any_moved
    }


def _chance(gains: Array) -> float:
    """Probability of a mean gain as large if every recording's could as well have had the other sign.

    All signs up to 14 recordings, 20 000 draws above. Source: Fisher's randomisation test for pairs.
    """
    n = len(gains)
    if n <= _EXACT_FLIPS:
        signs = np.array(list(product((1.0, -1.0), repeat=n)))
    else:
        signs = np.random.default_rng(0).choice((1.0, -1.0), size=(_FLIPS, n))
        signs[0] = 1.0  # what happened is one of the possibilities
    # Sums in another order differ by round-off.
    return float(np.mean(signs @ gains >= gains.sum() - 1e-12 * np.abs(gains).sum()))
