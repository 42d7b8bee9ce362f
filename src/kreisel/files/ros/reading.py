"""Turns the messages of a topic into a recording, poses or attitude, at the stamps in their headers.

A covariance whose first element is -1 says that there is no such reading (sensor_msgs, REP-145): it becomes NaN.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import Array, unit_quaternions
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun, ReadOptions, Topic
from kreisel.files.ros.bags import Bag, opened, refusing_damage
from kreisel.files.ros.choosing import Choice, choose
from kreisel.files.stamps import Nanoseconds, from_nanoseconds
from kreisel.maths.rotations import matrix_from_quat_wxyz

Row = tuple[float, ...]
Rows = Callable[[Any], Iterator[tuple[Any, Row]]]  # message -> headers, each with its numbers
Indices = npt.NDArray[np.intp]
UNREPORTED = -1.0
UT_PER_T = 1e6


def read_bag(path: Path, reader: str, options: ReadOptions) -> Noun:
    """The noun on the topic that `options` name or that is the only one; `reader` as `opened` has it."""
    with opened(path, reader) as bag:
        chosen = choose(bag, options)
        try:
            return _noun(bag, chosen, options)
        except (ValueError, TypeError) as error:
            text = str(error)
            raise ValueError(
                text if text.startswith(str(path)) else f"{path}, topic {chosen.main.name}: {text}"
            ) from None


def list_bag(path: Path, reader: str) -> list[Topic]:
    """Every topic of the bag; tf by its pairs of frames."""
    with opened(path, reader) as bag:
        return bag.listing()


def _noun(bag: Bag, chosen: Choice, options: ReadOptions) -> Noun:
    topic = chosen.main
    if topic.holds == "imu":
        return _from_imu(bag, chosen, options.kind)
    if topic.type.endswith("Odometry"):
        return _odometry(bag, topic)
    pair = topic.name.partition(":")[2]
    rows = partial(_transform_rows, pair) if pair else _pose_rows
    ns, values = _table(bag, topic, rows)
    t, t0_ns = from_nanoseconds(ns)
    return Poses(t, values[:, :3], _rotations(values[:, 3:]), t0_ns=t0_ns, name=bag.path.stem)


def _table(bag: Bag, topic: Topic, rows: Rows) -> tuple[Nanoseconds, Array]:
    """(stamps (n,) ns, values (n, m)) of the headers and numbers that `rows` finds in each message."""
    stamps: list[tuple[int, int]] = []
    values: list[Row] = []
    with refusing_damage(bag.path):
        for log_ns, message in bag.messages(topic.name.partition(":")[0]):
            for header, row in rows(message):
                stamps.append((header.stamp.sec * 1_000_000_000 + header.stamp.nanosec, log_ns))
                values.append(row)
    if not values:
        raise ValueError("there are no messages on it.")
    where = f"{bag.path}, topic {topic.name}"
    return _checked(where, np.array(stamps, dtype=np.int64)), np.array(values, dtype=np.float64)


def _checked(where: str, stamps: Nanoseconds) -> Nanoseconds:
    """The stamps of headers (n,) ns of rows (header, logged); ValueError where they do not increase."""
    header, logged = stamps.T
    if len(header) > 1 and not header.any():
        warnings.warn(
            f"{where}: the stamps in the headers were never set; the times of logging stand in for them.",
            stacklevel=2,
        )
        header = logged
    steps = np.diff(header)
    if steps.size and steps.min() <= 0:
        k = int(np.argmax(steps <= 0))
        what = "stands still" if steps[k] == 0 else "runs back"
        raise ValueError(
            f"{where}: time {what} from message {k + 1} to {k + 2}, at {header[k]} and {header[k + 1]} ns. "
            "Split the bag there, or drop those messages."
        )
    return header


def _rotations(quat_xyzw: Array) -> Array:
    return matrix_from_quat_wxyz(unit_quaternions("orientation", quat_xyzw[:, [3, 0, 1, 2]]))


def _pose(pose: Any) -> Row:
    p, q = pose.position, pose.orientation
    return p.x, p.y, p.z, q.x, q.y, q.z, q.w


def _pose_rows(message: Any) -> Iterator[tuple[Any, Row]]:
    yield message.header, _pose(message.pose)


def _transform_rows(pair: str, message: Any) -> Iterator[tuple[Any, Row]]:
    for each in message.transforms:
        if pair == f"{each.header.frame_id}.{each.child_frame_id}":
            p, q = each.transform.translation, each.transform.rotation
            yield each.header, (p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def _odometry_rows(message: Any) -> Iterator[tuple[Any, Row]]:
    v = message.twist.twist.linear
    yield message.header, (*_pose(message.pose.pose), v.x, v.y, v.z)


def _odometry(bag: Bag, topic: Topic) -> Poses:
    """Poses with velocity, which the message has in body axes."""
    ns, values = _table(bag, topic, _odometry_rows)
    t, t0_ns = from_nanoseconds(ns)
    p_NB, R_NB, v_B = values[:, :3], _rotations(values[:, 3:7]), values[:, 7:]
    v_NB = np.einsum("nij,nj->ni", R_NB, v_B)
    if not v_B.any() and np.ptp(p_NB, axis=0).any():
        v_NB = None
        where = f"{bag.path}, topic {topic.name}"
        warnings.warn(
            f"{where}: the body moves at a velocity of zero, which was never set: left out.", stacklevel=2
        )
    return Poses(t, p_NB, R_NB, v_NB, t0_ns, bag.path.stem)


def _imu_rows(message: Any) -> Iterator[tuple[Any, Row]]:
    w, f, q = message.angular_velocity, message.linear_acceleration, message.orientation
    of_w, of_f = message.angular_velocity_covariance, message.linear_acceleration_covariance
    of_q = message.orientation_covariance
    rates, forces = (w.x, w.y, w.z, *of_w.tolist()[::4]), (f.x, f.y, f.z, *of_f.tolist()[::4])
    yield message.header, (*rates, *forces, q.x, q.y, q.z, q.w, *of_q.tolist()[::4])


def _field_rows(message: Any) -> Iterator[tuple[Any, Row]]:
    b = message.magnetic_field
    yield message.header, (b.x, b.y, b.z, *message.magnetic_field_covariance.tolist()[::4])


def _from_imu(bag: Bag, chosen: Choice, kind: str | None) -> ImuRecording | AttitudeHistory:
    ns, values = _table(bag, chosen.main, _imu_rows)
    t, t0_ns = from_nanoseconds(ns)
    gyro, accel = _reported(values[:, :6]), _reported(values[:, 6:12])
    name = bag.path.stem
    nothing_measured = not (_any_reported(values[:, :6]) or _any_reported(values[:, 6:12]))
    if kind == "attitude" or (kind is None and nothing_measured):
        if (values[:, 16] == UNREPORTED).any():
            raise ValueError("its covariance says that it reports no orientation (-1).")
        sigma = _spread(values[:, 16:])
        return AttitudeHistory(t, _rotations(values[:, 12:16]), sigma=sigma, t0_ns=t0_ns, name=name)
    for what, part in (("angular velocity", values[:, :6]), ("linear acceleration", values[:, 6:12])):
        if not _any_reported(part):
            raise ValueError(f"its covariance says that it reports no {what} (-1). Take another topic.")
    mag_uT, mag_noise_uT = _field(bag, chosen.mag, ns)
    (gyro_noise, gyro_sigma), (accel_noise, accel_sigma) = _noise(values[:, :6]), _noise(values[:, 6:12])
    sigmas, noises = (gyro_sigma, accel_sigma), (gyro_noise, accel_noise, mag_noise_uT)
    return ImuRecording(t, gyro, accel, mag_uT, t0_ns, name, *sigmas, *noises)


def _any_reported(values: Array) -> bool:
    return bool((values[:, 3] != UNREPORTED).any())


def _reported(values: Array) -> Array:
    """Readings (n, 3) of rows of three readings and three variances, NaN where there is none."""
    return np.where(values[:, 3:4] == UNREPORTED, np.nan, values[:, :3])


def _noise(values: Array) -> tuple[Array | None, Array | None]:
    """(the deviation (3,) that all rows agree on, or one (n, 3) for each row), of which one at most is known."""
    reported = values[:, 3] != UNREPORTED
    variances = values[reported, 3:]
    if not len(variances) or not ((variances >= 0.0).all() and (variances > 0.0).any()):
        return None, None
    if (variances == variances[0]).all():
        return np.sqrt(variances[0]), None
    sigma = np.full((len(values), 3), np.nan)
    sigma[reported] = np.sqrt(variances)
    return None, sigma


def _spread(variances: Array) -> Array | None:
    """Deviations (n, 3) of an attitude; None where they are not known."""
    known = (variances > 0.0).any() and (variances >= 0.0).all()
    return np.sqrt(variances) if known else None


def _field(bag: Bag, topic: Topic | None, ns: Nanoseconds) -> tuple[Array | None, Array | None]:
    """The field (n, 3) at the IMU's stamps, uT, NaN where it has no sample; and its deviation (3,)."""
    if topic is None or not topic.messages:
        return None, None
    mag_ns, values = _table(bag, topic, _field_rows)
    rows, taken = _nearest(mag_ns, ns)
    _tell(f"{bag.path}, topic {topic.name}", mag_ns[taken] - ns[rows], len(mag_ns) - len(taken))
    mag_uT = np.full((len(ns), 3), np.nan)
    mag_uT[rows] = _reported(values)[taken] * UT_PER_T
    noise, _ = _noise(values)
    return mag_uT, None if noise is None else noise * UT_PER_T


