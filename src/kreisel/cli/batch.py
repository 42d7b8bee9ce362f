"""Turns names and patterns into files, and a job into what it makes of each of them."""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

from kreisel.cli.notes import complain, sentence
from kreisel.cli.progress import Progress
from kreisel.cli.values import UsageError

SHOWN = 20
"""Of thousands of files a person is told so many; --json has all."""

Made = TypeVar("Made")


def expanded(given: Sequence[str]) -> list[str]:
    """The files given, each once; patterns such as 'rec/**/*.bag' replaced by the files they fit, in order.

    Shells do the same with patterns that are not quoted, but for those of Windows.
    """
    paths: list[str] = []
    for text in given:
        if Path(text).exists() or not glob.has_magic(text):
            paths.append(text)
            continue
        found = sorted(glob.glob(text, recursive=True))
        if not found:
            raise UsageError(f"no file fits {text!r}.")
        paths += found
    return list(dict.fromkeys(paths))


def holds_files(path: Path) -> bool:
    """Whether it is a folder, and none that is read like a file, such as a bag of ROS 2."""
    return path.is_dir() and not (path / "metadata.yaml").exists()


def in_the_way(folder: Path) -> Path | None:
    """The file that is where `folder`, or a folder above it, would have to be."""
    there = next((path for path in (folder, *folder.parents) if path.exists()), folder)
    return there if there.exists() and not there.is_dir() else None


def derived(paths: Sequence[str], output: str, suffix: str) -> list[Path]:
    """Where each of `paths` goes: `output`, or where that is a folder, a file in it with the name and `suffix`.

    Inputs of one name, such as run1/imu.csv and run2/imu.csv, keep the folders that tell them apart.
    Raises UsageError for a file where a folder is needed, an input that would be replaced, and two of one name.
    """
    place = Path(output)
    # What has no suffix may be a folder itself, such as a bag of ROS 2.
    inside = output.endswith(("/", "\\")) or (place.is_dir() and suffix)
    if len(paths) == 1 and not inside:
        outputs = [place]
    elif obstacle := in_the_way(place):
        several = f" for {len(paths)} inputs" if len(paths) > 1 else ""
        raise UsageError(f"-o must be a folder{several}; {obstacle} is a file.")
    else:
        outputs = [place / f"{Path(path).stem}{suffix}" for path in paths]
        if any(_taken_twice(paths, outputs)):
            folders = _folders_below(paths)
            outputs = [place / folder / out.name for folder, out in zip(folders, outputs, strict=True)]
    for other, path, out in _taken_twice(paths, outputs):
        raise UsageError(
            f"two inputs would be written to {out}: {other} and {path}. Give each a folder of its own."
        )
    inputs = {_identity(Path(path)) for path in paths if Path(path).exists()}
    for out in outputs:
        if out.is_file() and _identity(out) in inputs:
            raise UsageError(f"-o {out} is the input itself. Choose another name.")
    return outputs


def _taken_twice(paths: Sequence[str], outputs: Sequence[Path]) -> Iterator[tuple[str, str, Path]]:
    """Two paths and the output of both."""
    taken: dict[str, str] = {}
    for path, out in zip(paths, outputs, strict=True):
        # Many file systems take A.csv and a.csv for one.
        other = taken.setdefault(str(out).casefold(), path)
        if other is not path:
            yield other, path, out


def _folders_below(paths: Sequence[str]) -> list[str]:
    """The folder of each file, from the innermost one that has them all."""
    folders = [os.path.dirname(os.path.abspath(path)) for path in paths]
    try:
        top = os.path.commonpath(folders)
    except ValueError:  # drives of Windows have nothing in common
        return ["."] * len(folders)
    return [os.path.relpath(folder, top) for folder in folders]


def _identity(path: Path) -> tuple[int, int]:
    stat = path.stat()
    return stat.st_dev, stat.st_ino


@dataclass(frozen=True, slots=True)
class Batch(Generic[Made]):
    """What became of several files, in their order."""

    done: dict[str, Made] = field(default_factory=dict)  # by file
    failed: list[dict[str, str]] = field(default_factory=list)  # file and error

    @property
    def code(self) -> int:
        """The exit code: 1 where a file was bad."""
        return 1 if self.failed else 0

    def fail(self, path: str, told: str) -> str:
        """Take in that a file is bad; the sentence about it names it."""
        told = told if path in told else f"{path}: {told}"
        self.failed.append({"file": path, "error": told})
        return told


def over_files(paths: Sequence[str], job: Callable[[str], Made], label: str) -> Batch[Made]:
    """What `job` makes of each file, one by one. A bad one among several is reported, and the others are done.

    Of a single file, and of what was typed, mistakes are raised as they are.
    """
    batch: Batch[Made] = Batch()
    with Progress(len(paths) if len(paths) > 1 else None, label) as progress:
        for path in paths:
            try:
                batch.done[path] = job(path)
            except UsageError:
                raise
            except (ValueError, TypeError, OSError) as error:
                if len(paths) == 1:
                    raise
                complain(batch.fail(path, sentence(error)))
            progress.advance()
    return batch


def shortened(lines: Sequence[str], what: str) -> list[str]:
    """The first of many lines, and how many more of `what` there are."""
    more = len(lines) - SHOWN
    return [*lines[:SHOWN], f"... and {more} more {what}"] if more > 0 else list(lines)
