"""Turns a job and many files into what it makes of each, many at once: in threads, or on Dask workers."""

from __future__ import annotations

import re
import warnings
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Generic, TypeVar, cast

from kreisel.cli.batch import Batch, Made, over_files, shortened
from kreisel.cli.memory import available, share_of_memory
from kreisel.cli.notes import complain, kept_notes, note, sentence, warnings_as_notes
from kreisel.cli.progress import Progress
from kreisel.cli.values import UsageError, as_typed, typed, whole

_ADDRESS = re.compile(r"(tcp|tls|ucx|wss?)://.+:\d+")

Block = TypeVar("Block")

Job = Callable[[str, Path | None], Made]
"""What is done with a file: its name, and that of its output if there is one."""


def add_sweep_arguments(parser: ArgumentParser) -> None:
    """--threads, --backend and --resume."""
    parser.add_argument(
        "--threads", type=whole(1), metavar="N", help="files at once, of several (default: all cores)"
    )
    parser.add_argument(
        "--backend",
        type=typed(backend),
        metavar="WHERE",
        help="several files on Dask workers: dask starts them here; tcp://HOST:PORT has them, and the files' folder",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="leave out files whose output is there and newer, as after an interruption; with other options too",
    )


def backend(text: str) -> str:
    """A backend's name or address, whose form alone is checked; for argparse, as `typed(backend)`."""
    from kreisel.study.engine import LOCAL

    if text != LOCAL and not _ADDRESS.fullmatch(text):
        raise ValueError(
            f"must be {LOCAL!r} or the address of a scheduler such as tcp://127.0.0.1:8786; got {text!r}."
        )
    return text


def left_to_do(args: Namespace, outputs: Mapping[str, Path | None]) -> dict[str, Path | None]:
    """The files to do, with their outputs: all, or with --resume those whose output is missing or older.

    Whole outputs are all there are, since they appear under their names when they are finished.
    """
    if not args.resume:
        return dict(outputs)
    if None in outputs.values():
        raise UsageError("--resume needs the outputs that are there: -o OUT.")
    return {path: out for path, out in outputs.items() if out is None or not _is_newer(out, Path(path))}


def told_of_skipped(skipped: Sequence[str]) -> list[str]:
    """A line about the files that --resume left out."""
    return [f"left out: {len(skipped)} whose output is newer (--resume)"] if skipped else []


def _is_newer(output: Path, path: Path) -> bool:
    # Of a folder, such as a bag of ROS 2, the time does not tell that a file in it has changed.
    if not (output.is_file() and path.is_file()):
        return False
    return output.stat().st_mtime_ns > path.stat().st_mtime_ns


def over_many_files(
    args: Namespace, outputs: Mapping[str, Path | None], job: Job[Made], label: str
) -> Batch[Made]:
    """What `job` makes of each file and its output, as `over_files` has it, with --threads and --backend.

    job : picklable, and safe in threads. What it notes is said at the end, as are bad files, in the order of the files.
    One file alone is done in this thread: it may be a pipe. The last one that --resume leaves is one of many.
    """
    if len(outputs) == 1 and not args.resume:
        return over_files(list(outputs), lambda path: job(path, outputs[path]), label)
    from kreisel.study.engine import spread_out
    from kreisel.study.engine.threads import usable_cores

    files, made = tuple(outputs.items()), dict[int, _Told[Made]]()
    if args.backend is None:
        work: Callable[[int], _Told[Made]] = _Here(job, files, args.threads or usable_cores())
    else:
        work = _Away(job, files, Path.cwd())
    with as_typed():
        results = spread_out(work, len(files), backend=args.backend, threads=args.threads)
    try:
        with Progress(len(files), label) as progress:
            for k, told in results:
                made[k] = told
                progress.advance()
    finally:
        # Also what was found until somebody interrupted it.
        batch = _in_order(list(outputs), made)
    return batch


def into_folder(blocks: Iterable[Block], folder: Path) -> Iterator[Block]:
    """The same blocks; the folder they go into is made when the first is there, so that a bad file leaves none."""
    for block in blocks:
        folder.mkdir(parents=True, exist_ok=True)
        yield block


@dataclass(frozen=True, slots=True)
class _Told(Generic[Made]):
    """What became of one file: a value or an error."""

    value: Made | None
    error: str | None
    notes: list[str]


@dataclass(frozen=True, slots=True)
class _Here(Generic[Made]):
    """Files by their numbers, for threads of this process."""

    job: Job[Made]
    files: tuple[tuple[str, Path | None], ...]
    threads: int

    def __call__(self, k: int) -> _Told[Made]:
        with share_of_memory(available() / self.threads):
            return _tried(self.job, *self.files[k])


@dataclass(frozen=True, slots=True)
class _Away(Generic[Made]):
    """The same for workers, in whose working folder names would mean other files."""

    job: Job[Made]
    files: tuple[tuple[str, Path | None], ...]
    folder: Path  # where the names were typed

    def __call__(self, k: int) -> _Told[Made]:
        from kreisel.study.engine.task import share_of_worker

        _hear_warnings()
        path, output = self.files[k]
        there = {str(self.folder / name): str(name) for name in (path, output) if name is not None}
        with share_of_memory(share_of_worker(available())):
            told = _tried(self.job, str(self.folder / path), None if output is None else self.folder / output)
        error = None if told.error is None else _renamed(told.error, there)
        return _Told(told.value, error, [_renamed(text, there) for text in told.notes])


def _tried(job: Job[Made], path: str, output: Path | None) -> _Told[Made]:
    with kept_notes() as notes:
        try:
            return _Told(job(path, output), None, notes)
        except UsageError:
            raise
        except (ValueError, TypeError, OSError) as error:
            return _Told(None, sentence(error), notes)


def _renamed(text: str, names: Mapping[str, str]) -> str:
    for absolute, typed_name in names.items():
        text = text.replace(absolute, typed_name)
    return text


@cache
def _hear_warnings() -> None:
    """Have this worker's warnings from kreisel kept as notes, those of a second sweep over the same files too."""
    warnings.filterwarnings("always", module=r"kreisel\.")
    warnings.showwarning = warnings_as_notes(warnings.showwarning)


def _in_order(paths: Sequence[str], made: Mapping[int, _Told[Made]]) -> Batch[Made]:
    """What was made, in the order of the files; notes and errors said, the first of each."""
    batch: Batch[Made] = Batch()
    notes, errors = list[str](), list[str]()
    for k, path in enumerate(paths):
        told = made.get(k)
        if told is None:
            continue
        notes += told.notes
        if told.error is not None:
            errors.append(batch.fail(path, told.error))
        else:
            batch.done[path] = cast(Made, told.value)
    for text in shortened(notes, "notes"):
        note(text)
    for text in shortened(errors, "files that are bad: --json names them"):
        complain(text)
    return batch