def _nearest(mag_ns: Nanoseconds, ns: Nanoseconds) -> tuple[Indices, Indices]:
    """(rows, taken): sample taken[k] goes to row rows[k], the nearest; no further off than half a step, one a row."""
    after = np.clip(np.searchsorted(ns, mag_ns), 1, max(1, len(ns) - 1))
    around = np.stack([after - 1, np.minimum(after, len(ns) - 1)])
    off = np.abs(ns[around] - mag_ns)
    nearer = np.argmin(off, axis=0)
    row, off = np.take_along_axis(around, nearer[None], 0)[0], off.min(axis=0)
    order = np.lexsort((off, row))
    first = np.unique(row[order], return_index=True)[1]
    taken = order[first]
    half_step = np.median(np.diff(ns)) / 2.0 if len(ns) > 1 else 0.0
    taken = taken[off[taken] <= half_step]
    return row[taken], taken


def _tell(where: str, off_ns: Nanoseconds, dropped: int) -> None:
    """Warn of samples that were moved to an IMU sample beside them, and of those that had none."""
    told = []
    if off_ns.any():
        told.append(f"samples are put at the IMU's stamps, up to {np.abs(off_ns).max() / 1e6:.3g} ms away")
    if dropped:
        told.append(f"{dropped} samples have no IMU sample of their own near and are left out")
    if told:
        warnings.warn(f"{where}: {'; '.join(told)}.", stacklevel=2)
