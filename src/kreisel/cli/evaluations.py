"""Turns names of estimates and of truths into pairs, and what was found of each pair into a table with its mean."""

from __future__ import annotations

import glob
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from kreisel.cli.batch import SHOWN, expanded, holds_files

_HEADER = ("estimate", "samples", "total", "heading", "inclination", "total max", "converged")
COLUMNS = ("total_rmse_deg", "heading_rmse_deg", "inclination_rmse_deg", "total_max_deg")


def truths_in(given: str) -> list[str] | None:
    """The files of a folder or of a pattern, to be paired by name; None where `given` is one file."""
    place = Path(given)
    if holds_files(place):
        return sorted(str(path) for path in place.iterdir() if not path.name.startswith("."))
    return expanded([given]) if glob.has_magic(given) and not place.exists() else None


def partner(estimate: str, truths: Sequence[str]) -> str:
    """The one of `truths` that is called as the estimate, of several the one whose folder is too; else ValueError."""
    place = Path(estimate)
    same = [path for path in map(Path, truths) if path.stem == place.stem and path != place]
    if len(same) > 1:
        near = [path for path in same if path.parent.name == place.parent.name]
        same = near if len(near) == 1 else same
    if not same:
        raise ValueError(f"{estimate} has no truth: none of {len(truths)} files is called {place.stem!r}.")
    if len(same) > 1:
        raise ValueError(
            f"{estimate} has several truths: {', '.join(map(str, same))}. Choose by a pattern, such as "
            f"'{same[0].parent}/*{same[0].suffix}'."
        )
    return str(same[0])


def mean_of(reports: Sequence[dict[str, Any]]) -> dict[str, float]:
    """The mean over estimates of each column, deg."""
    return {name: sum(r["summary"][name] for r in reports) / len(reports) for name in COLUMNS}


def print_reports(reports: Sequence[dict[str, Any]]) -> None:
    """Print a row for each estimate, the first of many, and the means of all."""
    from kreisel.cli.tables import print_table

    rows = [_row(each["estimate"], each["summary"]) for each in reports[:SHOWN]]
    mean = mean_of(reports)
    foot = [f"mean of {len(reports)}", "", *(f"{mean[name]:.4g}" for name in COLUMNS), ""]
    print("RMSE and largest error, deg:")
    print_table(_HEADER, rows, [foot])
    if len(reports) > SHOWN:
        print(f"shown: the first {SHOWN} of {len(reports)}; --json has all")


def _row(name: str, summary: dict[str, Any]) -> list[str]:
    since = summary["convergence_time_s"]
    return [
        name,
        str(summary["samples"]),
        *(f"{summary[column]:.4g}" for column in COLUMNS),
        "never" if since is None else f"{since:.4g} s",
    ]
