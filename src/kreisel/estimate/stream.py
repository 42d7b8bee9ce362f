"""Turns samples that come in one by one into attitude, and a stream that has stopped into one that goes on."""

from __future__ import annotations

import dataclasses
import difflib
import json
import os
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np
import numpy.typing as npt

from kreisel import discovery
from kreisel.atomic import replacing
from kreisel.data.archive import arrays_in
from kreisel.data.checks import read_only
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.estimate import filters as at
from kreisel.estimate.answers import Columns, show
from kreisel.estimate.filters import Array, AttitudeFilter, KnowingFilter
from kreisel.maths.kinematics import linear_acceleration

FILTERS = "kreisel.estimate.filters"
VERSION = 1
_SCHEMA = "kreisel_schema"
_MEMBERS = ("filter", "tuning", "state_version", "state", "sample")


class Snapshot(NamedTuple):
    """What a stream knows after its latest sample; it does not change when the stream goes on."""

    R_NS: Array  # (3, 3)
    gyro_bias: Array  # (3,) rad/s, in S
    a_N: Array  # (3,) m/s^2, acceleration in N without gravity, of the latest sample alone
    heading_offset: float  # rad, what the magnetometer has turned the attitude by, about up
    rest: bool  # the sensor is taken to be at rest
    disturbed: bool  # the magnetometer is not trusted
    held: bool  # the gyro's sample was missing, or nothing has shown yet which way is up


