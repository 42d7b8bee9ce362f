"""Turns two attitudes of one body into the constant offsets between them: heading, frame, sensor, clock.

The estimate is taken to be ``R_est(t + clock) = Exp(frame_N) R_true(t) Exp(sensor_S)`` and an error that
changes. The turns found make the mean square of that error, as an angle, least; the clock found is the one
at which the error no longer goes with the rate of turn.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from kreisel.data.checks import Array, read_only
from kreisel.maths.rotations import exp_so3, geodesic, log_so3, nearest_rotation

KINDS = ("heading", "frame", "frame+sensor")

# A stamp this close to another is the same instant: epochs come in whole nanoseconds.
_SAME_INSTANT = 0.5e-9  # s

# Share of the mean square of direction below which turning about two axes cannot be told from none: it is
# reached by 0.8 deg of rms rotation.
_TOO_STILL = 1e-4

# rad/s: a rate that varies less tells time no better than its noise does.
_TOO_STEADY = 1e-3

# s: differences over less are mostly noise in attitudes that carry any.
_CALM = 0.02

_PASSES = 30
_SETTLED = 1e-14  # rad or s: round-off

# Samples by which the clock may move from its rough value while it is fitted.
_MARGIN = 5


class Track(NamedTuple):
    """Attitudes on a clock of seconds."""

    t: Array  # (n,) s, increasing
    R: Array  # (n, 3, 3)


@dataclass(frozen=True, slots=True, eq=False)
class Offsets:
    """What is taken off an estimate before it is compared: nothing, as it comes."""

    frame_N: Array = field(default_factory=lambda: np.zeros(3))  # (3,) rad, rotation vector
    sensor_S: Array = field(default_factory=lambda: np.zeros(3))  # (3,) rad, rotation vector
    clock: float = 0.0  # s, by which the estimate's stamps are ahead

    def __post_init__(self) -> None:
        object.__setattr__(self, "frame_N", read_only(self.frame_N))
        object.__setattr__(self, "sensor_S", read_only(self.sensor_S))


def overlap(truth_t: Array, estimate_t: Array, clock: float = 0.0) -> tuple[int, int]:
    """First and one past the last row of `truth_t` that lie inside `estimate_t`, whose stamps are ahead."""
    first = np.searchsorted(truth_t, estimate_t[0] - clock - _SAME_INSTANT)
    return int(first), int(np.searchsorted(truth_t, estimate_t[-1] - clock + _SAME_INSTANT, side="right"))


def errors_after(truth: Track, estimate: Track, offsets: Offsets) -> Array:
    """dtheta_N (n, 3) rad with Exp(dtheta_N) R_true = the estimate at the truth's stamps, less `offsets`.

    Between two samples of the estimate its rotation is taken at constant rate (geodesic).
    """
    return log_so3(corrected(truth.t, estimate, offsets) @ np.swapaxes(truth.R, -1, -2))


def corrected(t: Array, estimate: Track, offsets: Offsets) -> Array:
    """Attitude (n, 3, 3) of the estimate at the truth's stamps t (n,) s, less `offsets`."""
    R = _at(estimate, t + offsets.clock)
    if offsets.sensor_S.any():
        R = R @ exp_so3(-offsets.sensor_S)
    return exp_so3(-offsets.frame_N) @ R if offsets.frame_N.any() else R


def _at(track: Track, t: Array) -> Array:
    """Attitude (m, 3, 3) at `t`, inside the track but for round-off."""
    last = len(track.t) - 1
    same = np.minimum(np.searchsorted(track.t, t - _SAME_INSTANT), last)
    if (np.abs(track.t[same] - t) <= _SAME_INSTANT).all():
        return track.R[same]
    after = np.clip(np.searchsorted(track.t, t), 1, last)
    share = (t - track.t[after - 1]) / (track.t[after] - track.t[after - 1])
    return geodesic(track.R[after - 1], track.R[after], np.clip(share, 0.0, 1.0))


def fit(truth: Track, estimate: Track, kind: str | None, clock: float | None) -> Offsets:
    """The offsets of `kind` that leave the least mean square error; a `clock` of None is fitted too.

    truth : the samples that count.
    Raises ValueError where the motion does not show an offset that was asked for.
    """
    if clock is not None:
        return Offsets(clock=clock) if kind is None else _fitted(truth, estimate, kind, clock, False)
    # A constant turn of the frame would pass for a shift in time on a body that keeps turning: fitted too.
    clock = _rough_clock(truth, estimate)
    whole = _fitted(truth, estimate, kind if kind == "frame+sensor" else "frame", clock, True)
    return whole if kind == "frame+sensor" else fit(truth, estimate, kind, whole.clock)


def _fitted(truth: Track, estimate: Track, kind: str, clock: float, fit_clock: bool) -> Offsets:
    """Gauss-Newton on the errors as rotation vectors, from a start in closed form."""
    seen = _inside(truth, estimate, clock, _MARGIN * _rough_step(truth, estimate) if fit_clock else 0.0)
    best = offsets = _start(seen, estimate, kind, clock)
    least = np.inf
    for _ in range(_PASSES):
        error = errors_after(seen, estimate, offsets)
        square = float(np.mean(error * error))
        if square > least and not fit_clock:
            break
        least, best = square, offsets
        step = _step(_design(seen, kind, fit_clock), error)
        if np.abs(step).max() < _SETTLED:
            break
        offsets = _moved(offsets, kind, step)
    return best


