"""Turns bags of ROS 1 (.bag, format 2.0) into Poses, ImuRecording or AttitudeHistory, and nouns into such bags."""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

from kreisel.files.formats import Noun, ReadOptions, Topic
from kreisel.files.ros.reading import list_bag, read_bag
from kreisel.files.ros.writing import HOLDS as HOLDS
from kreisel.files.ros.writing import KEEPS as KEEPS
from kreisel.files.ros.writing import write_ros1

SUFFIX = ".bag"
OPTIONS = frozenset({"topics"})


def sniff(head: bytes) -> bool:
    """The first line of a bag."""
    return head.startswith(b"#ROSBAG V")


def read(path: Path, options: ReadOptions) -> Noun:
    """What is on the topic of `options`, or on the only one that can be read."""
    return read_bag(path, "bag", options)


def listing(path: Path) -> list[Topic]:
    """Every topic."""
    return list_bag(path, "bag")


def write(data: Noun, out: BinaryIO) -> None:
    """A bag whose messages carry their own stamps."""
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "kreisel.bag"
        write_ros1(data, bag)
        with bag.open("rb") as written:
            shutil.copyfileobj(written, out)
