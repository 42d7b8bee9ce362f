"""Turns a run into one HTML file that shows it: the body in space, played, and every chart beneath it.

The page is made of the templates, styles and scripts in this folder, of Bokeh's own script, and of the numbers; it
loads nothing from anywhere.
"""

from __future__ import annotations

import os
from pathlib import Path

from kreisel.show.saving import drawn_whole, writable
from kreisel.study.account import Account, account_of
from kreisel.study.run import Result


def write_report(result: Result | Account, path: str | os.PathLike[str]) -> Path:
    """Write the report of a run to `path`, an .html file for any browser, without a network.

    result : what `study.run.run` gave, or an Account of files. The file appears under its name only when it is
    complete. Raises ValueError for another suffix, for a run without samples, and where Bokeh is not installed;
    OSError for a place that cannot be written.
    """
    from kreisel.show.report.page import page

    target = writable(path, (".html",))
    text = page(account_of(result) if isinstance(result, Result) else result)
    with drawn_whole(target) as drawing:
        drawing.write(text.encode())
    return target
