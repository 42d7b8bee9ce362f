"""Turns finished blocks into files of a folder as they come, and such a folder back into its blocks.

`study.json` says what study it is. Every run that writes begins a file of its own, `0001.blocks`, `0002.blocks`, ...,
and appends one record a block; nothing that was written is touched again. Why: docs/decisions/0070.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import asdict, is_dataclass
from hashlib import blake2b
from pathlib import Path
from threading import Lock
from time import monotonic
from typing import Any

import numpy as np

from kreisel.atomic import replacing
from kreisel.study.engine.records import Arrays, packed, records
from kreisel.study.engine.versions import differences, versions

SCHEMA = "kreisel.blocks/1"

STUDY = "study.json"

SYNC_SECONDS = 1.0
"""Records reach the system at once, which no end of this process undoes, and the disk at least this often."""


class Checkpoints:
    """The finished blocks of one study in a folder. Made by `opened`; closed by whoever opened it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._segment: _Segment | None = None
        self._blocks = 0
        self._lock = Lock()

    @classmethod
    def opened(cls, folder: Path, fingerprint: Mapping[str, Any] | str, *, resume: bool) -> Checkpoints:
        """The folder, made where there is none; ValueError where blocks of another study, or unasked for, lie there.

        fingerprint : numbers, texts, arrays, and tables and lists of them.
        """
        folder.mkdir(parents=True, exist_ok=True)
        named = fingerprint if isinstance(fingerprint, Mapping) else {"study": fingerprint}
        ours = {"schema": SCHEMA, "study": _plain(named, "fingerprint"), "made with": versions()}
        # A folder in which no block was finished is anybody's.
        if any(path.stat().st_size for path in _segments(folder)):
            _refuse_others(folder, ours)
            if not resume:
                raise ValueError(
                    f"{folder} has finished blocks of this very study: resume=True (--resume) goes on "
                    "with them. Or choose another folder."
                )
        else:
            with replacing(folder / STUDY) as out:
                out.write(json.dumps(ours, indent=1).encode())
        return cls(folder)

    def finished(self, blocks: int) -> Iterator[tuple[int, Arrays]]:
        """The blocks below `blocks` that are there, checked; a warning names each file where some are damaged."""
        seen: set[int] = set()
        for path in _segments(self._folder):
            damaged = 0
            for record in records(path):
                if record is None:
                    damaged += 1
                elif record[0] < blocks and record[0] not in seen:
                    seen.add(record[0])
                    self._blocks += 1
                    yield record
            if damaged:
                warnings.warn(
                    f"{path} is damaged in {damaged} place{'s' if damaged > 1 else ''}: blocks that are lost with that "
                    "are computed again.",
                    stacklevel=2,
                )

    def keep(self, block: int, arrays: Arrays) -> None:
        """Write a finished block, from any thread; OSError with one sentence where that fails."""
        record = packed(block, arrays)
        with self._lock:
            try:
                if self._segment is None:
                    self._segment = _Segment(self._folder)
                self._segment.append(record)
            except OSError as error:
                raise self._explained(error) from error
            self._blocks += 1

    def close(self) -> None:
        """See to it that all is on the disk."""
        with self._lock:
            if self._segment is not None:
                self._segment.close()

    def _explained(self, error: OSError) -> OSError:
        return type(error)(
            f"cannot write to {self._folder}: {error.strerror}. The {self._blocks} blocks finished before are safe "
            "there: see to the cause, then go on by resume."
        )


class _Segment:
    """A file that records are appended to, whole or not at all."""

    def __init__(self, folder: Path) -> None:
        number = len(_segments(folder)) + 1
        while (folder / f"{number:04d}.blocks").exists():
            number += 1
        # Exclusive: two runs on one folder do the work twice, and never write to the same file.
        self._stream = (folder / f"{number:04d}.blocks").open("xb", buffering=0)
        self._size, self._synced = 0, monotonic()
        _sync_folder(folder)

    def append(self, record: bytes) -> None:
        try:
            left = memoryview(record)
            while left:
                left = left[self._stream.write(left) :]
            if monotonic() - self._synced > SYNC_SECONDS:
                os.fsync(self._stream.fileno())
                self._synced = monotonic()
        except BaseException:
            # Half a record would be passed over later; taken away, it leaves its room to others.
            self._stream.truncate(self._size)
            self._stream.seek(self._size)
            raise
        self._size += len(record)

    def close(self) -> None:
        with self._stream:
            os.fsync(self._stream.fileno())


def _segments(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.blocks"))


def _sync_folder(folder: Path) -> None:
    """Have the name of a new file survive a loss of power, where folders can be synchronised."""
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _refuse_others(folder: Path, ours: Mapping[str, Any]) -> None:
    try:
        theirs = json.loads((folder / STUDY).read_text(encoding="utf-8"))
        study, made_with = dict(theirs["study"]), dict(theirs["made with"])
    except (OSError, ValueError, TypeError, KeyError):
        raise ValueError(
            f"{folder} has finished blocks, but its {STUDY} is missing or damaged: of what study they are is "
            "unknown. Choose another folder."
        ) from None
    if told := differences(study, ours["study"]):
        raise ValueError(f"{folder} has blocks of another study: {told}. Choose another folder.")
    if told := differences(made_with, ours["made with"]):
        raise ValueError(
            f"{folder} has blocks made with other versions, whose numbers may differ: {told}. Go on with those "
            "versions, or choose another folder."
        )


def _plain(value: Any, name: str) -> Any:
    """`value` as JSON holds it, arrays by shape and digest; TypeError for what has no lasting description."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item, f"{name}[{key!r}]") for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, f"{name}[{k}]") for k, item in enumerate(value)]
    if isinstance(value, np.ndarray) and value.dtype != object:
        digest = blake2b(np.ascontiguousarray(value).tobytes(), digest_size=8).hexdigest()
        return f"{value.dtype} array {value.shape}, {digest}"
    if isinstance(value, np.generic):
        return value.item()
    if is_dataclass(value) and not isinstance(value, type):
        return {"type": type(value).__name__, **_plain(asdict(value), name)}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{name} must be a number, a text, an array or made of such; got {type(value).__name__}.")
