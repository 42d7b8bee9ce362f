"""Turns work that is done bit by bit into a bar with the time left, on stderr where a person looks on.

    with Progress(len(paths), "estimating") as progress:
        for path in paths:
            ...
            progress.advance()

Lower floors know nothing of it: they take a callable, such as ``on_done=progress.advance``.
"""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

from kreisel.cli.notes import is_quiet

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

# s: what is over sooner needs no bar, and rich takes 60 ms to load.
_PATIENCE = 0.5


class Progress:
    """A bar that appears when work takes longer than half a second, and leaves no trace.

    Nothing at all where stderr is no terminal, or with --quiet.
    """

    def __init__(self, total: int | None, label: str) -> None:
        """`total` steps, or None where nobody knows how many; `label` says what is done."""
        self._total, self._label, self._done = total, label, 0
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None
        self._bar: Bar | None = None
        self._over = False

    def __enter__(self) -> Progress:
        if not is_quiet() and sys.stderr.isatty():
            # A timer, for one step alone may take longer than a person waits without a word.
            self._timer = threading.Timer(_PATIENCE, self._show)
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(self, *exception: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
        with self._lock:
            self._over = True
            if self._bar is not None:
                self._bar.stop()

    def advance(self, steps: int = 1, label: str | None = None) -> None:
        """`steps` more are done, in any thread; what follows is called `label`."""
        with self._lock:
            self._done += steps
            self._label = label or self._label
            self._update()

    def reach(self, done: int, label: str | None = None) -> None:
        """`done` steps are done in all; what follows is called `label`."""
        self.advance(done - self._done, label)

    def _update(self) -> None:
        if self._bar is not None:
            self._bar.update(self._bar.task_ids[0], completed=self._done, description=self._label)

    def _show(self) -> None:
        from rich import progress as parts
        from rich.console import Console

        with self._lock:
            if self._over:
                return
            known = [parts.MofNCompleteColumn(), parts.TimeRemainingColumn()] if self._total else []
            self._bar = parts.Progress(
                parts.TextColumn("{task.description}"),
                parts.BarColumn(),
                *known,
                *([] if known else [parts.TimeElapsedColumn()]),
                console=Console(stderr=True),
                transient=True,
            )
            self._bar.add_task(self._label, total=self._total, completed=self._done)
            self._bar.start()
