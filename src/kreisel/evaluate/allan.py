"""Turns a recording at rest into its Allan deviation, and that into white noise N, bias instability B, random walk K.

Coefficients are those of IEEE Std 952: the Allan variance is N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3. They are
those that make the record likeliest, not a fit to the curve; docs/decisions/0036 says why.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kreisel.data.cards import Card, Shown
from kreisel.data.checks import Array, as_array, choice, finite, instance, read_only, scalar
from kreisel.data.noise import NoiseModel
from kreisel.data.recording import SOURCE, ImuRecording
from kreisel.evaluate.noise_units import COEFFICIENT
from kreisel.maths.allan import Sizes, overlapping_variances, terms, variance_forms
from kreisel.maths.noise_likelihood import likeliest, lower_end, powers, upper_end, without

SENSORS = ("gyro", "accel", "mag")
TERMS = ("N", "B", "K")

# Fewer leave no two cluster sizes to tell slopes by.
_FEWEST = 32

# Clusters longer than a third of the record leave hardly one difference to average.
_LONGEST_SHARE = 3

# A step this far from the median, relatively, is no jitter of stamps: samples are missing or bunched.
_UNEVEN = 0.5

# A term is visible when a record without it would look like this one in one of a thousand cases: z^2 at z = 3.
_VISIBLE = 9.0

_QUANTILES = (0.025, 0.975)


@dataclass(frozen=True, slots=True, eq=False)
class AllanTerm:
    """One coefficient per axis with its 95 % interval, in SI units.

    Where the record does not show the term its value is NaN, low is zero and high is the most that it can be.
    """

    value: Array  # (axes,)
    low: Array  # (axes,)
    high: Array  # (axes,)

    @property
    def visible(self) -> npt.NDArray[np.bool_]:
        """(axes,) whether the record shows it."""
        return np.isfinite(self.value)


@dataclass(frozen=True, slots=True, eq=False)
class AllanFit(Shown):
    """Allan deviation of one sensor at rest, with the noise read from it; unit u is rad/s, m/s^2 or uT."""

    sensor: str  # "gyro", "accel" or "mag"
    name: str
    samples: int
    rate_hz: float
    tau: Array  # (k,) s
    deviation: Array  # (k, 3) u
    low: Array  # (k, 3) u, 95 % interval
    high: Array  # (k, 3) u
    N: AllanTerm  # u/sqrt(Hz)
    B: AllanTerm  # u; the deviation's floor is 0.664 B
    K: AllanTerm  # u/sqrt(s)

    def card(self) -> Card:
        """The three terms per axis, with their 95 % intervals."""
        rows = [
            (f"{name}, {units[0].name}", *_told(getattr(self, name), units[0].factor))
            for name, units in COEFFICIENT[self.sensor].items()
        ]
        title = f"AllanFit of {self.sensor}: {self.samples} samples at {self.rate_hz:.4g} Hz"
        return Card(title, ("", "x", "y", "z"), rows, ("95 % intervals in brackets",))

    @property
    def noise(self) -> NoiseModel:
        """The terms that are visible, for a simulated sensor; what is not visible is zero."""
        return NoiseModel(*(np.nan_to_num(getattr(self, name).value) for name in TERMS))

    def model(self, tau: Array) -> Array:
        """Allan deviation (k, 3) of the terms that are visible, at averaging times `tau` (k,) s."""
        return self.noise.allan_deviation(tau)


def _told(term: AllanTerm, factor: float) -> list[str]:
    """Value and interval per axis in a unit that is 1 / `factor` of SI's, or what a hidden term is less than."""
    axes = zip(factor * term.value, factor * term.low, factor * term.high, term.visible, strict=True)
    return [f"{v:.3g} ({a:.3g} to {b:.3g})" if shown else f"hidden, < {b:.3g}" for v, a, b, shown in axes]


