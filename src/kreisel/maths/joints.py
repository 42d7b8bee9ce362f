"""Turns a path into the instants at which a body that follows it may turn, or change its rate, in a step.

These are the zeros of the velocity and of its horizontal part, and the steps of velocity and acceleration.
Between two samples a smooth path can do nothing of the kind unless it is slow there, or unless its derivatives
disagree with each other over the interval; only such intervals are divided, until nothing or an instant is left.
A coarse sampling rate therefore costs a second look and never invents a joint.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.kernels import kernel
from kreisel.maths.tangent import EXACT, Array, Mask, Path, Stillness, instant_at

PARTS = 8
CHUNK = 1024  # intervals divided at once: bounds the memory to 8192 points of the path
# Divisions after which a path counts as too rough to be searched: a joint takes a dozen, twice that when it
# falls on a seam; the constant serves short requests.
PATIENCE, PATIENCE_AT_LEAST = 200, 100_000

NO, KEEP, DIVIDE = 0, 1, 2

# Shares of what the next derivative does over the interval by which velocity (acceleration) may miss the
# trapezoidal rule. A wave sampled 13 times a period misses by (2 pi / 13)^2 / 12 = 0.02.
MISFIT = 0.02
# Smallest steps looked for: 1e-4 rad of direction, 1e-3 rad/s of rate.
TURN, RATE = 1e-4, 1e-3


def suspects(t: Array, v: Array, a: Array, j: Array, still: Stillness = EXACT) -> Mask:
    """Mask (n - 1,) of the intervals between times t that may hold a joint, from v, a and jerk (n, 3) in N."""
    return _verdicts(t, v, a, j, still) != NO


def brackets(path: Path, left: Array, right: Array, still: Stillness = EXACT) -> Array:
    """Instants (m, 2) within the intervals [left, right] (k,) that may be joints, each as its two ends.

    The ends lie a few instants of `still` outside the joint; where the body lingers about rest they enclose that.
    """
    found, work = [np.empty((0, 2))], [(left, right)]
    patience = PATIENCE * len(left) + PATIENCE_AT_LEAST
    while work and patience > 0:
        left, right = work.pop()
        patience -= len(left)
        if len(left) > CHUNK:
            work += [(left[k : k + CHUNK], right[k : k + CHUNK]) for k in range(0, len(left), CHUNK)]
        elif len(left):
            t = np.linspace(left, right, PARTS + 1, axis=1)
            verdicts = _verdicts_of_rows(path, t, still)
            keep, divide = verdicts == KEEP, verdicts == DIVIDE
            found.append(np.stack([t[:, :-1][keep], t[:, 1:][keep]], axis=1))
            work.append((t[:, :-1][divide], t[:, 1:][divide]))
    return _merged(np.concatenate(found), still)


def _verdicts_of_rows(path: Path, t: Array, still: Stillness) -> npt.NDArray[np.uint8]:
    """Verdicts (k, p) on the intervals within each row of t (k, p + 1)."""
    _, v, a, j = path(t.ravel(), 3)
    # Between the end of one row and the start of the next there is no interval.
    return np.append(_verdicts(t.ravel(), v, a, j, still), np.uint8(NO)).reshape(t.shape)[:, :-1]


def _merged(ends: Array, still: Stillness) -> Array:
    """Brackets that touch, or nearly so, as one."""
    if not len(ends):
        return ends
    ends = ends[np.argsort(ends[:, 0])]
    reach = np.maximum.accumulate(ends[:, 1])
    apart = ends[1:, 0] - reach[:-1] > 4.0 * instant_at(reach[:-1], still)
    first, last = np.append(True, apart), np.append(apart, True)
    left, right = ends[first, 0], reach[last]
    return np.stack([left - instant_at(left, still), right + instant_at(right, still)], axis=1)


def _verdicts(t: Array, v: Array, a: Array, j: Array, still: Stillness) -> npt.NDArray[np.uint8]:
    out = np.zeros(max(len(t) - 1, 0), dtype=np.uint8)
    _judge(t, v, a, j, still.speed, still.rate, instant_at(t, still), out)
    return out


@kernel
def _judge(
    t: Array, v: Array, a: Array, j: Array, speed: float, rate: float, instant: Array, out: npt.NDArray[np.uint8]
) -> None:  # fmt: skip
    for k in range(t.shape[0] - 1):
        step = t[k + 1] - t[k]
        verdict = max(
            _zero(k, 2, step, v, a, j, speed, rate, instant[k]),
            _zero(k, 3, step, v, a, j, speed, rate, instant[k]),
            _misfit(k, step, v, a, j, speed, rate, instant[k]),
        )
        out[k] = KEEP if verdict == DIVIDE and step <= 0.25 * instant[k] else verdict


@kernel
def _size(x: Array, k: int, axes: int) -> float:
    squared = x[k, 0] * x[k, 0] + x[k, 1] * x[k, 1]
    return np.sqrt(squared + x[k, 2] * x[k, 2] if axes == 3 else squared)


@kernel
def _at_rest(v: float, a: float, j: float, nil: float, rate: float) -> bool:
    return v <= nil and a <= nil * rate and j <= 2.0 * nil * rate * rate


@kernel
def _zero(
    k: int, axes: int, step: float, v: Array, a: Array, j: Array, speed: float, rate: float, instant: float
) -> int:
    """Whether the first `axes` components of the velocity may vanish together between rows k and k + 1."""
    v0, v1 = _size(v, k, axes), _size(v, k + 1, axes)
    a0, a1 = _size(a, k, axes), _size(a, k + 1, axes)
    j0, j1 = _size(j, k, axes), _size(j, k + 1, axes)
    nil0, nil1 = speed + instant * (a0 + j0 / rate), speed + instant * (a1 + j1 / rate)
    if _at_rest(v0, a0, j0, nil0, rate) and _at_rest(v1, a1, j1, nil1, rate):
        return NO
    most = max(a0, a1)
    if v0 <= nil0 and v1 <= nil1 and most * step <= min(nil0, nil1):
        return KEEP
    # From the nearer end to a zero the speed falls by half a step times the acceleration; half as much again
    # for what acceleration and jerk at the ends do not show.
    reach = 0.75 * step * (most + 0.5 * step * max(j0, j1)) + max(nil0, nil1)
    return DIVIDE if min(v0, v1) <= reach else NO


@kernel
def _misfit(
    k: int, step: float, v: Array, a: Array, j: Array, speed: float, rate: float, instant: float
) -> int:
    """Whether velocity or acceleration may step between rows k and k + 1: the trapezoidal rule fails by more
    than a smooth path would make it."""
    in_v, in_a = 0.0, 0.0
    for i in range(3):
        e = v[k + 1, i] - v[k, i] - 0.5 * step * (a[k, i] + a[k + 1, i])
        in_v += e * e
        e = a[k + 1, i] - a[k, i] - 0.5 * step * (j[k, i] + j[k + 1, i])
        in_a += e * e
    s = min(_size(v, k, 3), _size(v, k + 1, 3))
    most = max(_size(a, k, 3), _size(a, k + 1, 3))
    bend = max(_size(j, k, 3), _size(j, k + 1, 3))
    turns = np.sqrt(in_v) > TURN * s + MISFIT * step * most + speed + instant * (most + bend / rate)
    # Accelerations carry more noise than speeds: a thousand times what would still be a speed.
    yaws = np.sqrt(in_a) > RATE * s + MISFIT * step * bend + 1e-9 * most + 1e3 * speed * rate
    return DIVIDE if turns or yaws else NO
