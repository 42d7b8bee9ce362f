"""Turns bags of ROS 2, folders with a metadata.yaml, into Poses, ImuRecording or AttitudeHistory, and nouns into such.

The storage is SQLite or MCAP when read, MCAP when written. A .db3 file is taken for its folder where it lies in one.
"""

from __future__ import annotations

from pathlib import Path

from kreisel.files.formats import Noun, ReadOptions, Topic
from kreisel.files.ros.reading import list_bag, read_bag
from kreisel.files.ros.writing import HOLDS as HOLDS
from kreisel.files.ros.writing import KEEPS as KEEPS
from kreisel.files.ros.writing import write_ros2

SUFFIX = None
FOLDER = True
OPTIONS = frozenset({"topics"})


def sniff(head: bytes) -> bool:
    """The first key of metadata.yaml, which stands for its folder, or SQLite's first line."""
    return head.startswith((b"rosbag2_bagfile_information:", b"SQLite format 3\x00"))


def read(path: Path, options: ReadOptions) -> Noun:
    """What is on the topic of `options`, or on the only one that can be read."""
    return read_bag(*_bag(path), options)


def listing(path: Path) -> list[Topic]:
    """Every topic."""
    return list_bag(*_bag(path))


def _bag(path: Path) -> tuple[Path, str]:
    """The bag to open and the kind of its reader."""
    if path.is_dir():
        return path, "folder"
    # The folder knows of further files of a bag that was split.
    return (path.parent, "folder") if (path.parent / "metadata.yaml").exists() else (path, ".db3")


def write(data: Noun, out: Path) -> None:
    """A folder, to be made as `out`, with metadata.yaml and an MCAP file."""
    write_ros2(data, out)
