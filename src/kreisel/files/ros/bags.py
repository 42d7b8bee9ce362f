"""Turns a ROS bag of any kind into a list of its topics and the messages on them.

The messages are those of sensor_msgs, geometry_msgs, nav_msgs and tf2_msgs as ROS defines them: their layout has not
changed since ROS 1, so that the definitions in the bag, of which others may be broken, are not needed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kreisel.files.formats import Topic

IMU = "sensor_msgs/msg/Imu"
FIELD = "sensor_msgs/msg/MagneticField"
POSE = "geometry_msgs/msg/PoseStamped"
ODOMETRY = "nav_msgs/msg/Odometry"
TF = "tf2_msgs/msg/TFMessage"

HOLDS = {IMU: "imu", FIELD: "mag", POSE: "poses", ODOMETRY: "poses", TF: "poses"}
_TF_OF_OLD = "tf/msg/tfMessage"  # what /tf carried before tf2, the same to the byte

INSTALL = "pip install 'kreisel[ros]'"


@dataclass(frozen=True, slots=True)
class Bag:
    """An open bag."""

    path: Path
    storage: Any  # a reader of rosbags
    decode: Callable[[bytes, str], Any]  # the bytes of a message and its type -> the message

    def topics(self) -> list[Topic]:
        """Every topic with the type and number of its messages."""
        found: dict[str, list[Any]] = {}
        for connection in self.storage.connections:
            found.setdefault(connection.topic, []).append(connection)
        return [_topic(name, connections) for name, connections in sorted(found.items())]

    def messages(self, name: str) -> Iterator[tuple[int, Any]]:
        """Pairs of the time a message was logged at, ns, and the message, in the order of these times.

        To be gone through inside `refusing_damage`.
        """
        connections = [c for c in self.storage.connections if c.topic == name]
        for connection, log_ns, raw in self.storage.messages(connections):
            yield log_ns, self.decode(raw, _modern(connection.msgtype))

    def transforms(self, name: str) -> list[Topic]:
        """The pairs of frames of a tf topic, called "/tf:PARENT.CHILD"."""
        with refusing_damage(self.path):
            pairs = Counter(
                f"{name}:{transform.header.frame_id}.{transform.child_frame_id}"
                for _, message in self.messages(name)
                for transform in message.transforms
            )
        return [Topic(pair, _short(TF), count, "poses") for pair, count in sorted(pairs.items())]

    def listing(self) -> list[Topic]:
        """Every topic, tf by its pairs of frames."""
        every: list[Topic] = []
        for topic in self.topics():
            every += self.transforms(topic.name) if is_tf(topic) else [topic]
        return every


def is_tf(topic: Topic) -> bool:
    """Whether this is a whole tf topic, and no pair of frames on it."""
    return topic.type == _short(TF) and ":" not in topic.name


@contextmanager
def opened(path: Path, reader: str) -> Iterator[Bag]:
    """The bag at `path`; `reader` is "bag" for ROS 1, "folder", ".mcap" or ".db3" for ROS 2.

    Raises ValueError where it is cut off or damaged, and where rosbags is not installed.
    """
    check_installed(path)
    store = definitions(1 if reader == "bag" else 2)
    with refusing_damage(path):
        storage = _storage(path, reader)
        storage.open()
    try:
        yield Bag(path, storage, store.deserialize_ros1 if reader == "bag" else store.deserialize_cdr)
    finally:
        storage.close()


def definitions(ros: int) -> Any:
    """The messages of ROS 1 or 2, as a type store of rosbags."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    if ros == 2:
        return get_typestore(Stores.LATEST)
    store = get_typestore(Stores.ROS1_NOETIC)
    # tf2 is not among what rosbags knows of ROS 1.
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms\n", TF))
    return store


def _storage(path: Path, reader: str) -> Any:
    if reader == "bag":
        from rosbags.rosbag1 import Reader as RosOneReader

        return RosOneReader(path)
    from rosbags.rosbag2 import Reader

    # By kind, where Reader(path) would go by a suffix that the file need not have.
    return Reader.STORAGE_PLUGINS["dir" if reader == "folder" else reader](path)


def check_installed(path: Path | str) -> None:
    """Refuse with the cure where rosbags is not installed."""
    try:
        import rosbags  # noqa: F401
    except ImportError:
        raise ValueError(f"{path}: ROS bags need rosbags: {INSTALL}.") from None


@contextmanager
def refusing_damage(path: Path) -> Iterator[None]:
    """Whatever error broken bytes lead the reader into becomes a ValueError of one sentence."""
    try:
        yield
    except PermissionError as error:
        raise PermissionError(f"cannot read {path}: {error.strerror}.") from None
    except Exception as error:
        reason = " ".join(str(error).split())[:200].rstrip(".") or type(error).__name__
        raise ValueError(
            f"{path} is not a whole ROS bag: it was cut off, damaged or is of another kind ({reason}). "
            "Copy it again; `mcap recover` and `rosbag reindex` save what is left of one."
        ) from None


def _topic(name: str, connections: list[Any]) -> Topic:
    types = sorted({_modern(connection.msgtype) for connection in connections})
    count = sum(connection.msgcount for connection in connections)
    # Static transforms are no path.
    holds = HOLDS.get(types[0], "") if len(types) == 1 and not name.endswith("tf_static") else ""
    return Topic(name, " and ".join(map(_short, types)), count, holds)


def _modern(msgtype: str) -> str:
    return TF if msgtype == _TF_OF_OLD else msgtype


def _short(msgtype: str) -> str:
    """sensor_msgs/Imu, as ROS 1 and its users write it."""
    return msgtype.replace("/msg/", "/")
