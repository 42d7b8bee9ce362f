"""Turns the number of a block of runs into their figures and traces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.recording import ImuRecording
from kreisel.maths.kernels import LANES
from kreisel.study.ensemble.draws import Draws
from kreisel.study.ensemble.figures import figures, trace
from kreisel.study.ensemble.stage import Seen, Stage, Stages
from kreisel.study.ensemble.tile import Scratch, estimates, go_abreast
from kreisel.study.run import estimated
from kreisel.study.scenario import FilterRecipe, Scenario
from kreisel.study.sensor import errs

Columns = dict[str, npt.NDArray[Any]]
Group = tuple[Stage, list[Scenario]]

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
    _scratch: Scratch = field(default_factory=Scratch, compare=False, repr=False)

    def __call__(self, number: int) -> Columns:
        """Figures (m,) and traces (m, 3, INSTANTS) of the m runs of a block, as "ESTIMATE/FIGURE".

        ESTIMATE counts filters on IMUs, IMU by IMU. Raises ValueError that names the run which cannot be made.
        """
        draws = Draws(self.scenario)
        parts = [self._together(group) for group in self._groups(draws, self.block(number))]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def block(self, number: int) -> range:
        """The runs of a block."""
        return range(number * self.size, min((number + 1) * self.size, self.runs))

    @property
    def blocks(self) -> range:
        """Numbers of all blocks."""
        return range(-(-self.runs // self.size))

    def stage(self, draws: Draws, run: int) -> Stage:
        """What a run shares with others; ValueError with run, path and value where it cannot be made."""
        return self._staged(draws, run)[1]

    def _staged(self, draws: Draws, run: int) -> tuple[Scenario, Stage]:
        scenario = draws.of(run)
        try:
            return scenario, self._stages.of(scenario)
        except ValueError as error:
            raise ValueError(draws.blamed(run, error)) from None

    def _groups(self, draws: Draws, runs: range) -> Iterator[Group]:
        """Neighbouring runs on one stage, as many as there are lanes at most."""
        group: list[Scenario] = []
        on: Stage | None = None
        for run in runs:
            # What nothing is drawn for is the same in every run.
            scenario, stage = self._staged(draws, run) if on is None or draws.inputs else (draws.of(run), on)
            if on is not None and (stage != on or len(group) == LANES):
                yield on, group
                group = []
            on = stage
            group.append(scenario)
        if on is not None:
            yield on, group

    def _together(self, group: Group) -> Columns:
        """Figures and traces of a group, abreast where there are as many as lanes."""
        stage, runs = group
        found: Columns = {}
        for imu, seen in enumerate(stage.seen):
            for k, columns in enumerate(self._of_imu(stage, seen, runs)):
                number = imu * len(stage.filters) + k
                found |= {f"{number}/{name}": values for name, values in columns.items()}
        return found

    def _of_imu(self, stage: Stage, seen: Seen, runs: list[Scenario]) -> Iterator[Columns]:
        """Figures and traces of every filter on one IMU."""
        recipes = [[run.filters[k] for run in runs] for k in range(len(stage.filters))]
        pairs = list(zip(recipes, stage.filters, strict=True))
        together = [len(runs) == LANES and go_abreast(each[0], filter, seen) for each, filter in pairs]
        tiled = [pair for pair, fits in zip(pairs, together, strict=True) if fits]
        found = iter(estimates(self._scratch, seen, runs, tiled, INSTANTS) if tiled else [])
        alone = [] if all(together) else [_recording(seen, stage, run) for run in runs]
        for (each, filter), fits in zip(pairs, together, strict=True):
            yield next(found) if fits else _each(seen, alone, each, filter, INSTANTS)


def _recording(seen: Seen, stage: Stage, run: Scenario) -> ImuRecording:
    if not errs(seen.imu):
        return seen.ideal
    return seen.imu.record(stage.motion, run.seed, run.run, ideal=seen.ideal).measured


def _each(
    seen: Seen, recordings: Sequence[ImuRecording], recipes: Sequence[FilterRecipe], filter: Any, most: int
) -> Columns:
    """The same as `estimates`, one run after the other, with any filter and recipe."""
    rows: list[dict[str, Any]] = []
    for recipe, recording in zip(recipes, recordings, strict=True):
        made = estimated(recipe, filter, recording, seen.truth)
        rows.append({**figures(made), "trace": trace(made.errors, most)})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
