"""Turns the words that say where results go into options of a command: a folder, or one file and its format."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from kreisel.cli.batch import in_the_way
from kreisel.cli.values import UsageError, one_of
from kreisel.files.doors import format_names
from kreisel.files.formats import Noun


def output_folder(text: str) -> Path:
    """The folder that an option names; for argparse, as `type`."""
    if not text.strip():
        raise UsageError("takes the name of a folder; got an empty one. Write . for the current folder.")
    folder = Path(text)
    if obstacle := in_the_way(folder):
        raise UsageError(f"must be a folder; {obstacle} is a file.")
    return folder


def picture_file(text: str) -> str:
    """The name of a picture; for argparse, as `type`."""
    from kreisel.show.saving import PICTURES

    if Path(text).suffix.lower() not in PICTURES:
        raise UsageError(f"must end in {' or '.join(PICTURES)}; got {text!r}.")
    return text


def add_output_folder(
    parser: ArgumentParser,
    what: str = "folder for what is made",
    *,
    required: bool = False,
    default: str | None = None,
) -> None:
    """-o, a folder: a Path, or None where it is not given and has no default."""
    parser.add_argument(
        "-o",
        "--output",
        type=output_folder,
        required=required,
        default=default,
        metavar="FOLDER",
        help=what,
    )


def add_output_file(
    parser: ArgumentParser, noun: type[Noun], what: str, otherwise: str = "by OUT's suffix"
) -> None:
    """-o, a file with a `noun` in it, and --to, its format; `otherwise` tells what that is without --to."""
    parser.add_argument("-o", "--output", metavar="OUT", help=what)
    parser.add_argument(
        "--to",
        metavar="FORMAT",
        type=one_of(lambda: format_names(noun)),
        help=f"{', '.join(format_names(noun))} (default: {otherwise})",
    )
