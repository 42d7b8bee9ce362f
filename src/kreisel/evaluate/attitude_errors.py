"""Turns a true and an estimated attitude into the error between them: total, heading and inclination.

There is one definition: ``R_est = Exp(dtheta_N) R_true``. With the quaternion (w, x, y, z) of dtheta_N, in N,
the total error is 2 acos|w|, the heading error 2 atan(z / w), the twist about up, and the inclination error
2 acos sqrt(w^2 + z^2), the swing that is left. The BROAD benchmark measures the same three.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Mask, Reference, mask
from kreisel.data.cards import Card, Shown, course
from kreisel.data.checks import Array, choice, finite, read_only, same_length, shaped
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.evaluate import offsets
from kreisel.evaluate.error_angles import error_angles, rows_of, spread
from kreisel.evaluate.offsets import Offsets, Track
from kreisel.maths.rotations import log_so3

Truth = Motion | Reference | AttitudeHistory | Poses
Estimate = AttitudeHistory | Motion | Poses
Align = Literal["heading", "frame", "frame+sensor"]


@dataclass(frozen=True, slots=True)
class Summary:
    """Statistics of attitude errors over the samples that count, magnitudes in degrees; plain values.

    Offsets that were taken off first are None where none was: off by default, never unseen.
    """

    samples: int
    total_rmse_deg: float
    total_mean_deg: float
    total_median_deg: float
    total_p95_deg: float
    total_max_deg: float
    heading_rmse_deg: float
    heading_mean_deg: float
    heading_median_deg: float
    heading_p95_deg: float
    heading_max_deg: float
    inclination_rmse_deg: float
    inclination_mean_deg: float
    inclination_median_deg: float
    inclination_p95_deg: float
    inclination_max_deg: float
    convergence_of: str  # "total", "heading" or "inclination"
    convergence_limit_deg: float
    convergence_time_s: float | None  # s after the first sample that counts; None if it never stays below
    align: str | None  # "heading", "frame" or "frame+sensor"
    heading_offset_deg: float | None  # removed from the estimate
    frame_offset_deg: tuple[float, float, float] | None  # rotation vector in N, removed from the estimate
    sensor_offset_deg: tuple[float, float, float] | None  # rotation vector in S, removed from the estimate
    clock_offset_s: float  # by which the estimate's stamps were taken to be ahead; 0 as they come


@dataclass(frozen=True, slots=True, eq=False)
class AttitudeErrors(Shown):
    """Error of an estimated attitude at the stamps of the truth: R_est = Exp(dtheta_N) R_true."""

    t: Array  # (n,) s after t0_ns, stamps of the truth inside the estimate
    dtheta_N: Array  # (n, 3) rad, rotation vector in N; NaN where the truth has no attitude
    counts: Mask  # (n,) which samples enter the statistics
    t0_ns: int = 0  # epoch of t = 0, ns
    align: str | None = None  # which offset was fitted and removed
    removed: Offsets = field(default_factory=Offsets)
    name: str = ""
    angles: Array | None = (
        None  # (3, n) rad: total, heading, inclination as they were found; None: from dtheta_N
    )

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t", shaped("t", self.t, ("n",)))
        if self.angles is not None:
            put(self, "angles", shaped("angles", self.angles, (3, len(self.t))))
        put(self, "dtheta_N", shaped("dtheta_N", self.dtheta_N, ("n", 3)))
        put(self, "counts", mask("counts", self.counts))
        same_length(self.t, dtheta_N=self.dtheta_N, counts=self.counts)

    def __len__(self) -> int:
        return len(self.t)

    def card(self) -> Card:
        """RMSE, mean, median, 95th percentile and largest of the three errors, in degrees."""
        summary, statistics = self.summary(), ("rmse", "mean", "median", "p95", "max")
        rows = [
            (name, *(f"{getattr(summary, f'{name}_{key}_deg'):.4g}" for key in statistics))
            for name in ("total", "heading", "inclination")
        ]
        aligned = (
            "nothing was aligned" if self.align is None else f"after a constant {self.align} was taken off"
        )
        return Card(
            course(self, self.t), ("error, deg", *statistics), rows, (f"{summary.samples} count; {aligned}",)
        )

    @property
    def total(self) -> Array:
        """(n,) rad, angle of the error, in [0, pi]."""
        if self.angles is not None:
            return self.angles[0]
        return np.asarray(np.linalg.norm(self.dtheta_N, axis=1))

    @property
    def heading(self) -> Array:
        """(n,) rad, signed, in [-pi, pi]: the part of the error that turns about up."""
        if self.angles is not None:
            return self.angles[1]
        w, _, z = self._quaternion()
        return np.asarray(2.0 * np.arctan2(z, w))

    @property
    def inclination(self) -> Array:
        """(n,) rad, in [0, pi]: angle between the true up and the estimated one."""
        if self.angles is not None:
            return self.angles[2]
        w, swing, z = self._quaternion()
        # acos loses half of all digits near zero; the two sides of the triangle do not.
        return np.asarray(2.0 * np.arctan2(swing, np.hypot(w, z)))

    def _quaternion(self) -> tuple[Array, Array, Array]:
        """w, hypot(x, y) and z of the error, w >= 0."""
        half = 0.5 * self.total
        # np.sinc(x) is sin(pi x) / (pi x).
        x, y, z = 0.5 * np.sinc(half / np.pi) * self.dtheta_N.T
        return np.cos(half), np.hypot(x, y), z

    def summary(
        self,
        limit_deg: float = 5.0,
        of: Literal["total", "heading", "inclination"] = "total",
    ) -> Summary:
        """Statistics over the samples that count, and when error `of` fell below `limit_deg` for good."""
        choice("of", of, ("total", "heading", "inclination"))
        numbers: dict[str, Any] = {}
        for name in ("total", "heading", "inclination"):
            found = spread(getattr(self, name), None if self.counts.all() else self.counts)
            numbers |= {f"{name}_{statistic}_deg": x for statistic, x in found._asdict().items()}
        worst = np.degrees(np.abs(getattr(self, of)[self.counts]))
        return Summary(
            samples=int(self.counts.sum()),
            **numbers,
            convergence_of=of,
            convergence_limit_deg=float(limit_deg),
            convergence_time_s=_convergence_time(self.t[self.counts], worst, limit_deg),
            align=self.align,
            **self._offsets_deg(),
        )

    def _offsets_deg(self) -> dict[str, Any]:
        frame, sensor = np.degrees(self.removed.frame_N), np.degrees(self.removed.sensor_S)
        return {
            "heading_offset_deg": float(frame[2]) if self.align == "heading" else None,
            "frame_offset_deg": tuple(frame.tolist()) if self.align in ("frame", "frame+sensor") else None,
            "sensor_offset_deg": tuple(sensor.tolist()) if self.align == "frame+sensor" else None,
            "clock_offset_s": self.removed.clock,
        }


def attitude_errors(
    truth: Truth,
    estimate: Estimate,
    *,
    align: Align | None = None,
    clock_offset: float | Literal["estimate"] = 0.0,
    samples: Any = None,
) -> AttitudeErrors:
    """Error of `estimate` against `truth`, at those stamps of `truth` that lie inside the estimate.

    Both name the attitude of one frame, S or B, in N; `AttitudeHistory.body` and `Motion.at` change it. The
    estimate is interpolated at constant rate between its samples, never beyond them; epochs (t0_ns) count.
    align : None compares as is. "heading" first removes the constant turn about up, "frame" the constant
        rotation in N, "frame+sensor" also one in sensor axes, that leaves the least mean square total error.
    clock_offset : s, by which the estimate's stamps are ahead of the truth's; "estimate" to find it.
    samples : (n,) booleans, one per row of `truth`: which ones enter statistics and alignment, beside what a
        `Reference` says. All by default.
    Raises TypeError for other types, ValueError where nothing overlaps, nothing counts, or the motion does
    not show an offset that was asked for.
    """
    seen, counts = _truth(truth)
    if samples is not None:
        chosen = mask("samples", samples)
        same_length(truth.t, samples=chosen)
        counts = counts & chosen
    if align is not None:
        choice("align", align, offsets.KINDS)
    track = _on_clock_of(truth, estimate)
    if not isinstance(clock_offset, str):
        finite("clock_offset", np.asarray(clock_offset, dtype=np.float64))
        _overlap(seen.t, track.t, clock_offset)
    removed = _offsets(Track(seen.t[counts], seen.R[counts]), track, align, clock_offset)
    inside = slice(*_overlap(seen.t, track.t, removed.clock))
    _some_count(counts[inside])
    R, R_true = offsets.corrected(seen.t[inside], track, removed), seen.R[inside]
    return AttitudeErrors(
        t=seen.t[inside],
        dtheta_N=read_only(log_so3(R @ np.swapaxes(R_true, -1, -2))),
        angles=read_only(error_angles(rows_of(R_true), R)),
        counts=counts[inside],
        t0_ns=truth.t0_ns,
        align=align,
        removed=removed,
        name=estimate.name,
    )


def _truth(truth: Truth) -> tuple[Track, Mask]:
    if isinstance(truth, Reference):
        return Track(truth.t, truth.R_NS), truth.counts
    if not isinstance(truth, Motion | AttitudeHistory | Poses):
        raise TypeError(
            f"truth must be Motion, Reference, AttitudeHistory or Poses; got {type(truth).__name__}."
        )
    return Track(truth.t, _attitude("truth", truth)), np.ones(len(truth), dtype=np.bool_)


def _on_clock_of(truth: Truth, estimate: Estimate) -> Track:
    if not isinstance(estimate, AttitudeHistory | Motion | Poses):
        raise TypeError(f"estimate must be AttitudeHistory, Motion or Poses; got {type(estimate).__name__}.")
    # Epochs are subtracted as integers: as floats they would be rounded to 128 ns.
    shift = (estimate.t0_ns - truth.t0_ns) / 1e9
    track = Track(estimate.t + shift, _attitude("estimate", estimate))
    if not len(truth) or not len(estimate):
        raise ValueError(f"nothing to compare: {'truth' if not len(truth) else 'estimate'} has no samples.")
    if np.diff(offsets.overlap(truth.t, track.t))[0] == 0 and (truth.t0_ns == 0) != (estimate.t0_ns == 0):
        raise ValueError(
            f"truth and estimate do not overlap: their epochs t0_ns are {truth.t0_ns} and {estimate.t0_ns}. "
            "One is on a clock of its own; give both the same t0_ns."
        )
    return track


def _attitude(role: str, data: Estimate) -> Array:
    R = data.R_NS if isinstance(data, AttitudeHistory) else data.R_NB
    if R is None:
        raise ValueError(f"{role} has positions only; attitude errors need attitude (R_NB).")
    return R


def _offsets(truth: Track, estimate: Track, align: str | None, clock: float | str) -> Offsets:
    if isinstance(clock, str):
        choice("clock_offset", clock, ("estimate",))
    elif align is None:
        return Offsets(clock=float(clock))
    _some_count(np.ones(len(truth.t), dtype=np.bool_))
    return offsets.fit(truth, estimate, align, None if isinstance(clock, str) else float(clock))


def _overlap(truth_t: Array, estimate_t: Array, clock: float) -> tuple[int, int]:
    first, end = offsets.overlap(truth_t, estimate_t, clock)
    if first == end:
        raise ValueError(
            f"truth and estimate do not overlap: the truth spans {truth_t[0]:.9g} to {truth_t[-1]:.9g} s and "
            f"the estimate {estimate_t[0] - clock:.9g} to {estimate_t[-1] - clock:.9g} s on the same clock. "
            "Check t0_ns and clock_offset."
        )
    return first, end


def _some_count(counts: Mask) -> None:
    if not counts.any():
        raise ValueError(
            "nothing to compare: no sample of the truth that counts lies inside the estimate. "
            "Check `samples`, the mask of the reference and the stamps."
        )


def _convergence_time(t: Array, magnitude: Array, limit: float) -> float | None:
    above = np.flatnonzero(magnitude >= limit)
    if not above.size:
        return 0.0
    return float(t[above[-1] + 1] - t[0]) if above[-1] + 1 < len(t) else None
