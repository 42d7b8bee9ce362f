"""Turns a recording into what is constantly wrong with its sensors: biases, scale, misalignment, hard and soft iron."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kreisel.data.calibration import TriadCalibration
from kreisel.data.checks import Array, instance, scalar
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import SOURCE, ImuRecording
from kreisel.evaluate.stillness import still_windows
from kreisel.maths.ellipsoid import Ellipsoid, fit_ellipsoid, spread_of_inverse
from kreisel.maths.rotations import exp_so3

# Readings along an axis must span this share of what the best axis spans, or the axis never turned.
_SPAN = 0.5

# A centre known no better than this share of the field is no calibration.
_UNSURE = 0.05

_FEWEST_FIELD = 50
_FEWEST_WINDOWS = 4
_POSES_FOR_ALL, _POSES_FOR_SCALE = 12, 6

# Poses whose gravity points within this angle of each other are one pose.
_SAME_POSE = np.cos(np.deg2rad(5.0))

# Share of gravity by which the accelerometer may read more or less and still point up.
_NEARLY_FREE = 0.03
_TURN_PASSES = 30

# Mean square by which turning the magnetometer must move the field's height, whatever the axis. Attitudes at random
# give 0.06 at a dip of 65 deg; of recordings with 0.004 some were turned wrongly by 4 deg and more.
_LEVER = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class FieldFit:
    """A magnetometer's calibration, and the field it was found in."""

    triad: TriadCalibration
    field_uT: float  # strength: as given, or the geometric mean over the directions of the sensor
    rms_uT: float  # what is left: distance of the readings from the ellipsoid
    dip_deg: float | None  # angle of the field below the horizon; None where the accelerometer did not help
    samples: int


def calibrate_gyro(recording: ImuRecording) -> TriadCalibration:
    """The gyro's bias: mean over the stretches in which the sensor lay still.

    Raises ValueError where there are less than two seconds of rest. Earth's rate, 0.004 deg/s, is part of it.
    """
    instance("recording", recording, ImuRecording, SOURCE)
    still = still_windows(recording)
    if len(still.gyro) < _FEWEST_WINDOWS:
        raise ValueError(
            f"a gyro's bias needs 2 s of rest; this recording has {0.5 * len(still.gyro):.3g} s. "
            "Lay the sensor down, start recording, wait a few seconds."
        )
    # Scatter of the windows holds noise and wander of the bias alike.
    error = still.gyro.std(axis=0, ddof=1) / np.sqrt(len(still.gyro))
    return TriadCalibration(bias=still.gyro.mean(axis=0), bias_error=error)


def calibrate_accel(recording: ImuRecording, gravity: float = STANDARD_GRAVITY) -> TriadCalibration:
    """Bias and scale of the accelerometer from six poses at rest or more, misalignment too from twelve.

    Every pose reads `gravity` (m/s^2) in length once it is right. The matrix is symmetric: turning all three axes
    together changes no length, so the axes are those the triad has on average.
    Raises ValueError for too few poses, and names an axis that gravity never pointed along.
    """
    instance("recording", recording, ImuRecording, SOURCE)
    gravity = scalar("gravity", gravity, "m/s^2", 0.1, 100.0)
    points, sigma = _poses(recording)
    _check_span("accel", points, "Lay the sensor on each of its six sides for a few seconds.")
    if len(points) < _POSES_FOR_SCALE:
        raise ValueError(
            f"an accelerometer needs {_POSES_FOR_SCALE} poses at rest, {_POSES_FOR_ALL} for misalignment; "
            f"this recording has {len(points)}. Lay the sensor on each of its six sides for a few seconds."
        )
    diagonal = len(points) < _POSES_FOR_ALL
    # Few poses cannot tell their own scatter.
    found = fit_ellipsoid(points, diagonal, sigma if len(points) < _POSES_FOR_ALL + 3 else None)
    return _triad("accel", found, gravity)


def calibrate_mag(recording: ImuRecording, field_uT: float | None = None) -> FieldFit:
    """Hard and soft iron from a recording that was turned every way in one and the same field.

    field_uT : its strength; unknown, the geometric mean over all directions keeps its value (determinant one).
    Lengths leave open how the three axes are turned together. Where the accelerometer shows up, in samples whose
    specific force is gravity's to 3 %, the turn is that at which the field keeps one angle to it; elsewhere the
    matrix is symmetric.
    Raises ValueError for a recording without magnetometer or one that never turned enough, naming the axis.
    """
    instance("recording", recording, ImuRecording, SOURCE)
    if recording.mag_uT is None:
        raise ValueError("this recording has no magnetometer.")
    seen = np.isfinite(recording.mag_uT).all(axis=1)
    points = recording.mag_uT[seen]
    if len(points) < _FEWEST_FIELD:
        raise ValueError(f"a magnetometer needs {_FEWEST_FIELD} samples or more; got {len(points)}.")
    _check_span(
        "mag", points, "Turn the sensor so that each of its axes points along the field and against it."
    )
    found = fit_ellipsoid(points)
    strength = _strength(found) if field_uT is None else scalar("field_uT", field_uT, "uT", 1.0, 1000.0)
    triad = _triad("mag", found, strength)
    assert found is not None  # or the triad had been refused
    turn, dip = _turn_to_vertical(triad.undo(points), recording.accel[seen])
    turned = TriadCalibration(triad.matrix @ turn.T, triad.bias, triad.matrix_error, triad.bias_error)
    return FieldFit(turned, strength, found.rms, dip, len(points))


