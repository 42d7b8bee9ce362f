"""Turns samples of a motion, with their noise, gaps and mistakes, into signals, and into notes on what was done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.data.motion import Note
from kreisel.data.smoothing import Smoothing
from kreisel.maths.derivatives import SECOND_DERIVATIVE_GAIN, Signal, interpolating_spline, noise_level

if TYPE_CHECKING:
    from kreisel.maths.smoothing import SmoothSignal

Mask = npt.NDArray[np.bool_]

# Interpolating is as good as the samples when their noise stays under a tenth of a milli-g in the
# acceleration (and 1e-3 rad/s^2 in the angular one): an accelerometer's own noise hides it.
CLEAN_BELOW = 1e-3

FEWEST_SMOOTH = 20
"""Samples below which a smoother has nothing to average."""

# A step counts as a gap when it is longer than this many times what nine in ten steps stay below.
_A_GAP = 2.5

# rad; no measured attitude is this bad, but attitudes that turn by more from sample to sample look like it.
_NO_NOISE = np.deg2rad(2.0)

# Attitudes in a row, each turned by more than 120 deg against the one before, that are taken for outliers.
_A_FEW = 6

_NAMED = 5  # times in one note


class Columns(NamedTuple):
    """Samples of one kind, and how they are to be taken."""

    what: str  # "positions" or "attitudes"
    t: Array  # (n,) s
    x: Array  # (n, 3) m, or sign-continuous unit quaternions (n, 4)
    method: str
    noise: Array | None  # (3,) m or rad, where it is given
    rate: Array | None = None  # (n, 3) of dx/dt, where the source has it

    @property
    def rotations(self) -> bool:
        """Whether these are attitudes."""
        return self.x.shape[1] == 4


@dataclass(frozen=True, eq=False)
class Behind:
    """The signal behind samples."""

    signal: Signal
    t: Array  # (n,) s, of the samples
    notes: tuple[Note, ...]
    smoothing: Smoothing | None = None  # None where the samples were interpolated

    def variances(self, times: Array, orders: range) -> Array:
        """(len(orders), n, 3) of derivatives of position (m^2, ...) or of rotations about B's axes (rad^2, ...)."""
        if self.smoothing is None:
            return np.zeros((len(orders), len(times), 3))
        smooth: SmoothSignal = self.signal  # type: ignore[assignment]
        found = smooth.variances(times, orders)
        if found.shape[2] == 3:
            return found
        # A unit quaternion carries half the rotation angle.
        return np.stack([4.0 * v * self._shares(order) for v, order in zip(found, orders, strict=True)])

    def _shares(self, order: int) -> Array:
        """(3,) of the mean variance: noise differs from axis to axis, what the smoothing itself loses does not."""
        from kreisel.maths.smoothing import lost_share

        assert self.smoothing is not None
        squares, lost = np.square(self.smoothing.sigma), lost_share(order)
        return (1.0 - lost) * squares / squares.mean() + lost


def known_rows(x: Array) -> Mask:
    """(n,) rows without NaN; an infinite number is no missing sample."""
    return np.asarray(~np.isnan(x.reshape(len(x), -1)).any(axis=1))


def gaps(what: str, t: Array, max_gap: float) -> Array:
    """(m, 2) s, begin and end of steps between samples at `t` that are much longer than the others.

    Raises ValueError for one longer than `max_gap` s.
    """
    steps = np.diff(t)
    k = np.flatnonzero(steps > _A_GAP * np.quantile(steps, 0.9))
    long = k[steps[k] > max_gap]
    if long.size:
        a, b = t[long[0]], t[long[0] + 1]
        raise ValueError(
            f"there are no {what} from t = {a:.9g} to {b:.9g} s; gaps of up to {max_gap:g} s are bridged. "
            f"Cut the recording there, or give max_gap={np.ceil(100.0 * (b - a)) / 100.0:g} (--max-gap) and "
            "have what happened there guessed."
        )
    return np.stack([t[k], t[k + 1]], axis=1)


def behind(columns: Columns, bridged: Array) -> Behind:
    """The signal behind samples; `bridged` (m, 2) s are their gaps."""
    bridges = tuple(
        Note("gap", f"no {columns.what} for {b - a:.2g} s: bridged", float(a)) for a, b in bridged
    )
    if _to_be_smoothed(columns):
        smooth = _smooth(columns)
        smoothing = _smoothing(columns, smooth)
        notes = (_level_note(columns, smoothing), *bridges, *_event_notes(columns, smooth))
        return Behind(smooth, columns.t, notes, smoothing)
    note = Note("method", f"{columns.what} interpolated: no noise to speak of")
    return Behind(interpolating_spline(columns.t, columns.x), columns.t, (note, *bridges))


