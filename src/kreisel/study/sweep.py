"""Turns a function of a file and many files into what it made of each, in threads or on Dask."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kreisel.study.engine import spread_out


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one file of a sweep."""

    path: Path  # as it was given
    value: Any = None  # what the function returned
    error: str | None = None  # why there is no value, in one sentence


def sweep(
    function: Callable[[Path], Any],
    paths: Iterable[str | os.PathLike[str]],
    *,
    backend: str | None = None,
    threads: int | None = None,
    on_done: Callable[[int], None] | None = None,
) -> Iterator[Outcome]:
    """`function` of every path, in the order in which they finish; a file that is bad stops no other.

    function : called with the absolute path, which workers on other machines have to see as well; with a backend it
        and what it returns have to be picklable. What it raises of OSError, ValueError and TypeError is an outcome.
    backend, threads : as in `run_blocks`.
    on_done : called with the number of files done so far.
    Raises what `run_blocks` raises, and every other error of `function`, which ends the sweep.
    """
    given = [Path(path) for path in paths]
    work = _Each(function, tuple(path.absolute() for path in given))
    results = spread_out(work, len(given), backend=backend, threads=threads)
    return _outcomes(given, results, on_done)


@dataclass(frozen=True, slots=True)
class _Each:
    function: Callable[[Path], Any]
    paths: tuple[Path, ...]

    def __call__(self, k: int) -> tuple[Any, str | None]:
        try:
            return self.function(self.paths[k]), None
        except (OSError, ValueError, TypeError) as error:
            return None, _sentence(error)


def _outcomes(
    paths: list[Path],
    results: Iterator[tuple[int, tuple[Any, str | None]]],
    on_done: Callable[[int], None] | None,
) -> Iterator[Outcome]:
    for done, (k, (value, error)) in enumerate(results, start=1):
        if on_done is not None:
            on_done(done)
        yield Outcome(paths[k], value, error)


def _sentence(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename and error.strerror:
        return f"{error.filename}: {error.strerror}"
    return str(error)
