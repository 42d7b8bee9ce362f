"""One file per format; each turns a file into a noun and, where it can hold one, a noun into bytes.

The name a user types is the file name with dashes: ``euroc_imu.py`` is ``euroc-imu``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.data.trial import Trial

Noun = Poses | Motion | ImuRecording | ImuIncrements | AttitudeHistory | Reference
Content = Noun | Trial
"""What a file may hold: one noun, or a recording with its reference."""


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """What a reader may need beyond the file; a format refuses what is not in its OPTIONS."""

    columns: Mapping[str, str] | None = None  # our column name -> the file's header, with its unit if need be
    rate_hz: float | None = None  # for files without time: the first row is at t = 0
    times: Path | None = None  # for files without time: a text file with one stamp in seconds per row
    kind: str | None = (
        None  # one of the kinds `kreisel.read` knows: which to take from a file that has several
    )
    topics: tuple[str, ...] = ()  # for files with several recordings: the names of those to take


@dataclass(frozen=True, slots=True)
class Topic:
    """One of several recordings in a file."""

    name: str
    type: str  # of its messages, as its own world calls it
    messages: int
    holds: str  # "imu", "mag" or "poses"; "" where it is of no use here


class Undecided(ValueError):
    """Of the recordings in a file none or several fit what was asked for; the text lists them."""


class Format(Protocol):
    """What a module in this folder offers."""

    SUFFIX: str | None  # the file suffix that names this format; None: its files are known by their content
    HOLDS: tuple[type[Noun], ...]  # the nouns it can write
    OPTIONS: frozenset[str]  # the ReadOptions it understands, beside kind
    KEEPS: str  # for the table of formats: what survives the round trip

    # Two that most formats do without:
    # FOLDER: bool = True    where its files are folders: `out` of `write` is the path of one to make
    # listing(path)          where OPTIONS has "topics": every Topic of the file

    def sniff(self, head: bytes) -> bool:
        """Whether the first bytes of a file look like this format and no other."""
        ...

    def read(self, path: Path, options: ReadOptions) -> Content:
        """The noun in the file; ValueError with file, line and column where it is not sound."""
        ...

    def write(self, data: Noun, out: BinaryIO) -> None:
        """The bytes of `data`; ValueError where this format cannot hold it."""
        ...
