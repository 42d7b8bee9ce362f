"""What many runs of one scenario made: inputs drawn, errors of every run, their spread over runs and over time."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array, choice
from kreisel.study.ensemble.draws import Draws
from kreisel.study.scenario import Scenario

LEVELS = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Shares of the runs whose errors lie below the quantiles that are kept."""

_SUMMARY = {"p05": 5.0, "median": 50.0, "p95": 95.0, "max": 100.0}


@dataclass(frozen=True, slots=True, eq=False)
class Estimates:
    """What one filter made of one IMU in all runs."""

    imu: str
    filter: str
    figures: Mapping[
        str, Array
    ]  # name, as in `AttitudeErrors.summary()` -> (runs,); a time of infinity is never
    quantiles: Mapping[str, Array]  # "total", "heading" (signed) or "inclination" -> (len(LEVELS), m) deg

    def summary(self) -> dict[str, dict[str, float]]:
        """Mean and percentiles over runs of every figure; a mean over runs of which one never converged is infinite."""
        return {name: _spread(values) for name, values in self.figures.items()}


@dataclass(frozen=True, slots=True, eq=False)
class Ensemble:
    """Many runs of one scenario, each with noise of its own and, where `vary` says so, values of its own."""

    base: Scenario  # with what varies in it
    runs: int
    inputs: Mapping[str, npt.NDArray[Any]]  # path -> (runs,) what was drawn
    t: Array  # (m,) s after the start of a run, the instants of the quantiles; where times vary those of run 0
    estimates: tuple[Estimates, ...]  # one per IMU and filter, IMU by IMU

    def __len__(self) -> int:
        return self.runs

    def scenario(self, run: int) -> Scenario:
        """The scenario of one run, complete in itself: `study.run` makes the very numbers of that run again."""
        if not 0 <= run < self.runs:
            raise ValueError(f"run must be from 0 to {self.runs - 1}; got {run}.")
        return Draws(self.base).of(run)

    def correlations(self, figure: str = "heading_rmse_deg", estimate: int = 0) -> dict[str, float]:
        """Path of each input that is a number -> Spearman's rank correlation with a figure, strongest first.

        Where the distance of an input from its median says more than the input, as of a lever arm to either side, it
        stands as "|PATH|". Without any connection it is below 2 / sqrt(runs) in 9 of 10 cases. NaN where one of
        both never changes.
        """
        figures = self.estimates[estimate].figures
        values = figures[choice("figure", figure, list(figures))]
        found = {}
        for path, x in self.inputs.items():
            if x.dtype != object:
                ways = {path: x, f"|{path}|": np.abs(x - np.median(x))}
                rho = {name: rank_correlation(column, values) for name, column in ways.items()}
                best = max(rho, key=lambda name: abs(np.nan_to_num(rho[name])))
                found[best] = rho[best]
        return dict(sorted(found.items(), key=lambda item: -abs(np.nan_to_num(item[1]))))

    def summary(self) -> list[dict[str, Any]]:
        """Of every estimate, IMU by IMU: figures over runs, and which input drives them."""
        return [
            {
                "imu": each.imu,
                "filter": each.filter,
                "figures": each.summary(),
                "correlations": {name: self.correlations(name, k) for name in each.figures},
            }
            for k, each in enumerate(self.estimates)
        ]

    def report(self) -> dict[str, Any]:
        """The ensemble in numbers and texts that JSON holds; "schema" names their layout."""
        from kreisel.study.ensemble.files import report

        return report(self)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write scenario.toml, ensemble.npz and report.json into `folder`, which `load` makes the same of.

        Raises ValueError for a trajectory of functions, OSError where nothing can be written.
        """
        from kreisel.study.ensemble.files import save

        return save(self, Path(folder))

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Ensemble:
        """What `save` wrote; ValueError with the file where it is not sound, OSError where it is not there."""
        from kreisel.study.ensemble.files import load

        return load(Path(folder))


def rank_correlation(x: Array, y: Array) -> float:
    """Spearman's correlation of two columns; NaN where one is constant or holds NaN."""
    from scipy.stats import rankdata

    if np.isnan(x).any() or np.isnan(y).any():
        return float("nan")
    a, b = (rankdata(column) - 0.5 * (len(column) + 1) for column in (x, y))
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else float("nan")


def _spread(values: Array) -> dict[str, float]:
    found = {"mean": float(np.mean(values))}
    # Not interpolated: halfway between a time and never there is nothing.
    return found | {
        name: float(np.percentile(values, level, method="inverted_cdf")) for name, level in _SUMMARY.items()
    }
