"""Turns the attitude errors of one run into the figures that are kept of it, and into a thinned trace."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array
from kreisel.evaluate.attitude_errors import AttitudeErrors
from kreisel.study.run import Estimate

KINDS = ("total", "heading", "inclination")

FIGURES = (
    *(f"{kind}_{statistic}_deg" for kind in KINDS for statistic in ("rmse", "mean", "median", "p95", "max")),
    "convergence_time_s",
)
"""Of every run, by the names they have in `AttitudeErrors.summary()`; a time of infinity is never."""

LIMIT_DEG = 5.0
"""What the total error stays below once a run has converged: that of `AttitudeErrors.summary()`."""

NEES = "nees"
"""Mean of (error / sigma)^2 over samples and axes of N: 1 where a filter errs as much as it says."""


def figures(estimate: Estimate) -> dict[str, float]:
    """The figures of one estimate."""
    summary = estimate.summary
    found = {name: getattr(summary, name) for name in FIGURES}
    never = found["convergence_time_s"] is None
    found["convergence_time_s"] = math.inf if never else found["convergence_time_s"]
    if estimate.attitude.sigma is not None:
        found[NEES] = nees(estimate.errors, estimate.attitude.sigma)
    return found


def nees(errors: AttitudeErrors, sigma: Array) -> float:
    """Normalised estimation error squared, less the part between axes: see `NEES`; NaN where lengths differ."""
    if len(sigma) != len(errors):
        return math.nan
    return float(np.mean((errors.dtheta_N[errors.counts] / sigma[errors.counts]) ** 2))


def instants(count: int, most: int) -> npt.NDArray[np.int64]:
    """Rows of `count` samples at which traces are kept: `most` of them, evenly apart, both ends among them."""
    return np.round(np.linspace(0, count - 1, most)).astype(np.int64)


def trace(errors: AttitudeErrors, most: int) -> npt.NDArray[np.float32]:
    """Total, heading and inclination error (3, most) at instants evenly apart, deg; heading has its sign."""
    rows = instants(len(errors), most)
    return np.array([np.degrees(getattr(errors, kind)[rows]) for kind in KINDS], dtype=np.float32)