def _inside(truth: Track, estimate: Track, clock: float, margin: float) -> Track:
    """The samples that stay inside the estimate while its clock moves by less than `margin`."""
    if margin:
        keep = np.searchsorted(estimate.t, estimate.t[[0, -1]] + [margin, -margin])
        estimate = Track(estimate.t[keep[0] : keep[1] + 1], estimate.R[keep[0] : keep[1] + 1])
    first, end = overlap(truth.t, estimate.t, clock) if len(estimate.t) else (0, 0)
    if end == first:
        raise ValueError(
            "nothing to align: no sample of the truth that counts lies inside the estimate"
            f" with a clock offset of {clock:.6g} s."
        )
    return Track(truth.t[first:end], truth.R[first:end])


def _start(truth: Track, estimate: Track, kind: str, clock: float) -> Offsets:
    """Closed forms that need no first guess: nearest rotation to a sum of matrices (Wahba's problem)."""
    R_est = _at(estimate, truth.t + clock)
    sensor = _sensor_from_turns(truth.R, R_est) if kind == "frame+sensor" else np.eye(3)
    total = np.sum(R_est @ sensor.T @ np.swapaxes(truth.R, -1, -2), axis=0)
    if kind == "heading":
        turn = np.arctan2(total[1, 0] - total[0, 1], total[0, 0] + total[1, 1])
        return Offsets(np.array([0.0, 0.0, turn]), clock=clock)
    return Offsets(log_so3(nearest_rotation(total)), log_so3(sensor), clock)


def _sensor_from_turns(R_true: Array, R_est: Array) -> Array:
    """Exp(sensor_S), from turns over half the record: as rotation vectors they differ by it alone."""
    half = (len(R_true) + 1) // 2
    turns_true = log_so3(np.swapaxes(R_true[:-half], -1, -2) @ R_true[half:])
    turns_est = log_so3(np.swapaxes(R_est[:-half], -1, -2) @ R_est[half:])
    return nearest_rotation(turns_true.T @ turns_est)


def _design(truth: Track, kind: str, fit_clock: bool) -> Array:
    """d error / d offset (n, 3, parameters).

    The rate is the truth's. With the estimate's own, noise would draw the clock to the middle between two
    samples, where interpolation averages it away.
    """
    eye = np.broadcast_to(np.eye(3), truth.R.shape)
    columns = [eye[:, :, 2:] if kind == "heading" else eye]
    if kind == "frame+sensor":
        columns.append(truth.R)
        if np.linalg.norm(np.mean(truth.R, axis=0), 2) > 1.0 - _TOO_STILL:
            raise ValueError(
                "align='frame+sensor' needs rotation about two axes; this motion turns about one at most. "
                "Use align='frame'."
            )
    if fit_clock:
        rate = _central_rate_N(truth)
        if np.sqrt(np.mean(np.var(rate, axis=0))) < _TOO_STEADY:
            raise ValueError(_STEADY)
        columns.append(-rate[:, :, None])
    return np.concatenate(columns, axis=2)


_STEADY = (
    "clock_offset='estimate' needs a rate of turn that changes; this motion's does not. "
    "Give the offset in seconds."
)


def _central_rate_N(track: Track) -> Array:
    """Rate (n, 3) rad/s in N between the neighbours of each sample."""
    n = np.arange(len(track.t))
    before, after = np.maximum(n - 1, 0), np.minimum(n + 1, len(n) - 1)
    turn = log_so3(track.R[after] @ np.swapaxes(track.R[before], -1, -2))
    return turn / (track.t[after] - track.t[before])[:, None]


def _step(design: Array, error: Array) -> Array:
    flat = design.reshape(-1, design.shape[2])
    return np.asarray(np.linalg.lstsq(flat, error.ravel())[0], dtype=np.float64)


def _moved(offsets: Offsets, kind: str, step: Array) -> Offsets:
    frame = np.array([0.0, 0.0, step[0]]) if kind == "heading" else step[:3]
    frame_N = log_so3(exp_so3(offsets.frame_N) @ exp_so3(frame))
    sensor_S, rest = offsets.sensor_S, step[1 if kind == "heading" else 3 :]
    if kind == "frame+sensor":
        sensor_S, rest = log_so3(exp_so3(rest[:3]) @ exp_so3(sensor_S)), rest[3:]
    return Offsets(frame_N, sensor_S, offsets.clock + (float(rest[0]) if rest.size else 0.0))


def _rough_clock(truth: Track, estimate: Track) -> float:
    """Clock offset to the nearest step, from how fast each turns: that needs no common frame."""
    if min(len(truth.t), len(estimate.t)) < 3:
        raise ValueError(_STEADY)
    step = _rough_step(truth, estimate)
    if min(truth.t[-1] - truth.t[0], estimate.t[-1] - estimate.t[0]) < 3.0 * step:
        raise ValueError(_STEADY)
    a, b = _speed(truth, step), _speed(estimate, step)
    if min(a.std(), b.std()) < _TOO_STEADY:
        raise ValueError(_STEADY)
    from scipy.signal import correlate

    # Not divided by how many samples meet: of two that match alike, the longer overlap is the likelier.
    lag = int(np.argmax(correlate(b - b.mean(), a - a.mean(), mode="full"))) - (len(a) - 1)
    return lag * step + float(estimate.t[0] - truth.t[0])


def _rough_step(truth: Track, estimate: Track) -> float:
    steps = [float(np.median(np.diff(track.t))) for track in (truth, estimate)]
    return max(*steps, _CALM)


def _speed(track: Track, step: float) -> Array:
    """abs(rate) on a regular grid."""
    t = np.arange(track.t[0], track.t[-1], step)
    return np.asarray(np.linalg.norm(_central_rate_N(Track(t, _at(track, t))), axis=1))