def allan(recording: ImuRecording, sensor: str = "gyro") -> AllanFit:
    """Noise of `sensor` ("gyro", "accel" or "mag") of a `recording` at rest.

    A magnetometer may be slower than the rest: rows in which it has no sample are left out.

    Raises ValueError for missing samples and gaps, naming where, an axis that never changes, and records of
    fewer than 32 samples. A sensor that was moved shows its motion as noise: nothing here can tell.
    """
    instance("recording", recording, ImuRecording, SOURCE)
    choice("sensor", sensor, SENSORS)
    t, samples = _readings(recording, sensor)
    rate_hz = _even_rate(t, sensor, samples)
    variances, sizes = _variances(samples, default_sizes(len(samples)))
    still = ~(variances > 0.0).all(axis=0)
    if still.any():
        axis = "xyz"[int(np.argmax(still))]
        raise ValueError(f"{sensor} {axis} has no noise: it never changes. Is the axis connected?")
    forms = variance_forms(len(samples), sizes)
    axes = [_fit(column, sizes, forms) for column in samples.T]
    low, high = (np.column_stack([axis.band[k] for axis in axes]) for k in (0, 1))
    deviation = np.sqrt(variances)
    return AllanFit(
        sensor=sensor,
        name=recording.name,
        samples=len(samples),
        rate_hz=rate_hz,
        tau=read_only(sizes / rate_hz),
        deviation=read_only(deviation),
        low=read_only(deviation * low),
        high=read_only(deviation * high),
        **{name: _in_si(axes, k, rate_hz) for k, name in enumerate(TERMS)},
    )


