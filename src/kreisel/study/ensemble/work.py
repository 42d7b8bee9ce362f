"""Turns the number of a block of runs into their figures and traces."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.study.ensemble.draws import Draws
from kreisel.study.ensemble.figures import figures, trace
from kreisel.study.ensemble.stage import Seen, Stage, Stages
from kreisel.study.run import estimated
from kreisel.study.scenario import Scenario
from kreisel.study.sensor import errs

Columns = dict[str, npt.NDArray[Any]]

INSTANTS = 201
"""Of each run so many errors are kept over time."""


@dataclass(frozen=True)
class Work:
    """Runs number * size, number * size + 1, ... up to the last of all, by the number of their block.

    A pure function of the scenario, whose `vary` and seed are all that runs differ by: the same arrays on any thread,
    process or machine, whatever was worked on before.
    """

    scenario: Scenario
    runs: int
    size: int  # runs in a block
    _stages: Stages = field(default_factory=Stages, compare=False, repr=False)

    def __call__(self, number: int) -> Columns:
        """Figures (m,) and traces (m, 3, INSTANTS) of the m runs of a block, as "ESTIMATE/FIGURE".

        ESTIMATE counts filters on IMUs, IMU by IMU. Raises ValueError that names the run which cannot be made.
        """
        draws = Draws(self.scenario)
        rows: list[dict[str, Any]] = [self._run(draws, run) for run in self.block(number)]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    def block(self, number: int) -> range:
        """The runs of a block."""
        return range(number * self.size, min((number + 1) * self.size, self.runs))

    @property
    def blocks(self) -> range:
        """Numbers of all blocks."""
        return range(-(-self.runs // self.size))

    def stage(self, draws: Draws, run: int) -> Stage:
        """What a run shares with others; ValueError with run, path and value where it cannot be made."""
        try:
            return self._stages.of(draws.of(run))
        except ValueError as error:
            raise ValueError(draws.blamed(run, error)) from None

    def _run(self, draws: Draws, run: int) -> dict[str, Any]:
        scenario, stage = draws.of(run), self.stage(draws, run)
        row: dict[str, Any] = {}
        for imu, seen in enumerate(stage.seen):
            row |= self._estimates(scenario, stage, seen, imu * len(scenario.filters))
        return row

    def _estimates(self, scenario: Scenario, stage: Stage, seen: Seen, first: int) -> dict[str, Any]:
        recording = seen.ideal
        if errs(seen.imu):
            recording = seen.imu.record(stage.motion, scenario.seed, scenario.run, ideal=seen.ideal).measured
        row: dict[str, Any] = {}
        for k, (recipe, filter) in enumerate(zip(scenario.filters, stage.filters, strict=True)):
            estimate = estimated(recipe, filter, recording, seen.truth)
            found = {**figures(estimate), "trace": trace(estimate.errors, INSTANTS)}
            row |= {f"{first + k}/{name}": value for name, value in found.items()}
        return row