def _strength(found: Ellipsoid | None) -> float:
    return 1.0 if found is None else float(np.linalg.det(found.W) ** (-1.0 / 3.0))


def _check_span(name: str, points: Array, cure: str) -> None:
    """Refuse readings that hardly change along an axis."""
    if len(points) < 2:
        raise ValueError(f"{name} never turned: there is one pose or none at rest. {cure}")
    low, high = (
        np.quantile(points, [0.005, 0.995], axis=0) if len(points) >= 400 else (points.min(0), points.max(0))
    )
    span = high - low
    k = int(np.argmin(span))
    if not span[k] > _SPAN * span.max():
        raise ValueError(
            f"{name} never turned enough: its {'xyz'[k]} axis ranges over {span[k]:.3g} where its "
            f"{'xyz'[int(np.argmax(span))]} axis has {span.max():.3g} {_UNIT[name]}. {cure}"
        )


_UNIT = {"accel": "m/s^2", "mag": "uT"}


def _triad(name: str, found: Ellipsoid | None, length: float) -> TriadCalibration:
    """The triad that takes a sphere of radius `length` to the ellipsoid, or a ValueError naming what is unsure."""
    if found is None:
        raise ValueError(
            f"{name} readings lie on no ellipsoid: they turn about one axis only, or the field changes."
        )
    error = np.sqrt(np.diagonal(found.covariance)[:3])
    k = int(np.argmax(error))
    if not error[k] < _UNSURE * _strength(found):
        raise ValueError(
            f"{name} never turned enough: the centre along {'xyz'[k]} is known to {error[k]:.2g} {_UNIT[name]} only. "
            "Turn the sensor about all three axes."
        )
    matrix_error = spread_of_inverse(found.W, found.covariance) / length
    matrix: Array = np.asarray(np.linalg.inv(found.W) / length, dtype=np.float64)
    return TriadCalibration(matrix, found.centre, matrix_error, error)


def _poses(recording: ImuRecording) -> tuple[Array, float]:
    """Mean specific force (p, 3) of each pose and the standard error of one, per axis, from within them."""
    still = still_windows(recording)
    means: list[Array] = []
    weights: list[int] = []
    squares, freedom = 0.0, 0
    for pose in range(int(still.pose.max()) + 1 if len(still.pose) else 0):
        rows = still.accel[still.pose == pose]
        mean = rows.mean(axis=0)
        squares, freedom = squares + float(np.sum((rows - mean) ** 2)), freedom + 3 * (len(rows) - 1)
        if any(_same_pose(mean, other) for other in means):
            continue
        means.append(mean)
        weights.append(len(rows))
    window = np.sqrt(squares / freedom) if freedom else 0.0
    return np.array(means).reshape(-1, 3), window / np.sqrt(np.mean(weights)) if weights else 0.0


def _same_pose(a: Array, b: Array) -> bool:
    return bool(a @ b > _SAME_POSE * np.linalg.norm(a) * np.linalg.norm(b))


def _turn_to_vertical(field: Array, accel: Array) -> tuple[Array, float | None]:
    """Rotation (3, 3) of `field` (n, 3) after which its angle to `accel` is most nearly one, and the dip in degrees.

    Gauss-Newton on up . Exp(v) m = s over the rotation vector v and the constant s; identity where too few samples or
    attitudes tell.
    """
    size = np.linalg.norm(accel, axis=1)
    usual = np.nanmedian(size)
    with np.errstate(invalid="ignore"):
        free = np.abs(size - usual) < _NEARLY_FREE * usual
    if free.sum() < _FEWEST_FIELD:
        return np.eye(3), None
    up = accel[free] / size[free, None]
    m = field[free] / np.linalg.norm(field[free], axis=1)[:, None]
    turn = np.eye(3)
    for _ in range(_TURN_PASSES):
        turned = m @ turn.T
        height = np.sum(up * turned, axis=1)
        lever = np.cross(turned, up)
        lever -= lever.mean(axis=0)
        normal = lever.T @ lever / len(up)
        if not np.linalg.eigvalsh(normal)[0] > _LEVER:
            return np.eye(3), None
        step = -np.linalg.solve(normal, lever.T @ height / len(up))
        turn = exp_so3(step) @ turn
        if np.abs(step).max() < 1e-13:
            break
    return np.asarray(turn), float(np.rad2deg(-np.arcsin(np.clip(height.mean(), -1.0, 1.0))))
