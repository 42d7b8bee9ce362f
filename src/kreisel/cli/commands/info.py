"""Turns files into a short report of what they hold: `kreisel info`."""

from __future__ import annotations

import math
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from kreisel.cli.batch import expanded, over_files
from kreisel.cli.inputs import add_input_arguments, read_input
from kreisel.cli.reports import add_report_arguments, print_json
from kreisel.data.facts import Clock, Facts, facts
from kreisel.files.doors import listing
from kreisel.files.formats import Topic, Undecided

HELP = "what is in a file: rate, span, gaps, plausible units"

_GAPS_SHOWN = 3

_NOUNS = {
    "Poses": "poses",
    "Motion": "complete motion",
    "ImuRecording": "IMU recording",
    "ImuIncrements": "IMU increments",
    "AttitudeHistory": "attitude over time",
    "Reference": "reference attitude",
}

_HOLDS = {"imu": "IMU", "mag": "magnetometer", "poses": "poses", "": ""}
_SAY_WHICH = "More about one with an IMU or poses: --topic NAME."
_NOTHING_TO_READ = "None of its topics has an IMU or poses."


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser, many=True)
    add_report_arguments(parser)


def run(args: Namespace) -> int:
    """Report on every file."""
    batch = over_files(
        expanded(args.input),
        lambda path: (listing(path, args.from_format), _facts(args, path)),
        "reading",
    )
    if args.json:
        files = [
            {"file": path, **_topics_json(topics), **_as_json(what)}
            for path, (topics, what) in batch.done.items()
        ]
        print_json({"schema": "kreisel.info/1", "files": files, "failed": batch.failed})
    else:
        print("\n\n".join("\n".join(_report(path, *found)) for path, found in batch.done.items()))
    return batch.code


def _facts(args: Namespace, path: str) -> Facts | Undecided:
    """What is on the topic asked for, or why there is nothing to tell but the topics."""
    try:
        return facts(read_input(args, path))
    except Undecided as why:
        return why


def _topics_json(topics: Sequence[Topic] | None) -> dict[str, Any]:
    return {} if topics is None else {"topics": [asdict(topic) for topic in topics]}


def _as_json(what: Facts | Undecided) -> dict[str, Any]:
    if isinstance(what, Undecided):
        return {}
    clock = asdict(what.clock) | {"rate_hz": what.clock.rate_hz}
    # JSON knows no NaN: one row has no rate, a sensor that never answered no median.
    return {
        "noun": what.noun,
        "holds": what.holds,
        "clock": {name: _finite(value) for name, value in clock.items()},
        "numbers": {name: _finite(value) for name, value in what.numbers.items()},
        "doubts": what.doubts,
    }


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _report(path: str, topics: Sequence[Topic] | None, what: Facts | Undecided) -> list[str]:
    rows = [*_topics(topics or ()), *([] if isinstance(what, Undecided) else _rows(what))]
    width = max((len(name) for name, _ in rows), default=0)
    lines = [str(Path(path)), *(f"  {name:<{width}}  {text}".rstrip() for name, text in rows)]
    if isinstance(what, Undecided):
        some = any(topic.holds in ("imu", "poses") for topic in topics or ())
        lines.append(f"  {_SAY_WHICH if some else _NOTHING_TO_READ}")
    return lines


def _topics(topics: Sequence[Topic]) -> list[tuple[str, str]]:
    """Pairs of ("topics" or nothing, a topic with what is on it)."""
    widths = [max((len(getattr(topic, part)) for topic in topics), default=0) for part in ("name", "type")]
    lines = [
        f"{topic.name:<{widths[0]}}  {topic.type:<{widths[1]}}  {topic.messages:>7} messages  {_HOLDS[topic.holds]}"
        for topic in topics
    ]
    return [("" if k else "topics", line) for k, line in enumerate(lines)]


def _rows(what: Facts) -> list[tuple[str, str]]:
    """Pairs of (name, what there is to tell)."""
    clock = what.clock
    return [
        ("what", f"{_NOUNS[what.noun]}: {', '.join(what.holds)}"),
        ("rows", f"{clock.rows} over {clock.span:.6g} s"),
        ("start", _start(clock)),
        ("rate", _rate(clock)),
        ("gaps", _gaps(clock)),
        *_numbers(what.numbers),
        *(("look", doubt) for doubt in what.doubts),
    ]


def _start(clock: Clock) -> str:
    if clock.t0_ns == 0:
        return f"t = {clock.start:.6g} s, no epoch"
    ns = clock.t0_ns + round(clock.start * 1e9)
    try:
        moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=ns // 10**9)
    except OverflowError:
        return f"{ns} ns"
    return f"{ns} ns, {moment:%Y-%m-%d %H:%M:%S} UTC if counted from 1970"


def _rate(clock: Clock) -> str:
    if clock.rows < 2:
        return "one row only"
    # Stamps are whole nanoseconds: anything less is round-off of the reading.
    jitter = f"jitter {_time(clock.jitter)}" if clock.jitter > 0.5e-9 else "no jitter"
    return f"{clock.rate_hz:.6g} Hz (median step {_time(clock.step)}, {jitter})"


def _time(seconds: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.4g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _gaps(clock: Clock) -> str:
    if not clock.gaps:
        return "none"
    longest = sorted(clock.gaps, key=lambda gap: -gap.length)[:_GAPS_SHOWN]
    listed = ", ".join(f"{_time(gap.length)} after t = {gap.t:.6g} s" for gap in longest)
    return f"{len(clock.gaps)}; {'the longest: ' if len(clock.gaps) > 1 else ''}{listed}"


def _numbers(numbers: dict[str, float]) -> list[tuple[str, str]]:
    """Pairs of (name, value with unit), the three extents on one line."""
    rows = []
    if "extent x m" in numbers:
        rows.append(("extent", " x ".join(f"{numbers[f'extent {axis} m']:.4g}" for axis in "xyz") + " m"))
    for name, value in numbers.items():
        if name.startswith("extent"):
            continue
        head, _, unit = name.rpartition(" ")
        if "/" in unit or unit in ("m", "uT"):
            rows.append((head, f"{value:.4g} {unit}"))
        else:
            rows.append((name, f"{value:.0f}" if value.is_integer() else f"{value:.4g}"))
    return rows
