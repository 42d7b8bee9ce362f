"""Turns the state of a filter that runs into an instrument in the terminal, drawn over itself ten times a second."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from kreisel.cli.horizon import drawn, pilots_angles, raster, tape

if TYPE_CHECKING:
    from kreisel.cli.lines import Lines, Sample
    from kreisel.estimate.stream import Snapshot, Stream

_EVERY = 0.1  # s, between pictures
_SILENT = 1.0  # s, after which silence is worth a word

_ROWS, _COLUMNS = 13, 41
_BESIDE = 36  # columns that the numbers take

_GOOD, _BAD, _FAINT = "green", "bold red", "dim"


class Screen:
    """A terminal that shows a stream until the block ends."""

    def __init__(self, console: Console | None = None) -> None:
        self._console = Console(highlight=False, markup=False) if console is None else console
        self._live = Live(console=self._console, auto_refresh=False)
        self._drawn = self._heard = self._since = time.monotonic()
        self._counted = 0
        self._rate = math.nan
        self._latest: tuple[Sample | None, Stream, Lines] | None = None

    def __enter__(self) -> Screen:
        self._live.__enter__()
        return self

    def __exit__(self, *exception: object) -> None:
        if self._latest is not None:
            self._draw(time.monotonic())
        self._live.__exit__(None, None, None)

    def show(self, sample: Sample | None, stream: Stream, lines: Lines) -> None:
        """Take in a sample, or a moment without one, and draw if the last time was long enough ago."""
        now = time.monotonic()
        first = self._latest is None
        if sample is not None:
            self._heard = now
            if self._latest is None or self._latest[0] is None:
                self._since, self._counted = now, lines.good
        elif self._latest is not None:
            sample = self._latest[0]
        self._latest = sample, stream, lines
        if first or now - self._drawn >= _EVERY:
            self._draw(now)

    def _draw(self, now: float) -> None:
        assert self._latest is not None
        sample, stream, lines = self._latest
        self._drawn = now
        if now - self._since >= 1.0:
            self._rate = (lines.good - self._counted) / (now - self._since)
            self._since, self._counted = now, lines.good
        if sample is None:
            picture: Text | Group = _waiting(lines)
        else:
            picture = panel(
                self._console,
                sample,
                stream.snapshot(),
                lines,
                rate_hz=self._rate,
                silence=now - self._heard,
                listens=getattr(stream.filter, "mode", "auto") not in ("6", "gyro"),
            )
        self._live.update(picture, refresh=True)


def panel(
    console: Console,
    sample: Sample,
    now: Snapshot,
    lines: Lines,
    *,
    rate_hz: float,
    silence: float,
    listens: bool,
) -> Group:
    """The instrument after `sample`: horizon and compass where there is room, numbers, what was skipped.

    rate_hz : at which samples arrive, NaN where it is not known yet. silence : s since the latest of them.
    listens : to the magnetometer, where there is one.
    """
    heading, pitch, roll = pilots_angles(now.R_NS)
    numbers = _numbers(heading, pitch, roll)
    numbers.add_row("rate", "-" if math.isnan(rate_hz) else f"{rate_hz:.1f}", "Hz")
    # Zero added to it, a small negative number is not shown as -0.00.
    bias = " ".join(f"{round(x, 2) + 0.0:+.2f}" for x in np.degrees(now.gyro_bias).tolist())
    beside = Group(numbers, f"gyro bias  {bias} deg/s", "", *_flags(sample, now, listens))
    foot = _foot(sample, lines, silence)
    if console.width < _COLUMNS + _BESIDE + 3 or console.height < _ROWS + 4:
        return Group(beside, foot)
    coloured = console.color_system is not None and not console.no_color
    picture = drawn(raster(now.R_NS, _ROWS, _COLUMNS), coloured)
    compass = [Text(tape(heading, _COLUMNS)), Text("|".center(_COLUMNS), _FAINT)]
    whole = Table.grid(padding=(0, 3, 0, 0))
    whole.add_row(Group(*compass, *picture), Group("", "", beside))
    return Group(whole, foot)


def _numbers(heading: float, pitch: float, roll: float) -> Table:
    table = Table.grid(padding=(0, 2, 0, 0))
    table.add_column(width=9)
    table.add_column(justify="right", no_wrap=True)
    table.add_column(no_wrap=True)
    # What rounds to 360 is north.
    table.add_row("heading", Text(f"{round(heading, 1) % 360.0:.1f}", "bold"), "deg from north")
    table.add_row("pitch", Text(f"{pitch:+.1f}", "bold"), "deg nose " + ("up" if pitch >= 0.0 else "down"))
    side = "right" if roll >= 0.0 else "left"
    table.add_row("roll", Text(f"{roll:+.1f}", "bold"), f"deg {side} side down")
    table.add_row("")
    return table


def _flags(sample: Sample, now: Snapshot, listens: bool) -> list[Text]:
    rest = Text("at rest", _GOOD) if now.rest else Text("moving")
    if all(map(math.isnan, sample.mag_uT)):
        field = Text("no magnetometer", _FAINT)
    elif not listens:
        field = Text("magnetometer not used", _FAINT)
    else:
        field = (
            Text("magnetic field disturbed", _BAD) if now.disturbed else Text("magnetic field good", _GOOD)
        )
    return [rest, field, *([Text("held: no gyro, or up not known yet", _BAD)] if now.held else [])]


def _foot(sample: Sample, lines: Lines, silence: float) -> Text:
    foot = Text(f"t = {sample.t:.2f} s   {lines.good} samples   ", no_wrap=True, overflow="ellipsis")
    if silence > _SILENT:
        foot.append(f"silent for {silence:.0f} s   ", _BAD)
    foot.append("Ctrl-C ends", _FAINT)
    if lines.skipped:
        foot.append(f"\n{lines.told()}", _BAD)
    return foot


def _waiting(lines: Lines) -> Text:
    words = Text("waiting for samples: t gx gy gz ax ay az [mx my mz]   ", _FAINT)
    words.append("Ctrl-C ends", _FAINT)
    if lines.skipped:
        words.append(f"\n{lines.told()}", _BAD)
    return words
