"""Turns an Account into the tables of its page: errors of every filter, the scenario in a few rows, every key of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.evaluate.attitude_errors import Summary
from kreisel.show.report.lines import Timeline
from kreisel.study.account import Account, Reading

Fact = tuple[str, str]

_NOTES_SHOWN = 6


def errors_table(account: Account) -> list[tuple[str, ...]]:
    """A row for each answer: its name, RMSE of total, heading and inclination, largest total, convergence."""
    rows = []
    for answer in account.answers:
        name = answer.filter if len(account.readings) == 1 else f"{answer.imu}, {answer.filter}"
        rows.append((name, *(["–"] * 5 if answer.errors is None else _cells(answer.errors.summary()))))
    return rows


def _cells(s: Summary) -> list[str]:
    numbers = (s.total_rmse_deg, s.heading_rmse_deg, s.inclination_rmse_deg, s.total_max_deg)
    since = "never" if s.convergence_time_s is None else f"{s.convergence_time_s:.4g} s"
    return [*(f"{x:#.3g}".rstrip(".") for x in numbers), since]


def facts(account: Account, on: Timeline) -> list[Fact]:
    """The run in a few rows: what moved, what was on it, what surrounded it, which filters looked."""
    scenario: Mapping[str, Any] = account.report.get("scenario", {})
    return [
        *_motion(account, scenario, on),
        *_imus(account.readings, scenario),
        *_surroundings(scenario.get("environment", {})),
        *_filters(account, scenario),
        *([("seed", str(scenario["seed"]))] if scenario else []),
    ]


def _motion(account: Account, scenario: Mapping[str, Any], on: Timeline) -> Iterator[Fact]:
    if scenario:
        yield "trajectory", scenario["trajectory"]["kind"]
    yield "time", f"{on.start:.6g} to {on.end:.6g} s"
    truth = account.truth
    if isinstance(truth, Motion) and len(truth):
        speed = np.linalg.norm(truth.v_NB, axis=1)
        turn = np.rad2deg(np.linalg.norm(truth.omega_NB_B, axis=1))
        yield "speed", f"up to {_plain(speed.max())} m/s"
        yield "turning", f"up to {_plain(turn.max())} deg/s"


def _imus(readings: Sequence[Reading], scenario: Mapping[str, Any]) -> Iterator[Fact]:
    sensors = {imu["name"]: imu["sensor"] or "ideal" for imu in scenario.get("imus", ())}
    for reading in readings:
        name, recording = reading.mount.name, reading.recording
        parts = [sensors[name]] if name in sensors else []
        parts.append(f"{len(recording)} samples" + _rate(recording.t))
        if reading.mount.p_BS.any():
            parts.append(f"at {_triple(1e3 * reading.mount.p_BS)} mm in the body")
        if not np.array_equal(reading.mount.R_BS, np.eye(3)):
            parts.append("turned against it")
        yield f"IMU {name}" if name != "imu" else "IMU", ", ".join(parts)


def _rate(t: Array) -> str:
    return f" at {1.0 / np.median(np.diff(t)):.4g} Hz" if len(t) > 1 else ""


def _surroundings(environment: Mapping[str, Any]) -> Iterator[Fact]:
    if not environment:
        return
    if environment["latitude_deg"] is not None:
        date = f" on {environment['date']}" if environment["date"] else ""
        yield "place", f"{environment['latitude_deg']:g} N, {environment['longitude_deg']:g} E{date}"
    yield "gravity", f"{environment['gravity']:.6g} m/s², down"
    if environment["turning"]:
        yield "frame N", "turns with the Earth"
    field = environment["field_N_uT"]
    if field is None:
        return
    yield "magnetic field", f"{_triple(field)} µT east, north, up"
    yield "declination told", f"{environment['declination_deg']:.3g} deg"
    if environment["disturbances"]:
        yield "disturbed by", ", ".join(each["kind"] for each in environment["disturbances"])


def _filters(account: Account, scenario: Mapping[str, Any]) -> Iterator[Fact]:
    for filter in scenario.get("filters", ()):
        tuning = [f"{key} = {value}" for key, value in filter["tuning"].items()]
        kind = [] if filter["name"] == filter["kind"] else [filter["kind"]]
        yield f"filter {filter['name']}", ", ".join([*kind, *(tuning or ["defaults"])])
    for answer in account.answers:
        if answer.errors is not None and answer.errors.align is not None:
            yield (
                f"{answer.imu}, {answer.filter}",
                f"errors without a constant offset of {answer.errors.align}",
            )


def _plain(value: float) -> str:
    """Three digits that count, but 1270 rather than 1.27e+03."""
    return f"{float(f'{value:.3g}'):g}"


def _triple(values: Array | Sequence[float]) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in values) + ")"


def notes(account: Account) -> list[str]:
    """What a user should know about how the motion came to be: the first few, and how many more."""
    found = account.truth.notes if isinstance(account.truth, Motion) else ()
    shown = [n.text if n.t is None else f"At {n.t:.6g} s: {n.text}" for n in found[:_NOTES_SHOWN]]
    return [*shown, f"… and {len(found) - _NOTES_SHOWN} more."] if len(found) > _NOTES_SHOWN else shown


def every_key(value: Any, name: str = "") -> Iterator[Fact]:
    """Every value of a scenario under its full name, in the order of the scenario; what was left out is left out."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from every_key(item, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list) and any(isinstance(item, Mapping) for item in value):
        for k, item in enumerate(value):
            yield from every_key(item, f"{name}[{k}]")
    elif value not in (None, "", [], {}):
        yield name, ", ".join(map(str, value)) if isinstance(value, list) else str(value)
