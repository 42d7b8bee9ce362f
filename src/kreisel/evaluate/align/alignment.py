"""What stands between a recording and its simulated twin: the mount, biases, scale and clocks, with standard errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.data.cards import Card, Shown
from kreisel.data.checks import Array, read_only
from kreisel.data.motion import Mount, Note
from kreisel.data.recording import ImuRecording
from kreisel.evaluate.align.parameters import SIZES, UNITS
from kreisel.maths.rotations import euler_from_matrix

# rad/s or m/s^2: what varies less is round-off.
_CONSTANT = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class SensorAlignment:
    """One sensor against its twin: reading = scale * truth + bias at the time its stamp less `clock` names."""

    bias: Array  # (3,) rad/s or m/s^2
    scale: Array  # (3,)
    clock: float  # s, by which the stamps are ahead: a sample shows what was there this long before its stamp
    rmse: Array  # (3,) of reading minus twin, per axis
    correlation: Array  # (3,) of reading and twin, per axis; NaN for an axis that never changes
    samples: int  # that were compared
    effective_samples: float  # independent ones that would fix a mean as well

    @property
    def total_rmse(self) -> float:
        """Root mean square over all three axes, per axis."""
        return float(np.sqrt(np.mean(np.square(self.rmse))))


class Found(NamedTuple):
    """One parameter as it is told: numbers in its unit, and their standard errors."""

    name: str
    unit: str
    values: Array  # (k,)
    errors: Array  # (k,); inf where the motion does not show it


@dataclass(frozen=True, slots=True, eq=False)
class Alignment(Shown):
    """What `align` found. What it was not asked for has the value it was given and is not in `errors`.

    Standard errors hold for a trajectory without error. They allow for residuals that hang together over time;
    errors of the trajectory that go with its motion (a smoother that flattens peaks) are beyond them.
    """

    mount: Mount  # p_BS and R_BS
    gyro: SensorAlignment
    accel: SensorAlignment
    drift: float  # by which the IMU's clock runs fast: 5e-5 is 50 ppm
    start: float  # s, stamp of the recording at which the clock offsets hold
    tilt: Array  # (2,) rad about x and y of N: true up is Exp(tilt) e_z in the axes of the trajectory
    errors: Mapping[
        str, Array
    ]  # estimated parameter -> standard errors; rotation: rad about the sensor's axes
    twin: ImuRecording  # what a faultless IMU with these parameters reads; NaN outside the trajectory
    notes: tuple[Note, ...] = ()

    @property
    def calibration(self) -> Calibration:
        """Bias and scale of both sensors; `alignment.calibration.apply(recording)` takes them off."""
        return Calibration(*(self._triad(name) for name in ("gyro", "accel")))

    @property
    def found(self) -> Iterator[Found]:
        """The estimated parameters in a fixed order; the rotation as Euler angles of R_BS, errors about its axes."""
        values: dict[str, Array] = {
            "rotation": euler_from_matrix(self.mount.R_BS),
            "lever_arm": self.mount.p_BS,
            "drift": np.array([self.drift]),
            "tilt": self.tilt,
        }
        for name, sensor in (("gyro", self.gyro), ("accel", self.accel)):
            values |= {f"{name}_bias": sensor.bias, f"{name}_scale": sensor.scale}
            values[f"{name}_clock"] = np.array([sensor.clock])
        return (Found(n, UNITS[n], values[n], self.errors[n]) for n in SIZES if n in self.errors)

    def card(self) -> Card:
        """What was estimated, with standard errors, and how far readings and twin are apart."""
        rows = [
            (f.name.replace("_", " "), f.unit, _numbers(f.values), _numbers(f.errors)) for f in self.found
        ]
        twins = ((name, getattr(self, name), unit) for name, unit in (("gyro", "rad/s"), ("accel", "m/s^2")))
        rmse = (
            f"{name} RMSE against the twin: {sensor.total_rmse:.3g} {unit}" for name, sensor, unit in twins
        )
        return Card("Alignment", ("", "unit", "value", "standard error"), rows, tuple(rmse))

    def _triad(self, name: str) -> TriadCalibration:
        sensor = self.gyro if name == "gyro" else self.accel
        nothing = np.zeros(3)
        errors = {
            part: np.nan_to_num(self.errors.get(f"{name}_{part}", nothing), posinf=0.0)
            for part in ("bias", "scale")
        }
        return TriadCalibration(np.diag(sensor.scale), sensor.bias, np.diag(errors["scale"]), errors["bias"])

    def lines(self) -> list[tuple[str, ...]]:
        """Name, one text for each number with its standard error, and unit, of each estimated parameter."""
        return [_told(found) for found in self.found]

    def __str__(self) -> str:
        rows = [f"{name:<12} {', '.join(values)} {unit}".rstrip() for name, *values, unit in self.lines()]
        for name, unit, sensor in (("gyro", "rad/s", self.gyro), ("accel", "m/s^2", self.accel)):
            rmse, rho = (", ".join(f"{x:.3g}" for x in y) for y in (sensor.rmse, sensor.correlation))
            rows.append(f"{name:<12} RMSE {rmse} {unit}; correlation {rho}")
        return "\n".join([*rows, *(note.text for note in self.notes)])


# What a person reads: unit and how many of it there are in ours.
_READABLE = {
    "rad": ("deg", 180.0 / np.pi),
    "m": ("mm", 1e3),
    "rad/s": ("deg/s", 180.0 / np.pi),
    "s": ("ms", 1e3),
}


def _told(found: Found) -> tuple[str, ...]:
    unit, factor = _READABLE.get(found.unit, (found.unit, 1.0))
    if found.name == "drift":
        unit, factor = "ppm", 1e6
    pairs = zip(factor * found.values, factor * found.errors, strict=True)
    return (found.name, *(_with_error(value, error) for value, error in pairs), unit)


def _with_error(value: float, error: float) -> str:
    """A number with its standard error, to one digit of the error, or as "not shown" where that is infinite."""
    if not np.isfinite(error):
        return "not shown"
    if error < 1e-6:
        return f"{value:.6f} ± {error:.0e}"
    digits = max(0, -int(np.floor(np.log10(error))))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def compared(readings: Array, twin: Array) -> tuple[Array, Array, int]:
    """RMSE (3,) and correlation (3,) of each axis, and how many rows both have."""
    both = np.isfinite(readings).all(axis=1) & np.isfinite(twin).all(axis=1)
    a, b = readings[both], twin[both]
    rmse = np.sqrt(np.mean(np.square(a - b), axis=0))
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    sizes = np.sqrt(np.mean(np.square(a), axis=0)), np.sqrt(np.mean(np.square(b), axis=0))
    size = np.where(np.minimum(*sizes) > _CONSTANT, sizes[0] * sizes[1], np.nan)
    correlation = np.mean(a * b, axis=0) / size
    return read_only(rmse), read_only(correlation), int(both.sum())


def correlated(readings: Array, twin: Array) -> float:
    """Correlation of all axes together, each about its mean; 0 where nothing changes."""
    both = np.isfinite(readings).all(axis=1) & np.isfinite(twin).all(axis=1)
    a, b = (x[both] - x[both].mean(axis=0) for x in (readings, twin))
    size = float(np.sqrt(np.square(a).sum() * np.square(b).sum()))
    return float(np.sum(a * b)) / size if size > 0.0 else 0.0


def _numbers(values: Array) -> str:
    return "  ".join(f"{x:.4g}" for x in values)
