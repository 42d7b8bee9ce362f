"""Turns names and patterns into files, and a job into what it makes of each of them."""

from __future__ import annotations

import glob
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

from kreisel.cli.notes import complain, sentence
from kreisel.cli.progress import Progress
from kreisel.cli.values import UsageError

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


def derived(paths: Sequence[str], output: str, suffix: str) -> list[Path]:
    """Where each of `paths` goes: `output`, or where that is a folder, a file in it with the name and `suffix`.

    Raises UsageError for a file where a folder is needed, an input that would be replaced, and two of one name.
    """
    place = Path(output)
    # What has no suffix may be a folder itself, such as a bag of ROS 2.
    inside = output.endswith(("/", "\\")) or (place.is_dir() and suffix)
    if len(paths) == 1 and not inside:
        outputs = [place]
    elif place.exists() and not place.is_dir():
        raise UsageError(f"-o must be a folder for {len(paths)} inputs; {place} is a file.")
    else:
        outputs = [place / f"{Path(path).stem}{suffix}" for path in paths]
    taken: dict[str, str] = {}
    for path, out in zip(paths, outputs, strict=True):
        # Many file systems take A.csv and a.csv for one.
        other = taken.setdefault(str(out).casefold(), path)
        if other is not path:
            raise UsageError(
                f"two inputs would be written to {out}: {other} and {path}. Give each a folder of its own."
            )
    for out in outputs:
        same = [path for path in paths if out.is_file() and Path(path).exists() and out.samefile(path)]
        if same:
            raise UsageError(f"-o {out} is the input itself. Choose another name.")
    return outputs


@dataclass(frozen=True, slots=True)
class Batch(Generic[Made]):
    """What became of several files."""

    done: list[Made] = field(default_factory=list)
    failed: list[dict[str, str]] = field(default_factory=list)  # file and error

    @property
    def code(self) -> int:
        """The exit code: 1 where a file was bad."""
        return 1 if self.failed else 0


def over_files(paths: Sequence[str], job: Callable[[str], Made], label: str) -> Batch[Made]:
    """What `job` makes of each file. A bad one among several is reported, and the others are done.

    Of a single file, and of what was typed, mistakes are raised as they are.
    """
    batch: Batch[Made] = Batch()
    with Progress(len(paths) if len(paths) > 1 else None, label) as progress:
        for path in paths:
            try:
                batch.done.append(job(path))
            except UsageError:
                raise
            except (ValueError, TypeError, OSError) as error:
                if len(paths) == 1:
                    raise
                told = sentence(error)
                told = told if path in told else f"{path}: {told}"
                batch.failed.append({"file": path, "error": told})
                complain(told)
            progress.advance()
    return batch
