"""What a study is to do, as a plain value: trajectory, IMUs, surroundings, filters and a seed.

The TOML file of a scenario, its keys and units are described in docs/scenarios.md.
"""

from __future__ import annotations

import datetime
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from kreisel.data.cards import Shown
from kreisel.data.checks import choice, file_name, finite_number, whole_number
from kreisel.data.trajectory import Trajectory
from kreisel.study.ensemble.distributions import distributions
from kreisel.study.values import Vector, calendar_day, plain, unlike, vector

Align = Literal["heading", "frame", "frame+sensor"]


@dataclass(frozen=True)
class TrajectoryRecipe:
    """A trajectory by the name of its plug-in, or "file", and the arguments it is made with."""

    kind: str
    parameters: Mapping[str, Any] = field(default_factory=dict)  # plain values

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", plain("parameters", dict(self.parameters)))


@dataclass(frozen=True)
class FilterRecipe:
    """A filter by the name of its plug-in, its tuning, and which constant offsets its errors are not to count."""

    kind: str
    tuning: Mapping[str, Any] = field(default_factory=dict)  # plain values
    name: str = ""  # in reports and file names; the kind where it is left out
    align: Align | None = None  # what is fitted and removed before errors count, as `attitude_errors` has it
    clock_offset: float | Literal["estimate"] = 0.0  # s, by which the estimate's stamps are ahead
    start_error_deg: Vector | None = (
        None  # roll, pitch, heading: it begins so far off the truth; None: by itself
    )

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "tuning", plain("tuning", dict(self.tuning)))
        put(self, "name", file_name("name", self.name or self.kind))
        if self.align is not None:
            choice("align", self.align, get_args(Align))
        if self.clock_offset != "estimate":
            put(self, "clock_offset", finite_number("clock_offset", self.clock_offset))
        if self.start_error_deg is not None:
            put(self, "start_error_deg", vector("start_error_deg", self.start_error_deg))


@dataclass(frozen=True)
class EffectRecipe:
    """An effect of one sensor by the name of its plug-in, the arguments it is made with, and its place among others."""

    sensor: Literal["gyro", "accel", "mag"]
    kind: str
    parameters: Mapping[str, Any] = field(default_factory=dict)  # plain values
    before: str | None = None  # the effect, by name, before which it acts; None: its place in physical order
    after: str | None = None  # or behind which

    def __post_init__(self) -> None:
        choice("sensor", self.sensor, ("gyro", "accel", "mag"))
        object.__setattr__(self, "parameters", plain("parameters", dict(self.parameters)))


@dataclass(frozen=True)
class ImuRecipe:
    """Where an IMU sits on the body, how it is turned, which sensor it is, and what is wrong with that beside."""

    name: str = "imu"  # in reports and file names
    p_BS: Vector = (0.0, 0.0, 0.0)  # m, lever arm in B
    rotation_deg: Vector = (0.0, 0.0, 0.0)  # turn of S against B about x, y, z: R_BS = Rz Ry Rx
    sensor: str | None = None  # a preset, a preset file or kalibr's; None: a perfect one
    datasheet: Mapping[str, Any] = field(default_factory=dict)  # numbers in place of the sensor's, or beside
    clock: Mapping[str, Any] = field(default_factory=dict)  # by the names of Clock, and rate_offset_ppm
    temperature: float | str | tuple[tuple[float, float], ...] | None = (
        None  # deg C; a file; or (s, deg C) each
    )
    effects: tuple[EffectRecipe, ...] = ()  # beside those of the sensor

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", file_name("name", self.name))
        put(self, "p_BS", vector("p_BS", self.p_BS))
        put(self, "rotation_deg", vector("rotation_deg", self.rotation_deg))
        for name in ("datasheet", "clock"):
            put(self, name, plain(name, dict(getattr(self, name))))
        put(self, "temperature", plain("temperature", self.temperature))
        put(self, "effects", tuple(self.effects))


@dataclass(frozen=True)
class DisturbanceRecipe:
    """A disturbance of the magnetic field by the name of its plug-in, and the arguments it is made with."""

    kind: str
    parameters: Mapping[str, Any] = field(default_factory=dict)  # plain values

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", plain("parameters", dict(self.parameters)))


