"""Turns an Account into the lines of its charts: thinned so that every peak is kept, packed for the page.

A line is named after its chart: "gyro.x". Lines come in three layers (of the motion, of each IMU, of each
answer), and the page lays one of each over another.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kreisel.data.attitude import Reference
from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.maths.rotations import euler_from_matrix
from kreisel.show.series import value_limits
from kreisel.show.thinning import drawable
from kreisel.study.account import Account, Answer, Reading, body_path, sensor_attitude

# A chart is at most some 700 pixels wide, 1400 where pixels are fine.
_COLUMNS, _FEWEST_COLUMNS = 1200, 250

# Of all lines together: 2.8 MB as text. Four to a column, two floats of four bytes each.
_MOST_POINTS = 260_000
_LINES_OF_MOTION, _LINES_OF_READING, _LINES_OF_ANSWER = 9, 15, 8

# A step between neighbours beyond this is a wrap, or the flip at phi_y = +-90 deg, rather than a turn.
_WRAP_DEG = 120.0

# A chart of errors follows the errors themselves; a start this many times worse would flatten them.
_OFF_THE_SCALE = 6.0

Packed = dict[str, Any]


@dataclass(slots=True)
class Layer:
    """Lines by their names, and the limits of the charts they are in."""

    lines: dict[str, Packed] = field(default_factory=dict)
    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    beyond: dict[str, float] = field(
        default_factory=dict
    )  # chart -> largest value, where outside of its limits


@dataclass(frozen=True, slots=True)
class Timeline:
    """The clock of a page, and how finely its lines are drawn."""

    t0_ns: int  # epoch of its zero
    start: float  # s
    end: float  # s
    columns: int

    def at(self, t: Array, t0_ns: int) -> Array:
        """Times (n,) s on this clock, from times after another epoch."""
        # Epochs are subtracted as integers: as floats they would be rounded to 128 ns.
        return np.asarray(t + (t0_ns - self.t0_ns) / 1e9)


def timeline(account: Account) -> Timeline:
    """From the first sample of anything to the last, on the clock of the truth or else of the first recording."""
    # Any: all have t and t0_ns, which no common type says.
    sources: list[Any] = [account.truth, *(reading.recording for reading in account.readings)]
    sources += [answer.attitude for answer in account.answers]
    every = [source for source in sources if source is not None and len(source)]
    if not every:
        raise ValueError("there is nothing to report: no source has a sample.")
    t0_ns = every[0].t0_ns
    shifts = [(source.t0_ns - t0_ns) / 1e9 for source in every]
    spans = [(s.t[0] + shift, s.t[-1] + shift) for s, shift in zip(every, shifts, strict=True)]
    lines = _LINES_OF_MOTION + _LINES_OF_READING * len(account.readings)
    lines += _LINES_OF_ANSWER * len(account.answers)
    columns = int(np.clip(_MOST_POINTS // (4 * lines), _FEWEST_COLUMNS, _COLUMNS))
    return Timeline(
        t0_ns, float(min(first for first, _ in spans)), float(max(last for _, last in spans)), columns
    )


def motion_layer(account: Account, on: Timeline) -> Layer:
    """Position, velocity and acceleration in N, where the truth has them."""
    layer, truth = Layer(), body_path(account.truth)
    if truth is None:
        return layer
    t = on.at(truth.t, truth.t0_ns)
    columns = {"position": truth.p_NB, "velocity": truth.v_NB}
    columns |= {"acceleration": truth.a_NB} if isinstance(truth, Motion) else {}
    for chart, values in columns.items():
        if values is not None:
            _add(layer, on, chart, t, values)
            _limit(layer, chart, values)
    return layer


def reading_layer(account: Account, reading: Reading, on: Timeline) -> Layer:
    """Gyro, accelerometer, magnetometer, and what is true of this sensor: its attitude and its gyro bias."""
    layer, recording = Layer(), reading.recording
    t = on.at(recording.t, recording.t0_ns)
    for chart, values in (("gyro", recording.gyro), ("accel", recording.accel), ("mag", recording.mag_uT)):
        if values is not None:
            _add(layer, on, chart, t, values)
            _limit(layer, chart, values)
    truth = _true_angles(account, reading)
    if truth is not None:
        seen, angles = truth
        _add(layer, on, "attitude", on.at(seen.t, seen.t0_ns), angles, "true_", _WRAP_DEG)
        _limit(layer, "attitude", angles)
    if reading.gyro_bias is not None:
        bias = np.rad2deg(reading.gyro_bias)
        _add(layer, on, "bias", t, bias, "true_")
        _limit(layer, "bias", bias)
    return layer


def answer_layer(account: Account, reading: Reading, answer: Answer, on: Timeline) -> Layer:
    """Estimated attitude and gyro bias, and the errors of the attitude."""
    layer, found = Layer(), answer.attitude
    t = on.at(found.t, found.t0_ns)
    angles, truth = np.rad2deg(found.euler), _true_angles(account, reading)
    _add(layer, on, "attitude", t, angles, jump=_WRAP_DEG)
    _limit(layer, "attitude", angles, *([] if truth is None else [truth[1]]))
    if found.gyro_bias is not None:
        bias = np.rad2deg(found.gyro_bias)
        true_bias = [] if reading.gyro_bias is None else [np.rad2deg(reading.gyro_bias)]
        _add(layer, on, "bias", t, bias)
        _limit(layer, "bias", bias, *true_bias)
    if answer.errors is not None:
        _add_errors(layer, on, answer)
    return layer


def _add_errors(layer: Layer, on: Timeline, answer: Answer) -> None:
    """Heading and inclination error of the samples that count."""
    errors = answer.errors
    assert errors is not None
    t = on.at(errors.t, errors.t0_ns)
    seen = []
    for name in ("heading", "inclination"):
        values = np.where(errors.counts, np.rad2deg(getattr(errors, name)), np.nan)
        layer.lines[f"errors.{name}"] = packed_line(t, values, on, _WRAP_DEG)
        seen.append(values[np.isfinite(values)])
    # An axis that holds the start of a filter that began wrong would show nothing else.
    tops = [_OFF_THE_SCALE * float(np.percentile(np.abs(s), 95.0)) if s.size else 0.0 for s in seen]
    top, peak = max(tops), max(float(np.abs(s).max(initial=0.0)) for s in seen)
    _limit(layer, "errors", *(s[np.abs(s) <= top] for s in seen), np.zeros(1))
    if peak > top:
        layer.beyond["errors"] = peak


def _true_angles(account: Account, reading: Reading) -> tuple[Reference, Array] | None:
    """The true attitude of the sensor and its Euler angles (n, 3), deg."""
    if account.truth is None or getattr(account.truth, "R_NB", True) is None:
        return None
    seen = sensor_attitude(account.truth, reading.mount)
    angles = np.full((len(seen), 3), np.nan)
    angles[seen.counts] = np.rad2deg(euler_from_matrix(seen.R_NS[seen.counts]))
    return seen, angles


def _add(
    layer: Layer, on: Timeline, chart: str, t: Array, values: Array, prefix: str = "", jump: float = np.inf
) -> None:
    """A line for each of the three columns of `values` (n, 3)."""
    for axis, column in zip("xyz", values.T, strict=True):
        layer.lines[f"{chart}.{prefix}{axis}"] = packed_line(t, column, on, jump)


def _limit(layer: Layer, chart: str, *values: Array) -> None:
    seen = np.concatenate([v[np.isfinite(v)].ravel() for v in values])
    low, high = (float(seen.min()), float(seen.max())) if seen.size else (0.0, 0.0)
    layer.limits[chart] = value_limits(low, high)


def packed_line(t: Array, y: Array, on: Timeline, jump: float = np.inf) -> Packed:
    """Samples (n,) as the page takes them, thinned; times after its start and values about `y0`, in single precision.

    So taken, a path far from its origin or a clock far from zero loses no digit that could be seen.
    """
    at, values = drawable(t, y, jump, on.columns)
    finite = values[np.isfinite(values)]
    y0 = 0.5 * float(finite.min() + finite.max()) if finite.size else 0.0
    return {"t": packed(at - on.start), "y": packed(values - y0), "y0": y0}


def packed(values: Array | Sequence[float]) -> str:
    """Numbers as text: base64 of single precision, lowest byte first."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")
