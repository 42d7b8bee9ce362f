"""Turns noisy samples into a spline with the noise taken out, and finds noise, outliers and jumps on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kreisel.maths.derivatives import UNKNOWN
from kreisel.maths.smoothing.axes import along_axes, spread
from kreisel.maths.smoothing.blocks import Piece
from kreisel.maths.smoothing.joining import joined
from kreisel.maths.smoothing.likelihood import Choice, most_likely, remembering
from kreisel.maths.smoothing.outliers import AROUND, Division, Fit, divide, same
from kreisel.maths.smoothing.system import Samples

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

# Rounds of smoothing and taking out what does not fit; each may find what louder events have hidden.
_ROUNDS = 12

# Standard errors by which both sides of a break must differ, and samples set aside may differ to be taken back.
_JUMPS, _BELONGS = 5.0, 3.5

# A smoothness is looked for again where the level of the noise has changed by this share.
_ANOTHER = 0.1

# Share of a recording that may be rough for the rest of it to tell how its noise is correlated.
_RARELY = 0.025

_ROUND_OFF = 1e-13  # of a sample, after the algebra of a spline


@dataclass(frozen=True, slots=True)
class SmoothSignal:
    """Columns of a signal as splines of time, without the jumps of its samples."""

    fits: tuple[Fit, ...]  # of columns that share their smoothness
    t: Array  # (n,) s, of the samples
    division: Division  # of the samples
    sizes: Array  # (m, c) of the jumps, in the columns as they are after the jumps before
    found: Array  # (groups,) standard deviation of the noise in a dimension as the samples show it

    @property
    def sigma(self) -> Array:
        """(groups,) standard deviation of the noise in a dimension: as given, else as found."""
        return np.array([fit.sigma for fit in self.fits])

    @property
    def spread(self) -> Array:
        """(k,) size of the noise along each axis of the groups, per that of their mean square in a group."""
        return np.concatenate([fit.spread for fit in self.fits])

    @property
    def memory(self) -> Array:
        """(groups,) s, time constant with which the noise forgets; 0 where it is white."""
        return np.array([fit.choice.smoothness.memory for fit in self.fits])

    @property
    def outliers(self) -> Array:
        """(m,) s, samples that were set aside."""
        return self.t[~self.division.kept]

    @property
    def jumps(self) -> Array:
        """(m,) s, halfway between the samples before and after a break."""
        last = [np.flatnonzero(self.division.kept[:k])[-1] for k in self.division.breaks]
        first = [k + np.argmax(self.division.kept[k:]) for k in self.division.breaks]
        return 0.5 * (self.t[last] + self.t[first])

    @property
    def rough(self) -> Array:
        """(m,) s, where the samples are rougher than elsewhere, by neither outliers nor a jump."""
        return self.t[list(self.division.left)]

    @property
    def floor(self) -> Array:
        """As `Signal` has it."""
        return np.asarray(UNKNOWN * np.sqrt(self.variances(self.t, range(1, 2))[0].sum(axis=1)))

    def __call__(self, t: Array, order: int) -> Array:
        """(order + 1, n, c): value and derivatives at increasing times t (n,)."""
        widths = [fit.samples.x.shape[1] for fit in self.fits]
        out = np.empty((order + 1, len(t), sum(widths)))
        for fit, last, width in zip(self.fits, np.cumsum(widths), widths, strict=True):
            fit.pieces[0](t, order, out[:, :, last - width : last])
        return out

    def variances(self, t: Array, orders: range) -> Array:
        """(len(orders), n, groups): variance of these derivatives in one dimension, at increasing times t (n,)."""
        out = np.empty((len(orders), len(t), len(self.fits)))
        for k, fit in enumerate(self.fits):
            fit.pieces[0].variances(t, orders, out[:, :, k])
            out[:, :, k] *= fit.sigma**2
        return out


def smoothing_spline(
    t: Array,
    x: Array,
    *,
    rate: Array | None = None,
    sigma: Array | None = None,
    dimensions: int | None = None,
) -> SmoothSignal:
    """The signal behind samples `x` (n, c) at times `t` (n,) s, as smooth as the samples themselves ask for.

    rate: (n, c) samples of dx/dt where the source has them; their noise level is found as well.
    sigma: standard deviation of the noise where it is known, one number per group of columns.
    dimensions: one smoothness for all columns, whose noise has so many dimensions (three for a unit quaternion's
        four components); where left out every column is a group of its own.
    """
    groups = [slice(None)] if dimensions else [slice(c, c + 1) for c in range(x.shape[1])]
    levels = [None] * len(groups) if sigma is None else [float(s) for s in sigma]
    samples = [
        Samples(t, x[:, g], None if rate is None else rate[:, g], dimensions or 1, level)
        for g, level in zip(groups, levels, strict=True)
    ]
    # A level that is given may be wrong, and the rates of a state estimate know nothing of its corrections.
    fits, purged = _purged([s._replace(rate=None, sigma=None) for s in samples])
    division = _believed(purged)
    whole, sizes = division._replace(breaks=()), np.zeros((0, x.shape[1]))
    if division.breaks:
        pairs = [joined(s, fit.choice, division) for s, fit in zip(samples, fits, strict=True)]
        samples, sizes = [s for s, _ in pairs], np.concatenate([size for _, size in pairs], axis=1)
    if purged.breaks or rate is not None:
        fits = [_searched(s._replace(sigma=None), whole) for s in samples]
    # A motion that is rough, if only now and then, looks like noise that lasts.
    if len(division.left) * AROUND < _RARELY * len(t):
        fits = [_remembering(fit, whole) for fit in fits]
    found = np.array([fit.sigma for fit in fits])
    if sigma is not None:
        fits = [_given(s, whole, fit) for s, fit in zip(samples, fits, strict=True)]
    return SmoothSignal(tuple(fits), t, division, sizes, found)


def _given(samples: Samples, division: Division, found: Fit) -> Fit:
    """A fit to samples whose noise is given; it remembers as long as what was found."""
    segments = division.segments(samples)
    choice = most_likely(segments, found.choice.smoothness.memory)
    return _fit(samples, segments, choice)


def _purged(samples: Sequence[Samples]) -> tuple[list[Fit], Division]:
    """Fits to what belongs to a recording, behind white noise, and what that is."""
    division = Division(np.ones(len(samples[0].t), dtype=np.bool_))
    # Noise is taken for white until the outliers are gone: an outlier is correlated with nothing.
    fits = [_searched(s, division) for s in samples]
    for _ in range(_ROUNDS):
        after = _confirmed(fits, division)
        for change in (divide, _taken_back):
            after = change(fits, after) if same(after, division) else after
        changed, division = not same(after, division), after
        if not changed:
            break
        fits = [_again(fit, division) for fit in fits]
    return fits, division


def _believed(division: Division) -> Division:
    """`division` itself, or without its breaks where the path is rough at more places than it jumps at.

    Rough all along, it has a noise of another kind than jumps are measured by, and moving whole parts by what may be
    the motion does more harm than a jump that is smoothed over. Such places are told as rough ones.
    """
    if len(division.left) <= len(division.breaks):
        return division
    return division._replace(breaks=(), left=tuple(sorted(division.left + division.breaks)))


def _searched(samples: Samples, division: Division) -> Fit:
    segments = division.segments(samples)
    return _fit(samples, segments, most_likely(segments))


def _again(fit: Fit, division: Division) -> Fit:
    """`fit` to another part of the samples; as smooth as before where the noise is the same."""
    same = _fit(fit.samples, division.segments(fit.samples), fit.choice)
    if abs(same.sigma / fit.sigma - 1.0) < _ANOTHER:
        return same
    return _searched(fit.samples, division)


def _remembering(fit: Fit, division: Division) -> Fit:
    """`fit` itself, or one with correlated noise where that is clearly more likely."""
    segments = division.segments(fit.samples)
    choice = remembering(segments, fit.choice)
    return fit if choice == fit.choice else _fit(fit.samples, segments, choice)


def _fit(samples: Samples, segments: Sequence[Samples], choice: Choice) -> Fit:
    pieces = tuple(Piece(segment, choice) for segment in segments)
    away = [
        along_axes(value, piece.samples.x + piece.centre - value)
        for piece, value in zip(pieces, map(_values, pieces), strict=True)
    ]
    # What does not move at all has no noise but round-off.
    least = _ROUND_OFF * float(np.abs(samples.x).max()) + 1e-100
    sigma = samples.sigma or max(_level(pieces), least)
    return Fit(samples, choice, pieces, sigma, spread(np.concatenate(away)))


def _values(piece: Piece) -> Array:
    """(n, c) at the samples of a piece."""
    value = np.empty((1, *piece.samples.x.shape))
    piece(piece.samples.t, 0, value)
    return np.asarray(value[0])


def _level(pieces: Sequence[Piece]) -> float:
    """Standard deviation of the noise as the samples show it."""
    free = sum(piece.samples.degrees_of_freedom for piece in pieces)
    return float(np.sqrt(sum(piece.energy for piece in pieces) / free))


def _confirmed(fits: Sequence[Fit], division: Division) -> Division:
    """`division` without breaks at which both sides meet: a corner of the path is no jump."""
    jumps = [
        any(_jumps(fit.pieces[k], fit.pieces[k + 1], fit.sigma) for fit in fits)
        for k in range(len(division.breaks))
    ]
    meet = tuple(place for place, is_jump in zip(division.breaks, jumps, strict=True) if not is_jump)
    stay = tuple(place for place in division.breaks if place not in meet)
    return division._replace(breaks=stay, met=division.met + meet)


def _jumps(before: Piece, after: Piece, sigma: float) -> bool:
    """Whether two pieces differ at every time near the break; where a path bends they meet."""
    ends = before.samples.t[-2:], after.samples.t[:2]
    t = np.append(np.linspace(ends[0][0], ends[1][1], 400), 0.5 * (ends[0][1] + ends[1][0]))
    order = np.argsort(t)
    values, variances = np.empty((2, 1, len(t), len(before.centre))), np.empty((2, 1, len(t)))
    for piece, value, variance in zip((before, after), values, variances, strict=True):
        piece(t[order], 0, value)
        piece.variances(t[order], range(1), variance)
    # Beyond its end a piece soon knows nothing: what is known halfway decides.
    halfway = variances.sum(axis=(0, 1))[np.argmax(order)]
    return bool(np.linalg.norm(values[1, 0] - values[0, 0], axis=1).min() > _JUMPS * sigma * np.sqrt(halfway))


def _taken_back(fits: Sequence[Fit], division: Division) -> Division:
    """`division` with those samples back that fit after all."""
    kept = division.kept.copy()
    for k, (a, b) in enumerate(division.edges):
        away = a + np.flatnonzero(~division.kept[a:b])
        if away.size:
            kept[away] = np.all([_fits(fit, fit.pieces[k], away) for fit in fits], axis=0)
    return division._replace(kept=kept)


def _fits(fit: Fit, piece: Piece, rows: Indices) -> Mask:
    """Which of the samples `rows` are as near to a piece as noise is."""
    t, x = fit.samples.t[rows], fit.samples.x[rows]
    value, variance = np.empty((1, *x.shape)), np.empty((1, len(t)))
    piece(t, 0, value)
    piece.variances(t, range(1), variance)
    # Where next to nothing is known everything fits.
    known = np.sqrt(1.0 + np.minimum(variance[0], 1.0))
    away = np.abs(along_axes(value[0], x - value[0])) / (fit.sigma * fit.spread)
    return np.asarray(away.max(axis=1) < _BELONGS * known)
