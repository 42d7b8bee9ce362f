"""Turns what a command found, or would do, into words or into one JSON object on stdout."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kreisel.cli.batch import shortened

if TYPE_CHECKING:
    from kreisel.files.formats import Content

PLAN_SCHEMA = "kreisel.dry-run/1"


def add_report_arguments(parser: ArgumentParser, dry_run: bool = False) -> None:
    """--json, and with `dry_run` --dry-run; --quiet is every command's."""
    parser.add_argument("--json", action="store_true", help="machine-readable output, with a schema version")
    if dry_run:
        parser.add_argument(
            "--dry-run", action="store_true", help="check the input, say what would be written, write nothing"
        )


def print_json(report: Mapping[str, Any]) -> None:
    """Print a report for programs; NaN, which JSON does not know, is a ValueError."""
    print(json.dumps(report, indent=2, allow_nan=False))


def described(data: Content) -> str:
    """What was read, in a few words."""
    from kreisel.data.trial import Trial

    t = data.recording.t if isinstance(data, Trial) else data.t
    return described_by(type(data).__name__, len(t), float(t[-1] - t[0]) if len(t) else 0.0)


def described_by(noun: str, rows: int, span: float) -> str:
    """The same of so many rows over `span` s."""
    counted = f"{noun}, {rows} row{'' if rows == 1 else 's'}"
    return f"{counted} over {span:.6g} s" if rows else counted


def tell_plan(args: Namespace, reads: Mapping[str, str], writes: Iterable[str | Path]) -> int:
    """What a dry run has found: files read, each with what is in it, and the files that would be written."""
    files = [str(path) for path in writes]
    if args.json:
        print_json({"schema": PLAN_SCHEMA, "command": args.command, "reads": reads, "writes": files})
        return 0
    sound = [f"sound: {path}: {what}" for path, what in reads.items()]
    new = [f"would {'replace' if Path(path).exists() else 'write'}: {path}" for path in files]
    print(
        "\n".join(
            [*shortened(sound, "that are sound"), *shortened(new, "to write"), "dry run: nothing written"]
        )
    )
    return 0
