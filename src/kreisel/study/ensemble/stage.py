"""Turns the scenario of a run into what it is run with, made once for all runs that share it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from threading import Lock
from typing import Any, TypeVar

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.estimate.abreast import SAMPLES
from kreisel.maths.kernels import argument
from kreisel.simulate.imu import Imu
from kreisel.simulate.many import Abreast
from kreisel.study.building import build
from kreisel.study.scenario import EnvironmentRecipe, Scenario, TrajectoryRecipe

# Of each kind, which covers a value chosen from a few; one that never comes again costs memory for nothing.
_KEPT = 8

Made = TypeVar("Made")


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """An IMU, what it would read without errors, and the motion of its sensor."""

    imu: Imu
    ideal: ImuRecording
    truth: Motion
    R_NS: Array  # (n, 9), the same attitude row by row
    abreast: Abreast  # what reads several runs at once

    @classmethod
    def of(cls, imu: Imu, motion: Motion) -> Seen:
        """What `imu` sees of a motion."""
        truth = motion.at(imu.mount)
        ideal = imu.ideal(motion)
        return cls(
            imu, ideal, truth, argument(truth.R_NB.reshape(-1, 9)), Abreast(imu, motion, ideal, SAMPLES)
        )


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """What runs of one scenario share, whatever is drawn for the noise."""

    motion: Motion
    seen: tuple[Seen, ...]  # one per IMU
    filters: tuple[Any, ...]  # AttitudeFilter


@dataclass(eq=False)
class Stages:
    """Stages by scenario: motions, ideal readings and filters are made again only where they differ."""

    _kept: OrderedDict[Hashable, Any] = field(default_factory=OrderedDict)
    _lock: Lock = field(default_factory=Lock)

    def __reduce__(self) -> tuple[type[Stages], tuple[()]]:
        # What was made once can be made again: it does not travel to other processes.
        return Stages, ()

    def of(self, scenario: Scenario) -> Stage:
        """The stage of a scenario, the same object for all that share it; ValueError where one cannot be made."""
        path = _path(scenario)
        # Where a filter begins is asked run by run.
        filters = [replace(recipe, start_error_deg=None) for recipe in scenario.filters]
        rest = repr((scenario.environment, filters, scenario.imus))
        return self._once(("stage", path, rest), lambda: self._made(scenario, path))

    def _made(self, scenario: Scenario, path: str) -> Stage:
        trajectory, motion = self._once(("motion", path), lambda: _motion(scenario))
        parts = build(replace(scenario, trajectory=trajectory))
        seen = [
            self._once(
                ("seen", path, repr((recipe, scenario.environment))),
                lambda imu=imu: Seen.of(imu, motion),  # type: ignore[misc]
            )
            for recipe, imu in zip(scenario.imus, parts.imus, strict=True)
        ]
        return Stage(motion, tuple(seen), tuple(filter for _, filter in parts.filters))

    def _once(self, key: Hashable, make: Callable[[], Made]) -> Made:
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                found: Made = self._kept[key]
                return found
        # Not under the lock: other threads make other things meanwhile.
        made = make()
        with self._lock:
            self._kept[key] = made
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return made


def _path(scenario: Scenario) -> str:
    trajectory: Any = scenario.trajectory
    if not isinstance(trajectory, TrajectoryRecipe):
        trajectory = id(trajectory)
    return repr((trajectory, scenario.start, scenario.duration, scenario.rate_hz))


def _motion(scenario: Scenario) -> tuple[Any, Motion]:
    parts = build(replace(scenario, imus=(), filters=(), environment=EnvironmentRecipe()))
    return parts.trajectory, parts.trajectory.sample(parts.t)
