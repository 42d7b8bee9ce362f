"""Turns any noun into plain facts about it: rows, rate, gaps, extent, and what its units look like."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.checks import Array
from kreisel.data.increments import ImuIncrements
from kreisel.data.median import RunningMedian
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.maths.rotations import log_so3

# A lost sample doubles one step; jitter of real clocks stays well below half a step.
_GAP = 1.5

# rad/s; 2000 deg/s is the widest range of common gyros.
_FASTEST_GYRO = 35.0

# Share of samples that may be wild before it is the unit's fault rather than theirs.
_FAULTS = 1e-3

_GAUSS_IN_UT = 100.0


@dataclass(frozen=True, slots=True)
class Gap:
    """A step in time long enough for samples to be missing."""

    t: float  # s, of the last sample before it
    length: float  # s


@dataclass(frozen=True, slots=True)
class Clock:
    """The time axis of a noun."""

    rows: int
    t0_ns: int
    start: float  # s
    span: float  # s
    step: float  # s, median; nan for one row
    jitter: float  # s, standard deviation of the steps that are no gaps
    gaps: tuple[Gap, ...]

    @property
    def rate_hz(self) -> float:
        """Samples per second, by the median step."""
        return 1.0 / self.step


@dataclass(frozen=True, slots=True)
class Facts:
    """What a noun holds, its numbers in SI units, and sentences about what looks odd."""

    noun: str  # name of its type
    clock: Clock
    holds: tuple[str, ...]
    numbers: dict[str, float] = field(default_factory=dict)  # name with unit -> value
    doubts: tuple[str, ...] = ()


def facts(data: Poses | Motion | ImuRecording | ImuIncrements | AttitudeHistory | Reference) -> Facts:
    """Facts about `data`; nothing is changed and nothing refused."""
    clock = clock_of(data.t, data.t0_ns)
    if isinstance(data, AttitudeHistory | Reference):
        numbers = _attitude_numbers(data)
        return Facts(
            type(data).__name__, clock, _attitude_contents(data), numbers, tuple(_jump_doubts(numbers))
        )
    if isinstance(data, ImuRecording):
        return Facts("ImuRecording", clock, _imu_contents(data), _imu_numbers(data), tuple(unit_doubts(data)))
    if isinstance(data, ImuIncrements):
        contents = ["turn", "velocity", *([] if data.dp is None else ["position"])]
        means = data.mean_rates()
        doubts = unit_doubts(means) if len(data) else []
        return Facts("ImuIncrements", clock, tuple(contents), _sum_numbers(means), tuple(doubts))
    contents = ["position"]
    contents += ["attitude"] if data.R_NB is not None else []
    contents += ["velocity"] if data.v_NB is not None else []
    contents += ["accelerations and rates"] if isinstance(data, Motion) else []
    numbers = _pose_numbers(data)
    return Facts(type(data).__name__, clock, tuple(contents), numbers, tuple(_pose_doubts(data, numbers)))


def clock_of(t: Array, t0_ns: int) -> Clock:
    """Rate, jitter and gaps of stamps `t` (n,) s."""
    steps = np.diff(t)
    step = float(np.median(steps)) if steps.size else float("nan")
    long = steps > _GAP * step
    jitter = float(np.std(steps[~long])) if steps.size else float("nan")
    gaps = tuple(Gap(float(t[k]), float(steps[k])) for k in np.flatnonzero(long))
    return Clock(len(t), t0_ns, float(t[0]), float(t[-1] - t[0]), step, jitter, gaps)


def unit_doubts(recording: ImuRecording) -> list[str]:
    """Sentences about units and axes that look wrong, each naming the likely one; empty if none."""
    return Units.of(recording).doubts()


def impossible_units(recording: ImuRecording) -> list[str]:
    """Those of the doubts that make every attitude wrong: units of the accelerometer and the gyroscope."""
    return Units.of(recording).impossible()


_FEWEST_STAMPS = 10
_TIMES = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}


class Units:
    """What the numbers of a recording say of their units, gathered from all of its blocks."""

    def __init__(self) -> None:
        self._force, self._field = RunningMedian(), RunningMedian()
        self._rates = self._fast = 0
        self._fastest = 0.0
        self._rows, self._sum = 0, np.zeros(3)
        self._stamps, self._first, self._last = 0, np.nan, np.nan
        self._mag = False

    @classmethod
    def of(cls, recording: ImuRecording) -> Units:
        """Of a recording in one piece."""
        units = cls()
        units.add(recording)
        return units

    def add(self, block: ImuRecording) -> None:
        """Take in one more block."""
        if len(block):
            self._first = self._first if self._stamps else float(block.t[0])
            self._stamps, self._last = self._stamps + len(block), float(block.t[-1])
        self._force.add(_norms(block.accel))
        rates = _norms(block.gyro)
        self._rates += rates.size
        self._fast += int((rates > _FASTEST_GYRO).sum())
        self._fastest = max(self._fastest, float(rates.max(initial=0.0)))
        rows = block.accel[np.isfinite(block.accel).all(axis=1)]
        self._rows += len(rows)
        self._sum += rows.sum(axis=0)
        if block.mag_uT is not None:
            self._mag = True
            self._field.add(_norms(block.mag_uT))

    def impossible(self) -> list[str]:
        """Sentences about what makes every attitude wrong."""
        doubts = []
        force = self._force.value()
        for unit, one in (("g", 1.0), ("mg or cm/s^2", 1e3)):
            # Rest or ordinary movement keeps the median within a quarter of gravity.
            if 0.75 * one < force < 1.25 * one:
                doubts.append(
                    f"the accelerometer's median is {force:.4g}: it looks like {unit}, where m/s^2 is expected."
                )
        # A handful are faults in a recording of any length.
        if self._fast > max(5.0, _FAULTS * self._rates):
            doubts.append(
                f"the gyroscope reaches {self._fastest:.4g} rad/s: it looks like deg/s, where rad/s is expected."
            )
        return doubts

    def silent(self) -> list[str]:
        """The sensors of which not one row is a reading."""
        readings = {"gyroscope": self._rates, "accelerometer": self._rows}
        return [name for name, count in readings.items() if count == 0]

    def doubts(self) -> list[str]:
        """Sentences about everything that looks wrong."""
        doubts = self.impossible()
        # A few such samples may be faults.
        if self._fastest > _FASTEST_GYRO and not any(doubt.startswith("the gyro") for doubt in doubts):
            doubts.append(f"the gyroscope reaches {self._fastest:.4g} rad/s: faults, or deg/s?")
        if self._mag:
            doubts += _field_doubts(self._field.value())
        if self._rows and self._force.value() == 0.0:
            doubts.append("the accelerometer reads zero: it is dead, or fell freely all the time.")
        return doubts + self._axis_doubts() + self._time_doubts()

    def _time_doubts(self) -> list[str]:
        if self._stamps < _FEWEST_STAMPS:
            return []
        step = (self._last - self._first) / (self._stamps - 1)
        # No IMU is as slow as one sample a second, nor as fast as 50 kHz.
        units = [unit for unit, one in _TIMES.items() if 2e-5 < step * one < 1.0]
        if 2e-5 < step < 1.0 or not units:
            return []
        return [f"a sample comes every {step:.4g} s: stamps in {units[0]}, where s are expected?"]

    def _axis_doubts(self) -> list[str]:
        if self._rows == 0:
            return []
        mean, force = self._sum / self._rows, self._force.value()
        # Within 25 degrees of straight down, as a level z-down sensor reads: nothing else looks like it but
        # an IMU mounted upside down.
        if mean[2] < -0.9 * np.linalg.norm(mean) and np.linalg.norm(mean) > 0.5 * force:
            return [
                "the mean specific force points along -z: z-down axes (--frame ned-frd), "
                "or a sensor mounted upside down."
            ]
        return []


def _field_doubts(strength: float) -> list[str]:
    # The Earth's field is 22 to 67 uT; buildings bend it by a few tens of per cent.
    for unit, one in (("gauss", _GAUSS_IN_UT), ("mgauss", 0.1), ("nT", 1e-3), ("T", 1e6), ("mT", 1e3)):
        if 15.0 < strength * one < 100.0:
            return [
                f"the magnetometer's median is {strength:.4g}: it looks like {unit}, where uT is expected."
            ]
    return []


def _imu_contents(data: ImuRecording) -> tuple[str, ...]:
    return ("gyroscope", "accelerometer", *(() if data.mag_uT is None else ("magnetometer",)))


def _imu_numbers(data: ImuRecording) -> dict[str, float]:
    missing = ~(np.isfinite(data.gyro).all(axis=1) & np.isfinite(data.accel).all(axis=1))
    numbers = {
        "missing rows": float(missing.sum()),
        "gyroscope median rad/s": _median_norm(data.gyro),
        "gyroscope largest rad/s": _largest_norm(data.gyro),
        "accelerometer median m/s^2": _median_norm(data.accel),
        "accelerometer largest m/s^2": _largest_norm(data.accel),
    }
    if data.mag_uT is not None:
        numbers["magnetometer median uT"] = _median_norm(data.mag_uT)
        numbers["magnetometer rows"] = float(np.isfinite(data.mag_uT).all(axis=1).sum())
    return numbers


def _sum_numbers(means: ImuRecording) -> dict[str, float]:
    missing = ~(np.isfinite(means.gyro).all(axis=1) & np.isfinite(means.accel).all(axis=1))
    return {
        "intervals": float(len(means)),
        "missing intervals": float(missing.sum()),
        "mean rate median rad/s": _median_norm(means.gyro),
        "mean rate largest rad/s": _largest_norm(means.gyro),
        "mean force median m/s^2": _median_norm(means.accel),
        "mean force largest m/s^2": _largest_norm(means.accel),
    }


def _pose_numbers(data: Poses | Motion) -> dict[str, float]:
    extent = np.ptp(data.p_NB, axis=0)
    numbers = {f"extent {axis} m": float(e) for axis, e in zip("xyz", extent, strict=True)}
    steps = np.diff(data.t)
    if steps.size:
        lengths = np.linalg.norm(np.diff(data.p_NB, axis=0), axis=1)
        numbers["path length m"] = float(lengths.sum())
        numbers["median speed m/s"] = float(np.median(lengths / steps))
    return numbers if data.R_NB is None else numbers | _turning(data.t, data.R_NB)


def _turning(t: Array, R: Array) -> dict[str, float]:
    """Rates between neighbours of R (n, 3, 3) at `t` (n,), and how upright it is."""
    numbers = {}
    if len(t) > 1:
        turns = np.swapaxes(R[:-1], 1, 2) @ R[1:]
        rates = np.linalg.norm(log_so3(turns), axis=1) / np.diff(t)
        numbers["median rate rad/s"] = float(np.median(rates))
        numbers["largest rate rad/s"] = float(rates.max())
    # Cosine between the body's z axis and N's: 1 is upright in ENU/FLU.
    numbers["uprightness"] = float(R[:, 2, 2].mean()) if len(t) else float("nan")
    return numbers


def _attitude_contents(data: AttitudeHistory | Reference) -> tuple[str, ...]:
    if isinstance(data, Reference):
        return ("attitude", "samples that count")
    names = {
        "gyro_bias": "gyro bias",
        "a_N": "acceleration",
        "sigma": "uncertainty",
        "rest": "rest",
        "disturbed": "magnetic disturbance",
        "held": "held samples",
    }
    return ("attitude", *(text for name, text in names.items() if getattr(data, name) is not None))


def _attitude_numbers(data: AttitudeHistory | Reference) -> dict[str, float]:
    if isinstance(data, Reference):
        return {"rows that count": float(data.counts.sum())} | _turning(
            data.t[data.counts], data.R_NS[data.counts]
        )
    numbers = _turning(data.t, data.R_NS)
    for name in ("rest", "disturbed", "held"):
        if getattr(data, name) is not None:
            numbers[f"rows {name}"] = float(getattr(data, name).sum())
    if data.gyro_bias is not None:
        numbers["largest gyro bias rad/s"] = _largest_norm(data.gyro_bias)
    return numbers


def _pose_doubts(data: Poses | Motion, numbers: dict[str, float]) -> list[str]:
    doubts = []
    if numbers.get("median speed m/s", 0.0) > 100.0:
        doubts.append(
            f"the median speed is {numbers['median speed m/s']:.4g} m/s: positions in mm, or time in ms?"
        )
    return doubts + _jump_doubts(numbers)


def _jump_doubts(numbers: dict[str, float]) -> list[str]:
    fastest = numbers.get("largest rate rad/s", 0.0)
    if fastest <= 3.0 * _FASTEST_GYRO:
        return []
    return [
        f"the attitude jumps at {fastest:.4g} rad/s: "
        "wrong order of the quaternion, or a tracker that lost and found its target?"
    ]


def _norms(rows: Array) -> Array:
    norms = np.linalg.norm(rows, axis=1)
    return np.asarray(norms[np.isfinite(norms)])


def _median_norm(rows: Array) -> float:
    norms = _norms(rows)
    return float(np.median(norms)) if norms.size else float("nan")


def _largest_norm(rows: Array) -> float:
    return float(_norms(rows).max(initial=0.0))
