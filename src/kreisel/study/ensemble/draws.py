"""Turns a scenario with distributions in it into the scenario of every single run."""

from __future__ import annotations

import copy
import inspect
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from kreisel import discovery
from kreisel.data.checks import whole_number
from kreisel.maths.random import stream
from kreisel.study.ensemble.distributions import Distribution
from kreisel.study.ensemble.paths import Way, put, resolve, written
from kreisel.study.signature import Place

if TYPE_CHECKING:
    from kreisel.study.scenario import Scenario

# Where the streams of drawn values are told from those of sensors.
_STREAM = "vary"


@dataclass(frozen=True, slots=True)
class Input:
    """One value that varies."""

    path: str  # in its one way to be written
    way: Way  # in the scenario's table
    distribution: Distribution


@dataclass(frozen=True)
class Draws:
    """What every run of a scenario's ensemble is run with.

    A value is a function of seed, run and its path alone: one path more or less leaves the others' values alone, and
    any run can be made without the others. Raises ValueError for a path that leads nowhere.
    """

    scenario: Scenario  # with `vary`
    where: Place = field(default=Place("scenario"), compare=False)

    @cached_property
    def inputs(self) -> tuple[Input, ...]:
        """The values that vary, in the order of `vary`."""
        found = []
        for path, given in self.scenario.vary.items():
            try:
                way = resolve(self._table, path, self._default)
            except ValueError as error:
                raise ValueError(f"{self.where.at('vary')}: {error}") from None
            found.append(Input(written(self._table, way), way, Distribution.of(given)))
        names = [each.path for each in found]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"{self.where.at('vary')}: {twice} is drawn from two distributions.")
        return tuple(found)

    def value(self, input: Input, run: int) -> Any:
        """What `input` is in run number `run`."""
        return input.distribution.draw(stream(self.scenario.seed, run, _STREAM, input.path))

    def columns(self, runs: int) -> dict[str, npt.NDArray[Any]]:
        """Path -> values (runs,) of all runs; texts and lists stay what they are, as objects."""
        columns: dict[str, npt.NDArray[Any]] = {}
        for input in self.inputs:
            values = [self.value(input, run) for run in range(runs)]
            numbers = all(isinstance(v, int | float) for v in values)
            columns[input.path] = np.array(values, dtype=np.float64 if numbers else np.object_)
        return columns

    def of(self, run: int) -> Scenario:
        """The scenario of one run, complete in itself: nothing in it varies any more.

        Raises ValueError with path, value and run where a value that was drawn cannot be.
        """
        if not self.inputs:
            # All but the number was checked already, which takes as long as a thousand samples.
            made = copy.copy(self._plain)
            object.__setattr__(made, "run", whole_number("run", run))
            return made
        drawn = [(input, self.value(input, run)) for input in self.inputs]
        try:
            return self._with(drawn, run)
        except ValueError as error:
            raise ValueError(self.blamed(run, error)) from None

    def blamed(self, run: int, error: ValueError) -> str:
        """A sentence that names the drawn value which brought `error`, or all of them where no single one does."""
        from kreisel.study.building import build

        drawn = [(input, self.value(input, run)) for input in self.inputs]
        for one in drawn:
            try:
                build(self._with([one], run))
            except ValueError as alone:
                drawn, error = [one], alone
                break
        values = ", ".join(f"{i.path} = {v!r} of {i.distribution}" for i, v in drawn)
        return f"run {run}: {values}: {error}" if values else f"run {run}: {error}"

    def check(self) -> None:
        """Make the first run, as far as that goes without running it; ValueError where it cannot be."""
        from kreisel.study.building import build

        scenario = self.of(0)
        try:
            build(scenario, self.where)
        except ValueError as error:
            raise ValueError(self.blamed(0, error)) from None

    def _with(self, drawn: list[tuple[Input, Any]], run: int) -> Scenario:
        from kreisel.study.document import of_table
        from kreisel.study.scenario import TrajectoryRecipe

        table = copy.deepcopy(self._table)
        for input, value in drawn:
            put(table, input.way, value, self._default)
        table["run"] = run
        made = of_table(table, self.scenario.folder, self.where)
        own = self.scenario.trajectory
        return made if isinstance(own, TrajectoryRecipe) else replace(made, trajectory=own)

    @cached_property
    def _plain(self) -> Scenario:
        return replace(self.scenario, vary={})

    @cached_property
    def _table(self) -> dict[str, Any]:
        from kreisel.study.document import table_of
        from kreisel.study.scenario import TrajectoryRecipe

        plain = self._plain
        if isinstance(plain.trajectory, TrajectoryRecipe):
            return table_of(plain)
        # Functions of time have no table: the rest of the scenario has one.
        table = table_of(replace(plain, trajectory=TrajectoryRecipe("rest")))
        table["trajectory"] = {"kind": "rest"}
        return table

    def _default(self, way: Way) -> Any:
        """What stands at `way` where the scenario says nothing, by the signature of what is made there."""
        if len(way) == 2 and way[0] == "trajectory":
            return _default_of(_trajectory(self._table["trajectory"]["kind"]), str(way[1]))
        if len(way) == 3 and way[0] == "filter":
            if way[2] == "start_error_deg":
                return [0.0, 0.0, 0.0]
            return _default_of(_filter(self._table["filter"][way[1]]["kind"]), str(way[2]))
        return None


def _default_of(make: Any, name: str) -> Any:
    found = inspect.signature(make).parameters.get(name) if make is not None else None
    value = None if found is None or found.default is found.empty else found.default
    return list(value) if isinstance(value, tuple) else value


def _trajectory(kind: str) -> Any:
    from kreisel.study.building import TRAJECTORIES

    known = kind in discovery.names(TRAJECTORIES)
    return getattr(discovery.load(TRAJECTORIES, kind), kind, None) if known else None


def _filter(kind: str) -> Any:
    from kreisel.study.building import FILTERS

    name = kind.replace("-", "_")
    return discovery.load(FILTERS, name).FILTER if name in discovery.names(FILTERS) else None