def _to_be_smoothed(columns: Columns) -> bool:
    if columns.method != "auto":
        return columns.method == "smooth"
    if columns.noise is not None:
        return True
    sigma = float(np.max(noise_level(columns.t, columns.x)))
    step = float(np.median(np.diff(columns.t)))
    return SECOND_DERIVATIVE_GAIN * sigma / step**2 > CLEAN_BELOW and len(columns.t) >= FEWEST_SMOOTH


def _smooth(columns: Columns) -> SmoothSignal:
    # Loaded here: its algebra costs half a second that clean samples need not wait for.
    from kreisel.maths.smoothing import smoothing_spline

    if not columns.rotations:
        return smoothing_spline(columns.t, columns.x, rate=columns.rate, sigma=columns.noise)
    sigma = None if columns.noise is None else 0.5 * np.sqrt(np.mean(np.square(columns.noise), keepdims=True))
    return smoothing_spline(columns.t, _untangled(columns.x), sigma=sigma, dimensions=3)


def _untangled(q: Array) -> Array:
    """Quaternions (n, 4) whose sign does not turn where one of them, or a few, are far off all others."""
    near = np.sum(q[1:] * q[:-1], axis=1) > 0.5
    far = 1 + np.flatnonzero(~near)
    signs = np.ones(len(q))
    for run in np.split(far, np.flatnonzero(np.diff(far) > 1) + 1) if far.size else ():
        # From the last before those that are off to the first after them.
        if len(run) <= _A_FEW and q[run[-1]] @ q[run[0] - 1] < 0.0:
            signs[run[-1] :] *= -1.0
    return q * signs[:, None]


def _smoothing(columns: Columns, smooth: SmoothSignal) -> Smoothing:
    found, memory = smooth.found, np.broadcast_to(smooth.memory, 3)
    if columns.rotations:
        found = 2.0 * found * smooth.spread
    sigma = found if columns.noise is None else columns.noise
    return Smoothing(sigma, found, memory, smooth.outliers, smooth.jumps, smooth.rough)


# --- notes ---


def _level_note(columns: Columns, smoothing: Smoothing) -> Note:
    helped = " with the velocities given" if columns.rate is not None else ""
    found = _readable(smoothing.found, columns.rotations)
    if columns.noise is None:
        text = f"{columns.what} smoothed{helped}: noise of {found} found"
    else:
        given = _readable(columns.noise, columns.rotations)
        text = f"{columns.what} smoothed{helped} for noise of {given}; they show {found}"
    if smoothing.memory.any():
        text += f", correlated over {_numbers(1e3 * smoothing.memory)} ms"
    if columns.rotations and columns.noise is None and smoothing.found.max() > _NO_NOISE:
        text += "; if that is motion, the samples are too far apart to show it"
    return Note("method", text)


def _readable(level: Array, angle: bool) -> str:
    return f"{_numbers(np.rad2deg(level))} deg" if angle else f"{_numbers(1e3 * level)} mm"


def _numbers(x: Array) -> str:
    """One number where all are alike, else three."""
    if x.max() <= 1.25 * x.min():
        return f"{np.sqrt(np.mean(np.square(x))):.2g}"
    return " / ".join(f"{value:.2g}" for value in x)


def _event_notes(columns: Columns, smooth: SmoothSignal) -> Sequence[Note]:
    what, notes = columns.what, []
    if smooth.outliers.size:
        text = (
            f"{smooth.outliers.size} of {len(columns.t)} {what} do not fit and were set aside, "
            f"at t = {_times(smooth.outliers)} s"
        )
        notes.append(Note("outlier", text, float(smooth.outliers[0])))
    for t, jump in zip(smooth.jumps, smooth.sizes, strict=True):
        size = float(np.linalg.norm(jump))
        angle = np.rad2deg(4.0 * np.arcsin(min(1.0, 0.5 * size)))
        by = f"{angle:.2g} deg" if columns.rotations else f"{1e3 * size:.2g} mm"
        text = f"{what} jump by {by} between two samples: taken for a mistake, the parts are joined to the longest"
        notes.append(Note("jump", text, float(t)))
    for t in smooth.rough:
        text = (
            f"{what} are rougher around here than elsewhere: they are smoothed over, "
            "and known less well than the standard errors say"
        )
        notes.append(Note("rough", text, float(t)))
    return notes


def _times(t: Array) -> str:
    return ", ".join(f"{x:.6g}" for x in t[:_NAMED]) + (" and later" if len(t) > _NAMED else "")