@dataclass(frozen=True)
class EnvironmentRecipe:
    """What surrounds the body: what is given, and for the rest what the place and the date have."""

    gravity: float | None = None  # m/s^2, downwards; None: that of the place, 9.80665 without one
    field_N_uT: Vector | None = None  # in N: east, true north, up; None: the model's on `date`, none without
    declination_deg: float | None = None  # what filters are told, east positive; None: that of the field
    latitude_deg: float | None = None  # of the origin of N: WGS 84, north positive
    longitude_deg: float | None = None  # east positive
    height_m: float | None = None  # above the ellipsoid; None: 0
    date: datetime.date | None = None  # also as text, "2026-05-01"
    turning: bool = False  # whether N turns with the Earth
    disturbances: tuple[DisturbanceRecipe, ...] = ()  # of the magnetic field

    def __post_init__(self) -> None:
        put = object.__setattr__
        for name in ("gravity", "declination_deg", "latitude_deg", "longitude_deg", "height_m"):
            if getattr(self, name) is not None:
                put(self, name, finite_number(name, getattr(self, name)))
        if self.gravity is not None and self.gravity < 0.0:
            raise ValueError(f"gravity must be 0 or more, m/s^2: it counts downwards; got {self.gravity:g}.")
        if self.field_N_uT is not None:
            put(self, "field_N_uT", vector("field_N_uT", self.field_N_uT))
        if self.date is not None:
            put(self, "date", calendar_day("date", self.date))
        put(self, "disturbances", tuple(self.disturbances))
        self._check_place()

    def _check_place(self) -> None:
        if (self.latitude_deg is None) != (self.longitude_deg is None):
            raise ValueError("a place needs both latitude_deg and longitude_deg; got one of them.")
        for name in ("height_m", "date", "turning"):
            if self.latitude_deg is None and getattr(self, name) not in (None, False):
                raise ValueError(f"{name} says nothing without a place; give latitude_deg and longitude_deg.")
        if self.date is not None and self.field_N_uT is not None:
            raise ValueError(
                "date and field_N_uT both say what the magnetic field is; leave one of them out."
            )
        if self.disturbances and self.date is None and self.field_N_uT is None:
            raise ValueError(
                "there is no magnetic field to disturb; give field_N_uT, or a date and latitude_deg, longitude_deg."
            )


@dataclass(frozen=True)
class Scenario(Shown):
    """A recipe from which `study.run` makes the same result every time.

    Round-trips through TOML, but for a trajectory that is an object rather than a recipe.
    """

    trajectory: TrajectoryRecipe | Trajectory
    duration: float | None = None  # s; None: to the end of the trajectory
    rate_hz: float | None = None  # of the IMUs; None: the times of the file
    start: float | None = None  # s; None: where the trajectory begins, 0 if it always was
    name: str = ""
    seed: int = 0
    imus: tuple[ImuRecipe, ...] = (ImuRecipe(),)
    environment: EnvironmentRecipe = EnvironmentRecipe()
    filters: tuple[FilterRecipe, ...] = ()
    folder: Path = field(default=Path(), compare=False)  # where relative paths of files begin
    run: int = 0  # number of the run among those of one seed
    vary: Mapping[str, Any] = field(default_factory=dict)  # path -> what `monte_carlo` draws it from

    def __post_init__(self) -> None:
        put = object.__setattr__
        for name in ("duration", "rate_hz"):
            if getattr(self, name) is not None:
                put(self, name, finite_number(name, getattr(self, name), above=0.0))
        if self.start is not None:
            put(self, "start", finite_number("start", self.start))
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0:
            raise ValueError(f"seed must be a whole number, 0 or more; got {self.seed!r}.")
        put(self, "run", whole_number("run", self.run))
        put(self, "vary", distributions(self.vary))
        put(self, "imus", unlike("imu", tuple(self.imus)))
        put(self, "filters", unlike("filter", tuple(self.filters)))
        put(self, "folder", Path(self.folder))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scenario:
        """The scenario in a TOML file; relative paths in it begin at its folder.

        Raises ValueError with file and key, one sentence, for anything that cannot be run, OSError for no file.
        """
        from kreisel.study.document import load

        return load(Path(path))

    @classmethod
    def from_toml(cls, text: str, folder: str | os.PathLike[str] = ".", source: str = "scenario") -> Scenario:
        """The scenario that `text` writes; `source` is what errors call it. Raises as `load` does."""
        from kreisel.study.document import parse

        return parse(text, Path(folder), source)

    def to_toml(self) -> str:
        """The text that `from_toml` makes this scenario of again. Raises ValueError for a trajectory of functions."""
        from kreisel.study.document import text

        return text(self)
