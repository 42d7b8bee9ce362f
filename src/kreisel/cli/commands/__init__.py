"""One file per command of `kreisel`; the file's name is the command's."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Protocol


class Command(Protocol):
    """What a module in this folder offers."""

    HELP: str
    """One line for `kreisel --help`."""

    def configure(self, parser: ArgumentParser) -> None:
        """Add the command's arguments."""
        ...

    def run(self, args: Namespace) -> int:
        """Do the job and return the exit code.

        ValueError, TypeError and OSError become one line on stderr and exit code 1.
        """
        ...
