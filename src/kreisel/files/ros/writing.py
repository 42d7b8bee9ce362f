"""Turns nouns into ROS messages, a topic for each kind of them, and those into the bytes of a bag.

Recordings go to /imu/data_raw and /imu/mag, attitude to /imu/data, as REP-145 names them; poses to /odom or /pose,
and to /tf. A message is logged at the stamp in its header.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from heapq import merge
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.checks import Array
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.files.formats import Noun
from kreisel.files.ros.bags import FIELD, IMU, ODOMETRY, POSE, TF, check_installed, definitions
from kreisel.files.ros.reading import UNREPORTED, UT_PER_T
from kreisel.files.stamps import Nanoseconds, to_nanoseconds
from kreisel.maths.rotations import quat_wxyz_from_matrix

HOLDS = (Poses, Motion, ImuRecording, AttitudeHistory)
KEEPS = "int64 nanoseconds exactly, values to the bit; attitude to 1e-15, microtesla to its last digit"

# REP-105 names the frames of a body; REP-145 that of an IMU.
WORLD, BODY, SENSOR = "odom", "base_link", "imu_link"
# Of a rate that is not known: a message has no other way to say it, and filters divide by it.
_NO_IDEA = 1e6
_NONE = np.array([UNREPORTED, *[0.0] * 8])  # the covariance of what is not reported
_LAST_SECOND = {1: 2**32, 2: 2**31}  # of the unsigned and the signed seconds of either ROS


@dataclass(frozen=True, slots=True)
class Published:
    """A topic and the messages on it."""

    topic: str
    type: str
    messages: Iterator[tuple[int, Any]]  # (stamp ns, message)


def write_ros1(data: Noun, path: Path) -> None:
    """Write `data` to a new bag of ROS 1, compressed by LZ4."""
    published, store = _published(data, 1)
    from rosbags.rosbag1 import Writer

    writer = Writer(path)
    writer.set_compression(Writer.CompressionFormat.LZ4)
    with writer:
        _write_all(writer, published, store, store.serialize_ros1)


def write_ros2(data: Noun, folder: Path) -> None:
    """Write `data` to a new folder with a bag of ROS 2: metadata.yaml and an MCAP of chunks compressed by zstd."""
    published, store = _published(data, 2)
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    # Version 8: 9 writes its QoS in a way that ROS before Jazzy cannot read.
    writer = Writer(folder, version=8, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        _write_all(writer, published, store, store.serialize_cdr)


def _write_all(writer: Any, published: list[Published], store: Any, encode: Any) -> None:
    streams = []
    for each in published:
        connection = writer.add_connection(each.topic, each.type, typestore=store)
        streams.append(zip(repeat(connection), each.messages, strict=False))
    for connection, (ns, message) in merge(*streams, key=lambda pair: pair[1][0]):
        writer.write(connection, ns, encode(message, connection.msgtype))


def _published(data: Noun, ros: int) -> tuple[list[Published], Any]:
    """What `data` becomes, and the definitions of its messages for ROS `ros` (1 or 2)."""
    if not isinstance(data, HOLDS):
        raise ValueError("ROS bags hold poses, IMU recordings and attitude; this is none. Write csv instead.")
    if isinstance(data, Poses) and data.R_NB is None:
        raise ValueError("poses of ROS have an attitude; this data has positions alone. Write csv instead.")
    ns = _stamps(data, ros)
    check_installed("cannot write it")
    store = definitions(ros)
    make = _Maker(store.types, ros)
    if isinstance(data, ImuRecording):
        return _recording(make, data, ns), store
    if isinstance(data, AttitudeHistory):
        return [Published("/imu/data", IMU, _attitude(make, data, ns))], store
    return _poses(make, data, ns), store


def _stamps(data: Noun, ros: int) -> Nanoseconds:
    ns = to_nanoseconds(data.t, data.t0_ns)
    if ns[0] < 0 or ns[-1] >= _LAST_SECOND[ros] * 10**9:
        raise ValueError(
            f"ROS {ros} has no stamps before 1970 nor after {2106 if ros == 1 else 2038}; "
            f"these go from {ns[0]} to {ns[-1]} ns. Write csv instead."
        )
    if len(ns) > 1 and np.diff(ns).min() <= 0:
        raise ValueError(
            "ROS counts whole nanoseconds, and two stamps are closer than that. Write csv instead."
        )
    return ns


@dataclass(frozen=True, slots=True)
class _Maker:
    """Makes messages of the types of one ROS."""

    types: Any
    ros: int

    def header(self, ns: int, frame: str) -> Any:
        sec, nanosec = divmod(ns, 1_000_000_000)
        stamp = self.types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
        # ROS 1 counts messages in a header, and leaves the count to whoever publishes them.
        more = {"seq": 0} if self.ros == 1 else {}
        return self.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **more)

    def vector(self, row: list[float], of: str = "Vector3") -> Any:
        return self.types[f"geometry_msgs/msg/{of}"](*row)

    def __call__(self, type: str, **fields: Any) -> Any:
        return self.types[type](**fields)


def _recording(make: _Maker, data: ImuRecording, ns: Nanoseconds) -> list[Published]:
    published = [Published("/imu/data_raw", IMU, _imu(make, data, ns))]
    if data.mag_uT is not None:
        published.append(Published("/imu/mag", FIELD, _field(make, data, ns)))
    return published


def _imu(make: _Maker, data: ImuRecording, ns: Nanoseconds) -> Iterator[tuple[int, Any]]:
    of_gyro = _covariances(data.gyro, data.gyro_noise, data.gyro_sigma)
    of_accel = _covariances(data.accel, data.accel_noise, data.accel_sigma)
    level = make.vector([0.0, 0.0, 0.0, 1.0], "Quaternion")
    rows = zip(ns.tolist(), data.gyro.tolist(), of_gyro, data.accel.tolist(), of_accel, strict=True)
    for stamp, w, of_w, f, of_f in rows:
        message = make(
            IMU,
            header=make.header(stamp, SENSOR),
            orientation=level,
            orientation_covariance=_NONE,
            angular_velocity=make.vector(w),
            angular_velocity_covariance=of_w,
            linear_acceleration=make.vector(f),
            linear_acceleration_covariance=of_f,
        )
        yield stamp, message


def _field(make: _Maker, data: ImuRecording, ns: Nanoseconds) -> Iterator[tuple[int, Any]]:
    assert data.mag_uT is not None  # asked before
    tesla, noise = data.mag_uT / UT_PER_T, data.mag_noise_uT
    covariances = _covariances(tesla, None if noise is None else noise / UT_PER_T)
    for stamp, field, covariance in zip(ns.tolist(), tesla.tolist(), covariances, strict=True):
        if covariance[0] != UNREPORTED:
            header, vector = make.header(stamp, SENSOR), make.vector(field)
            yield (
                stamp,
                make(FIELD, header=header, magnetic_field=vector, magnetic_field_covariance=covariance),
            )


def _attitude(make: _Maker, data: AttitudeHistory, ns: Nanoseconds) -> Iterator[tuple[int, Any]]:
    """The orientation of an IMU that reports nothing else."""
    zero = make.vector([0.0, 0.0, 0.0])
    covariances = _covariances(np.zeros((len(data), 3)), None, data.sigma)
    for stamp, quat, covariance in zip(ns.tolist(), _quat_xyzw(data.R_NS), covariances, strict=True):
        message = make(
            IMU,
            header=make.header(stamp, SENSOR),
            orientation=make.vector(quat, "Quaternion"),
            orientation_covariance=covariance,
            angular_velocity=zero,
            angular_velocity_covariance=_NONE,
            linear_acceleration=zero,
            linear_acceleration_covariance=_NONE,
        )
        yield stamp, message


def _poses(make: _Maker, data: Poses | Motion, ns: Nanoseconds) -> list[Published]:
    """Odometry where there is a velocity, else poses; and the same as transforms."""
    assert data.R_NB is not None  # refused before
    positions, quats = data.p_NB.tolist(), _quat_xyzw(data.R_NB)
    rows = list(zip(ns.tolist(), positions, quats, strict=True))
    path = Published("/pose", POSE, _pose_messages(make, rows))
    if data.v_NB is not None:
        path = Published("/odom", ODOMETRY, _odometry(make, data, rows))
    return [path, Published("/tf", TF, _transforms(make, rows))]


_PoseRow = tuple[int, list[float], list[float]]  # stamp ns, position, quaternion xyzw


def _pose_messages(make: _Maker, rows: list[_PoseRow]) -> Iterator[tuple[int, Any]]:
    for stamp, p, q in rows:
        yield stamp, make(POSE, header=make.header(stamp, WORLD), pose=_pose(make, p, q))


def _transforms(make: _Maker, rows: list[_PoseRow]) -> Iterator[tuple[int, Any]]:
    for stamp, p, q in rows:
        transform = make(
            "geometry_msgs/msg/Transform", translation=make.vector(p), rotation=make.vector(q, "Quaternion")
        )
        stamped = make(
            "geometry_msgs/msg/TransformStamped",
            header=make.header(stamp, WORLD),
            child_frame_id=BODY,
            transform=transform,
        )
        yield stamp, make(TF, transforms=[stamped])


def _odometry(make: _Maker, data: Poses | Motion, rows: list[_PoseRow]) -> Iterator[tuple[int, Any]]:
    """Velocity and rate in the axes of the body, as nav_msgs/Odometry has them."""
    assert data.R_NB is not None and data.v_NB is not None  # asked before
    v_B = np.einsum("nij,ni->nj", data.R_NB, data.v_NB).tolist()
    known = isinstance(data, Motion)
    omega = data.omega_NB_B.tolist() if isinstance(data, Motion) else np.zeros((len(rows), 3)).tolist()
    exact = np.zeros(36)
    of_twist = exact if known else np.diag([0.0, 0.0, 0.0, _NO_IDEA, _NO_IDEA, _NO_IDEA]).ravel()
    for (stamp, p, q), v, w in zip(rows, v_B, omega, strict=True):
        twist = make("geometry_msgs/msg/Twist", linear=make.vector(v), angular=make.vector(w))
        pose = _pose(make, p, q)
        yield (
            stamp,
            make(
                ODOMETRY,
                header=make.header(stamp, WORLD),
                child_frame_id=BODY,
                pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=exact),
                twist=make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=of_twist),
            ),
        )


def _pose(make: _Maker, p: list[float], q: list[float]) -> Any:
    position, orientation = make.vector(p, "Point"), make.vector(q, "Quaternion")
    return make("geometry_msgs/msg/Pose", position=position, orientation=orientation)


def _quat_xyzw(R: Array) -> list[list[float]]:
    return quat_wxyz_from_matrix(R)[:, [1, 2, 3, 0]].tolist()


def _covariances(readings: Array, noise: Array | None, sigma: Array | None = None) -> Array:
    """Matrices (n, 9) of noise (3,) and error (n, 3): 0 where not known, -1 first where there is no reading."""
    covariances = np.zeros((len(readings), 9))
    if noise is not None:
        covariances[:, ::4] += noise**2
    if sigma is not None:
        covariances[:, ::4] += np.where(np.isnan(sigma), 0.0, sigma) ** 2
    covariances[np.isnan(readings).all(axis=1), 0] = UNREPORTED
    return covariances
