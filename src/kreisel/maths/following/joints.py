"""Turns a path into the instants at which a body that follows it may turn, or change its rate, in a step.

These are the zeros of the velocity and of its horizontal part, and the steps of velocity and acceleration.
Between two samples a smooth path can do nothing of the kind unless it is slow there, or unless its
derivatives disagree with each other over the interval; only such intervals are divided, until nothing or an
instant is left.
A coarse sampling rate therefore costs a second look and never invents a joint.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from kreisel.maths.following.tangent import EXACT, Array, Mask, Path, Stillness, instant_at
from kreisel.maths.kernels import argument, kernel

PARTS = 8
CHUNK = 1024  # intervals divided at once: bounds the memory to 8192 points of the path
# Divisions after which a path counts as too rough to be searched: a joint takes a dozen, twice that when it
# falls on a seam; the constant serves short requests.
PATIENCE, PATIENCE_AT_LEAST = 200, 100_000

NO, KEEP, DIVIDE = 0, 1, 2
Verdicts = npt.NDArray[np.uint8]

Sizes = tuple[float, float, float]
"""Of velocity, acceleration and jerk."""

# Shares of what the next derivative does over the interval by which velocity (acceleration) may miss the
# trapezoidal rule. A wave sampled 13 times a period misses by (2 pi / 13)^2 / 12 = 0.02.
MISFIT = 0.02
# Smallest steps looked for: 1e-4 rad of direction, 1e-3 rad/s of rate.
TURN, RATE = 1e-4, 1e-3


def suspects(t: Array, v: Array, a: Array, j: Array, still: Stillness = EXACT) -> Mask:
    """Mask (n - 1,) of the intervals between times t that may hold a joint, from v, a, jerk (n, 3) in N."""
    return np.not_equal(_verdicts(t, v, a, j, still), NO)


def brackets(path: Path, left: Array, right: Array, still: Stillness = EXACT) -> Array:
    """Instants (m, 2) within the intervals [left, right] (k,) that may be joints, each as its two ends.

    The ends lie a few instants of `still` outside the joint; where the body lingers about rest they enclose
    that.
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


def _verdicts_of_rows(path: Path, t: Array, still: Stillness) -> Verdicts:
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


def _verdicts(t: Array, v: Array, a: Array, j: Array, still: Stillness) -> Verdicts:
    out = np.zeros(max(len(t) - 1, 0), dtype=np.uint8)
    inputs = argument(t), argument(v), argument(a), argument(j)
    _judge(*inputs, still.speed, still.rate, still.instant, out)
    return out


@kernel
def _judge(
    t: Array, v: Array, a: Array, j: Array, speed: float, rate: float, instant: float, out: Verdicts
) -> None:
    if t.shape[0] == 0:
        return
    flat0, full0 = _sizes(v, a, j, 0)
    for k in range(1, t.shape[0]):
        flat1, full1 = _sizes(v, a, j, k)
        step, now = t[k] - t[k - 1], instant + 8.9e-16 * abs(t[k])
        verdict = max(
            _zero(flat0, flat1, step, speed, rate, now), _zero(full0, full1, step, speed, rate, now)
        )
        if verdict != DIVIDE and _misfit(k, v, a, j, full0, full1, step, speed, rate, now):
            verdict = DIVIDE
        out[k - 1] = KEEP if verdict == DIVIDE and step <= 0.25 * now else verdict
        flat0, full0 = flat1, full1


@kernel
def _sizes(v: Array, a: Array, j: Array, k: int) -> tuple[Sizes, Sizes]:
    """Of the horizontal parts and of the whole vectors."""
    fv, fa = v[k, 0] * v[k, 0] + v[k, 1] * v[k, 1], a[k, 0] * a[k, 0] + a[k, 1] * a[k, 1]
    fj = j[k, 0] * j[k, 0] + j[k, 1] * j[k, 1]
    wv, wa, wj = fv + v[k, 2] * v[k, 2], fa + a[k, 2] * a[k, 2], fj + j[k, 2] * j[k, 2]
    return (np.sqrt(fv), np.sqrt(fa), np.sqrt(fj)), (np.sqrt(wv), np.sqrt(wa), np.sqrt(wj))


@kernel
def _zero(here: Sizes, there: Sizes, step: float, speed: float, rate: float, instant: float) -> int:
    """Whether the velocity may vanish within a step, from the sizes at both ends."""
    nil0, nil1 = speed + instant * (here[1] + here[2] / rate), speed + instant * (there[1] + there[2] / rate)
    most = max(here[1], there[1])
    # From the nearer end to a zero the speed falls by half a step times the acceleration; half as much again
    # for what acceleration and jerk at the ends do not show.
    reach = 0.75 * step * (most + 0.5 * step * max(here[2], there[2])) + max(nil0, nil1)
    if min(here[0], there[0]) > reach or (_at_rest(here, nil0, rate) and _at_rest(there, nil1, rate)):
        return NO
    lingers = here[0] <= nil0 and there[0] <= nil1 and most * step <= min(nil0, nil1)
    return KEEP if lingers else DIVIDE


@kernel
def _at_rest(sizes: Sizes, nil: float, rate: float) -> bool:
    return sizes[0] <= nil and sizes[1] <= nil * rate and sizes[2] <= 2.0 * nil * rate * rate


@kernel
def _misfit(
    k: int, v: Array, a: Array, j: Array, here: Sizes, there: Sizes, step: float, speed: float, rate: float,
    instant: float,
) -> bool:  # fmt: skip
    """Whether velocity or acceleration may step before row k: more than a smooth path breaks the trapezoidal
    rule."""
    in_v, in_a = 0.0, 0.0
    for i in range(3):
        e = v[k, i] - v[k - 1, i] - 0.5 * step * (a[k, i] + a[k - 1, i])
        in_v += e * e
        e = a[k, i] - a[k - 1, i] - 0.5 * step * (j[k, i] + j[k - 1, i])
        in_a += e * e
    slow, most, bend = min(here[0], there[0]), max(here[1], there[1]), max(here[2], there[2])
    turns = TURN * slow + MISFIT * step * most + speed + instant * (most + bend / rate)
    # Accelerations carry more noise than speeds: a thousand times what would still be a speed.
    yaws = RATE * slow + MISFIT * step * bend + 1e-9 * most + 1e3 * speed * rate
    return in_v > turns * turns or in_a > yaws * yaws
