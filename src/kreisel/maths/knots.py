"""Turns samples into the rate of the knots that they were interpolated between, where they were."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import Array

_BLOCK = 512  # triples among which there must be straight ones and bends
_MOST = 16384  # triples looked at: over more of them two clocks come apart
_FEWEST = 100

# A triple of noisy samples that bends by so little of what is usual is straight: one in 1e5 by chance.
_STRAIGHT = 0.02
# Where bends are few steps of a file's last decimal, samples are straight for their rounding.
_RESOLVED = 20.0

# A path that comes back to the same straight spot again and again has all rates in common with it, each a little.
_LEAST_SHARE = 0.05
# Of the most that straight triples can have in common with a rate: knots reach 0.64 to 1. A camera's poses that an
# IMU carries on in between, rounded to micrometres, reach a fifth.
_COMMON = 0.5
_SIGMAS = 6.0


def knot_rate(t: Array, x: Array) -> float | None:
    """How many times a second samples x (n, 3) at t (n,), s, turn from one straight line onto the next, if they do.

    Three neighbours between two knots lie on a line to round-off, which measured ones do not, and those that do
    recur at the rate of the knots. Found are even rates up to 0.47 of that of the samples; None where there is none.
    """
    if len(t) < _FEWEST:
        return None
    step = float(np.median(np.diff(t)))
    places, straight = _marked(np.rint((t - t[0]) / step).astype(np.int64), x)
    share = float(straight.mean()) if len(straight) >= _FEWEST else 0.0
    if share < _LEAST_SHARE:
        return None
    marks = np.zeros(int(places[-1] - places[0]) + 1)
    marks[places - places[0]] = straight - share
    common = np.abs(np.fft.rfft(marks)) / len(places)
    best = _peak(common, 1.0 - share)
    chance = _SIGMAS * np.sqrt(share * (1.0 - share) / len(places))
    if common[best] < max(_COMMON * min(share, 1.0 - share), chance):
        return None
    return best / (len(marks) * step)


def _peak(common: Array, bent: float) -> int:
    """Where most is common among the rates that so many bent triples allow: a knot bends two, or its own alone."""
    most = 2.0 * (len(common) - 1)
    # Where a path is all but straight its bends are missed, a few in a hundred.
    first, last = max(1, int(0.475 * bent * most)), int(1.2 * bent * most)
    allowed = common[first : last + 1]
    # Overtones of a pulse are nearly as strong as its rate, which is the lowest.
    return first + int(np.argmax(allowed >= 0.9 * allowed.max())) if len(allowed) else 0


def _marked(places: npt.NDArray[np.int64], x: Array) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
    """Places (m,) of the middles of triples, and which (m,) are straight, where both kinds are near."""
    even = (places[2:] - places[1:-1] == 1) & (places[1:-1] - places[:-2] == 1)
    triples = np.flatnonzero(even & (x[2:] != x[:-2]).any(axis=1))
    bends = (x[2:] - 2.0 * x[1:-1] + x[:-2])[triples]
    rounding = 16.0 * np.finfo(np.float64).eps * float(np.abs(x).max())
    resolved = _resolution(x)
    size = np.linalg.norm(bends, axis=1)
    straight = np.zeros(len(triples), dtype=np.bool_)
    kept = [np.zeros(0, dtype=np.intp)]
    for block in np.array_split(np.arange(len(triples)), max(1, len(triples) // _BLOCK)):
        usual = float(np.sqrt(np.mean(size[block] ** 2))) if len(block) else 0.0
        straight[block] = size[block] <= _STRAIGHT * usual + rounding
        if 0 < straight[block].sum() < len(block) and usual > _RESOLVED * resolved:
            kept.append(block)
    chosen = np.concatenate(kept)[:_MOST]
    middles = places[1:-1][triples][chosen]
    # A gap of years must not ask for its length in memory.
    near = middles - middles[:1] < 16 * _MOST
    return middles[near], straight[chosen][near]


def _resolution(x: Array) -> float:
    """Step of the decimals, nine at most, or of the single precision that `x` is given in; 0 where of neither."""
    for decimals in range(10):
        if np.abs(np.round(x, decimals) - x).max() <= 1e-12:
            return float(10.0**-decimals)
    single = np.array_equal(x.astype(np.float32), x)
    return float(np.finfo(np.float32).eps * np.abs(x).max()) if single else 0.0