class Stream:
    """A filter that is fed sample by sample; its answers equal those of `run` bit for bit."""

    __slots__ = ("_filter", "_parameters", "_sample", "_state")

    def __init__(self, filter: AttitudeFilter, R_NS: Array | None = None) -> None:
        self._filter = filter
        self._parameters = filter.parameters()
        self._state = filter.start(R_NS)
        self._sample = np.full(9, np.nan)

    def update(
        self, gyro: npt.ArrayLike, accel: npt.ArrayLike, mag_uT: npt.ArrayLike | None = None, *, dt: float
    ) -> None:
        """Take in samples (3,) of rad/s, m/s^2 and uT that end `dt` seconds after the ones before.

        A NaN is a missing sample, None a magnetometer without one; dt = 0 changes nothing but a stream that has
        not begun. Raises ValueError where time runs back or a sample does not have three numbers.
        """
        if not dt >= 0.0:
            raise ValueError(f"dt must be >= 0 s; got {dt}. Time must not run back: sort the samples.")
        sample = self._sample
        sample[0:3] = gyro
        sample[3:6] = accel
        sample[6:9] = np.nan if mag_uT is None else mag_uT
        self._filter.update(self._state, self._parameters, sample, float(dt))

    @property
    def filter(self) -> AttitudeFilter:
        """The filter with its tuning."""
        return self._filter

    @property
    def R_NS(self) -> Array:
        """(3, 3) attitude after the latest sample."""
        return self.snapshot().R_NS

    @property
    def gyro_bias(self) -> Array:
        """(3,) rad/s."""
        return self.snapshot().gyro_bias

    @property
    def a_N(self) -> Array:
        """(3,) m/s^2, acceleration in N without gravity of the latest sample, not smoothed; NaN without one."""
        return self.snapshot().a_N

    @property
    def heading_offset(self) -> float:
        """What the magnetometer has turned the attitude by, about up, rad."""
        return float(self._state[at.HEADING])

    @property
    def sigma(self) -> Array | None:
        """(3,) rad, standard deviation of the attitude error about N axes; None where the filter does not know it."""
        if not isinstance(self._filter, KnowingFilter):
            return None
        return read_only(self._state[self._filter.sigma : self._filter.sigma + 3].copy())

    @property
    def rest(self) -> bool:
        """The sensor is taken to be at rest."""
        return bool(int(self._state[at.FLAGS]) & at.REST)

    @property
    def disturbed(self) -> bool:
        """The magnetometer is not trusted."""
        return bool(int(self._state[at.FLAGS]) & at.DISTURBED)

    @property
    def held(self) -> bool:
        """The gyro's sample was missing, or nothing has shown yet which way is up."""
        return bool(int(self._state[at.FLAGS]) & at.HELD)

    def snapshot(self) -> Snapshot:
        """Everything that is known now, as a value of its own."""
        out = Columns.of((1,), bias=True)
        show(self._state, out)
        a_N = linear_acceleration(out.R_NS, self._sample[None, 3:6], STANDARD_GRAVITY)
        R_NS, gyro_bias, a_N = (read_only(column[0]) for column in (out.R_NS, out.gyro_bias, a_N))
        flags = (bool(column[0]) for column in (out.rest, out.disturbed, out.held))
        return Snapshot(R_NS, gyro_bias, a_N, self.heading_offset, *flags)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write filter, tuning and state to an NPZ archive, the whole file or none, from which `load` goes on.

        Raises ValueError for a filter that is not one of ours, by whose name `load` could find it again.
        """
        module = discovery.load(FILTERS, _name_of(self._filter))
        arrays = {
            "filter": np.array(_name_of(self._filter)),
            "tuning": np.array(json.dumps(dataclasses.asdict(self._filter))),  # type: ignore[call-overload]
            "state_version": np.array(module.STATE_VERSION),
            "state": self._state,
            "sample": self._sample,
        }
        with replacing(path) as out:
            line = f"Stream {VERSION}: {' '.join(arrays)}"
            np.savez(out, allow_pickle=False, **{_SCHEMA: np.array(line)}, **arrays)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Stream:
        """The stream as it was when it was saved: it goes on with the bits it would have had without a stop.

        Raises ValueError for a file that is not one of `save`, or one of a version with another state.
        """
        arrays = _archive(path)
        name = str(arrays["filter"])
        try:
            module = discovery.load(FILTERS, name)
            filter = _tuned(module.FILTER, json.loads(str(arrays["tuning"])))
        except (ValueError, TypeError) as error:
            raise ValueError(f"{path}: {error}") from None
        stream = cls(filter)
        same = int(arrays["state_version"]) == module.STATE_VERSION
        for own, name in ((stream._state, "state"), (stream._sample, "sample")):
            if not same or arrays[name].shape != own.shape or arrays[name].dtype != own.dtype:
                raise ValueError(
                    f"{path} holds a state that this version's filter {arrays['filter']} does not have. "
                    "Load it with the version of kreisel that saved it, or start anew."
                )
            own[:] = arrays[name]
        return stream


def _name_of(filter: AttitudeFilter) -> str:
    """The plug-in whose FILTER made `filter`."""
    name = type(filter).__module__.removeprefix(FILTERS + ".").split(".")[0]
    if name not in discovery.names(FILTERS) or type(filter) is not discovery.load(FILTERS, name).FILTER:
        raise ValueError(
            f"only filters in {FILTERS} can be saved, for they are found again by name; got "
            f"{type(filter).__name__} of {type(filter).__module__}."
        )
    return name


def _tuned(make: Any, tuning: dict[str, Any]) -> AttitudeFilter:
    """`make(**tuning)`, with a dataclass in place of each table in it."""
    known = {field.name for field in dataclasses.fields(make)}
    for key in tuning.keys() - known:
        near = difflib.get_close_matches(key, known, n=1)
        raise ValueError(
            f"{make.__name__} has no {key!r} in this version{f', but {near[0]!r}' if near else ''}."
        )
    hints = get_type_hints(make)
    made = dict(tuning)
    for key, table in tuning.items():
        if isinstance(table, dict):
            inner = next(a for a in get_args(hints[key]) if dataclasses.is_dataclass(a))
            made[key] = _tuned(inner, table)
    tuned: AttitudeFilter = make(**made)
    return tuned


def _archive(path: str | os.PathLike[str]) -> dict[str, npt.NDArray[Any]]:
    """The arrays of a saved stream; ValueError where the file is something else or cut off."""
    refusal = f"{os.fspath(path)} is not a stream that Stream.save has written"
    try:
        arrays = arrays_in(path)
    except ValueError as error:
        raise ValueError(f"{refusal}: {error}") from None
    line = str(arrays.get(_SCHEMA, "nothing"))
    noun, _, version = line.partition(":")[0].partition(" ")
    if noun != "Stream":
        raise ValueError(f"{refusal}: it holds {noun}. Recordings and attitudes are read by kreisel.read.")
    if not version.isdigit() or int(version) > VERSION:
        raise ValueError(
            f"{path}: written as stream {version!r}; this version of kreisel reads up to {VERSION}."
        )
    missing = [name for name in _MEMBERS if name not in arrays]
    if missing:
        raise ValueError(f"{refusal}: array {missing[0]!r} is missing.")
    return arrays