def allan_deviation(samples: Any, rate_hz: float, sizes: Any = None) -> tuple[Array, Array]:
    """Averaging times (k,) s and overlapping Allan deviation (k,) or (k, axes) of `samples` (n,) or (n, axes).

    sizes : samples per cluster, each from 1 to n // 2; by default twelve a decade up to a third of the record.
    """
    x = as_array("samples", samples)
    if x.ndim not in (1, 2):
        raise ValueError(f"samples must be (n,) or (n, axes); got {x.shape}.")
    finite("samples", x)
    rate_hz = scalar("rate_hz", rate_hz, "Hz", 1e-9, 1e12)
    wanted = default_sizes(len(x)) if sizes is None else np.asarray(sizes, dtype=np.int64)
    if wanted.ndim != 1 or not ((wanted >= 1) & (wanted <= len(x) // 2)).all():
        raise ValueError(f"sizes must be from 1 to half of the {len(x)} samples; got {sizes}.")
    variances, wanted = _variances(x.reshape(len(x), -1), wanted)
    return wanted / rate_hz, np.sqrt(variances).reshape(len(wanted), *x.shape[1:])


def default_sizes(samples: int) -> Sizes:
    """Cluster sizes: one, then twelve a decade up to a third of the record; ValueError below 32 samples."""
    if samples < _FEWEST:
        raise ValueError(f"an Allan deviation needs {_FEWEST} samples or more, got {samples}.")
    longest = samples // _LONGEST_SHARE
    return np.unique(np.geomspace(1, longest, int(12 * np.log10(longest)) + 1).astype(np.int64))


def _variances(samples: Array, sizes: Sizes) -> tuple[Array, Sizes]:
    columns = [overlapping_variances(np.ascontiguousarray(column), sizes) for column in samples.T]
    return np.column_stack(columns), sizes


def _readings(recording: ImuRecording, sensor: str) -> tuple[Array, Array]:
    """Stamps (n,) and samples (n, 3) of one sensor."""
    if sensor != "mag":
        return recording.t, getattr(recording, sensor)
    if recording.mag_uT is None:
        raise ValueError("this recording has no magnetometer.")
    seen = np.isfinite(recording.mag_uT).all(axis=1)
    return recording.t[seen], recording.mag_uT[seen]


def _even_rate(t: Array, sensor: str, samples: Array) -> float:
    """Samples per second over the whole record, or a ValueError naming the first place where one is missing."""
    if len(t) < _FEWEST:
        default_sizes(len(t))
    present: npt.NDArray[np.bool_] = np.asarray(np.isfinite(samples).all(axis=1))
    steps = np.diff(t)
    usual = float(np.median(steps))
    uneven = np.abs(steps - usual) > _UNEVEN * usual
    if not present.all():
        k = int(np.argmin(present))
        where = f"{sensor} row {k} at t = {t[k]:.6g} s is {samples[k]} ({int((~present).sum())} such rows)"
        raise ValueError(f"an Allan deviation needs every sample: {where}. {_longest(t, present, uneven)}")
    if uneven.any():
        k = int(np.argmax(uneven))
        raise ValueError(
            f"an Allan deviation needs even steps: from row {k} at t = {t[k]:.6g} s to row {k + 1} pass "
            f"{steps[k]:.4g} s where the median step is {usual:.4g} s ({int(uneven.sum())} such places). "
            + _longest(t, present, uneven)
        )
    return (len(t) - 1) / float(t[-1] - t[0])


def _longest(t: Array, present: npt.NDArray[np.bool_], uneven: npt.NDArray[np.bool_]) -> str:
    """What to take in place of a record with holes."""
    breaks = np.flatnonzero(uneven | ~present[:-1] | ~present[1:])
    firsts, lasts = np.append(0, breaks + 1), np.append(breaks, len(t) - 1)
    k = int(np.argmax(lasts - firsts))
    if lasts[k] == firsts[k]:
        return "No two that follow each other are there."
    # Outwards to six digits, which --start and --end take: the ends stay in.
    first, last = (
        1e-6 * turn(1e6 * (t[row] - t[0])) for turn, row in ((np.floor, firsts[k]), (np.ceil, lasts[k]))
    )
    return (
        f"The longest piece with all of them runs from {first:.10g} to {last:.10g} s after the first sample: "
        "take that one (kreisel allan --start, --end)."
    )


class _Axis(NamedTuple):
    theta: Array  # (3,) of N^2 / dt, B^2, K^2 dt; NaN where not visible
    low: Array  # (3,)
    high: Array  # (3,)
    band: tuple[Array, Array]  # each (k,): interval of the deviation, relative to it


def _fit(samples: Array, sizes: Sizes, forms: Array) -> _Axis:
    """Likeliest terms, with intervals of all values that are not much less likely, whatever the other terms then are.

    A term too weak to be reported stays in the model, so that the others do not answer for it.
    """
    found = powers(samples)
    best = likeliest(found)
    shown = np.array([without(found, best, k) >= _VISIBLE for k in range(3)])
    return _Axis(
        np.where(shown, best.theta, np.nan),
        np.array([lower_end(found, best, k) if shown[k] else 0.0 for k in range(3)]),
        np.array([upper_end(found, best, k) for k in range(3)]),
        _band(best.theta, sizes, forms),
    )


def _band(theta: Array, sizes: Sizes, forms: Array) -> tuple[Array, Array]:
    spread = forms.reshape(len(sizes), 9) @ np.outer(theta, theta).ravel()
    low, high = _interval(2.0 * (terms(sizes) @ theta) ** 2 / spread)
    return np.sqrt(low), np.sqrt(high)


def _interval(freedom: Array) -> tuple[Array, Array]:
    """Factors from a variance with so many degrees of freedom to its 95 % interval (chi squared)."""
    from scipy.special import gammaincinv

    with np.errstate(over="ignore"):  # less than a hundredth of a degree of freedom: no upper end at all
        low, high = (0.5 * freedom / gammaincinv(0.5 * freedom, q) for q in reversed(_QUANTILES))
    return low, high


def _in_si(axes: list[_Axis], term: int, rate_hz: float) -> AllanTerm:
    """From units of one sample to seconds."""
    factor = (1.0 / rate_hz, 1.0, rate_hz)[term]
    each = [[getattr(axis, part)[term] * factor for axis in axes] for part in ("theta", "low", "high")]
    return AllanTerm(*(read_only(np.sqrt(np.array(part))) for part in each))
