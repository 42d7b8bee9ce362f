"""Bags as others record them, made with rosbags itself and none of our code."""

from __future__ import annotations

from pathlib import Path

import numpy as np

EPOCH_NS = 1_700_000_000_123_456_789
STEP_NS = 5_000_000
NO_READING = np.array([-1.0, *[0.0] * 8])


class Maker:
    """Messages of one ROS; every method takes the stamp of the header in ns."""

    def __init__(self, ros: int) -> None:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.ros = ros
        self.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
        if ros == 1:
            definition = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(definition, "tf2_msgs/msg/TFMessage"))

    def make(self, type, *values):
        package, name = type.split("/")
        return self.store.types[f"{package}/msg/{name}"](*values)

    def header(self, ns, frame="frame"):
        stamp = self.make("builtin_interfaces/Time", ns // 10**9, ns % 10**9)
        return self.make("std_msgs/Header", *([7] if self.ros == 1 else []), stamp, frame)

    def vector(self, *xyz):
        return self.make("geometry_msgs/Vector3", *map(float, xyz))

    def quaternion(self, x=0.0, y=0.0, z=0.0, w=1.0):
        return self.make("geometry_msgs/Quaternion", x, y, z, w)

    def imu(self, ns, gyro=(0, 0, 0), accel=(0, 0, 9.81), quat=(0.0, 0.0, 0.0, 1.0), covariances=None):
        of_q, of_w, of_f = covariances or (np.zeros(9), np.zeros(9), np.zeros(9))
        turned = (self.quaternion(*quat), of_q)
        measured = (self.vector(*gyro), of_w, self.vector(*accel), of_f)
        return self.make("sensor_msgs/Imu", self.header(ns), *turned, *measured)

    def field(self, ns, tesla):
        return self.make("sensor_msgs/MagneticField", self.header(ns), self.vector(*tesla), np.zeros(9))

    def pose(self, xyz, quat):
        point = self.make("geometry_msgs/Point", *map(float, xyz))
        return self.make("geometry_msgs/Pose", point, self.quaternion(*quat))

    def stamped(self, ns, xyz=(0, 0, 0), quat=(0.0, 0.0, 0.0, 1.0)):
        return self.make("geometry_msgs/PoseStamped", self.header(ns), self.pose(xyz, quat))

    def odometry(self, ns, xyz, quat, twist):
        pose = self.make("geometry_msgs/PoseWithCovariance", self.pose(xyz, quat), np.zeros(36))
        velocity = self.make("geometry_msgs/Twist", self.vector(*twist), self.vector(0, 0, 0))
        twist = self.make("geometry_msgs/TwistWithCovariance", velocity, np.zeros(36))
        return self.make("nav_msgs/Odometry", self.header(ns), "base_link", pose, twist)

    def transforms(self, ns, *pairs):
        """One message with a transform for each (parent, child, xyz)."""
        level = self.quaternion()
        transforms = [
            self.make(
                "geometry_msgs/TransformStamped",
                self.header(ns, parent),
                child,
                self.make("geometry_msgs/Transform", self.vector(*xyz), level),
            )
            for parent, child, xyz in pairs
        ]
        return self.make("tf2_msgs/TFMessage", transforms)

    def text(self, ns):
        return self.make("std_msgs/String", "nothing to see")


def save(path: Path, maker: Maker, messages, storage="MCAP"):
    """A bag at `path` of (topic, type, logged at ns, message); a folder for ROS 2."""
    if maker.ros == 1:
        from rosbags.rosbag1 import Writer

        writer, encode = Writer(path), maker.store.serialize_ros1
    else:
        from rosbags.rosbag2 import StoragePlugin, Writer

        writer = Writer(path, version=8, storage_plugin=StoragePlugin[storage])
        encode = maker.store.serialize_cdr
    with writer:
        connections = {}
        for topic, type, logged, message in messages:
            name = type.replace("/", "/msg/")
            if (topic, name) not in connections:
                connections[topic, name] = writer.add_connection(topic, name, typestore=maker.store)
            writer.write(connections[topic, name], logged, encode(message, name))
    return path


def stamps(n=20):
    return [EPOCH_NS + k * STEP_NS for k in range(n)]


def imu_messages(maker, topic="/imu", n=20, **options):
    return [(topic, "sensor_msgs/Imu", ns, maker.imu(ns, **options)) for ns in stamps(n)]
