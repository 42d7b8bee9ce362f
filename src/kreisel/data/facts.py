"""Turns any noun into plain facts about it: rows, rate, gaps, extent, and what its units look like."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.checks import Array
from kreisel.data.increments import ImuIncrements
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
    doubts = impossible_units(recording)
    fastest = _largest_norm(recording.gyro)
    # A few such samples may be faults.
    if fastest > _FASTEST_GYRO and not any(doubt.startswith("the gyro") for doubt in doubts):
        doubts.append(f"the gyroscope reaches {fastest:.4g} rad/s: faults, or deg/s?")
    if recording.mag_uT is not None:
        doubts += _field_doubts(_median_norm(recording.mag_uT))
    return doubts + _axis_doubts(recording.accel)


def impossible_units(recording: ImuRecording) -> list[str]:
    """Those of the doubts that make every attitude wrong: units of the accelerometer and the gyroscope."""
    doubts = []
    force = _median_norm(recording.accel)
    for unit, one in (("g", 1.0), ("mg or cm/s^2", 1e3)):
        # Rest or ordinary movement keeps the median within a quarter of gravity.
        if 0.75 * one < force < 1.25 * one:
            doubts.append(
                f"the accelerometer's median is {force:.4g}: it looks like {unit}, where m/s^2 is expected."
            )
    fast = _norms(recording.gyro) > _FASTEST_GYRO
    # A handful are faults in a recording of any length.
    if fast.sum() > max(5.0, _FAULTS * fast.size):
        fastest = _largest_norm(recording.gyro)
        doubts.append(
            f"the gyroscope reaches {fastest:.4g} rad/s: it looks like deg/s, where rad/s is expected."
        )
    return doubts


def _field_doubts(strength: float) -> list[str]:
    # The Earth's field is 22 to 67 uT; buildings bend it by a few tens of per cent.
    for unit, one in (("gauss", _GAUSS_IN_UT), ("mgauss", 0.1), ("nT", 1e-3), ("T", 1e6), ("mT", 1e3)):
        if 15.0 < strength * one < 100.0:
            return [
                f"the magnetometer's median is {strength:.4g}: it looks like {unit}, where uT is expected."
            ]
    return []


def _axis_doubts(accel: Array) -> list[str]:
    rows = accel[np.isfinite(accel).all(axis=1)]
    if len(rows) == 0:
        return []
    mean = rows.mean(axis=0)
    # Within 25 degrees of straight down, as a level z-down sensor reads: nothing else looks like it but
    # an IMU mounted upside down.
    if mean[2] < -0.9 * np.linalg.norm(mean) and np.linalg.norm(mean) > 0.5 * _median_norm(accel):
        return [
            "the mean specific force points along -z: z-down axes (--frame ned-frd), "
            "or a sensor mounted upside down."
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
