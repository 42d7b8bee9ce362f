"""Turns rows of text into a table on standard output: plain and aligned, or drawn where a person looks on."""

from __future__ import annotations

import sys
from collections.abc import Sequence

Row = Sequence[str]


def print_table(header: Row, rows: Sequence[Row], feet: Sequence[Row] = ()) -> None:
    """Print `rows` under `header`, with `feet` set off below: names to the left, numbers to the right."""
    if sys.stdout.isatty():
        _draw(header, rows, feet)
    else:
        print("\n".join(plain(header, rows, feet)))


def plain(header: Row, rows: Sequence[Row], feet: Sequence[Row] = ()) -> list[str]:
    """The lines of the table without any drawing, for files and pipes."""
    every = [header, *rows, *feet]
    widths = [max(len(row[k]) for row in every) for k in range(len(header))]
    lines = []
    for row in every:
        cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        lines.append("  ".join(cells).rstrip())
    return lines


def _draw(header: Row, rows: Sequence[Row], feet: Sequence[Row]) -> None:
    # rich takes 60 ms to load: only where somebody sees it.
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False, header_style="bold")
    for k, name in enumerate(header):
        table.add_column(name, justify="right" if k else "left", no_wrap=True)
    for k, row in enumerate(rows):
        table.add_row(*row, end_section=k == len(rows) - 1)
    for row in feet:
        table.add_row(*row, style="bold")
    Console(markup=False, highlight=False).print(table)
