"""Turns MCAP files of ROS 2 into Poses, ImuRecording or AttitudeHistory, and nouns into such files."""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

from kreisel.files.formats import Noun, ReadOptions, Topic
from kreisel.files.ros.reading import list_bag, read_bag
from kreisel.files.ros.writing import HOLDS as HOLDS
from kreisel.files.ros.writing import KEEPS as KEEPS
from kreisel.files.ros.writing import write_ros2

SUFFIX = ".mcap"
OPTIONS = frozenset({"topics"})


def sniff(head: bytes) -> bool:
    """MCAP's magic bytes."""
    return head.startswith(b"\x89MCAP")


def read(path: Path, options: ReadOptions) -> Noun:
    """What is on the topic of `options`, or on the only one that can be read."""
    return read_bag(path, ".mcap", options)


def listing(path: Path) -> list[Topic]:
    """Every topic."""
    return list_bag(path, ".mcap")


def write(data: Noun, out: BinaryIO) -> None:
    """The one file of a bag of ROS 2, which tools read without the folder around it."""
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "kreisel"
        write_ros2(data, bag)
        with (bag / "kreisel.mcap").open("rb") as written:
            shutil.copyfileobj(written, out)
