"""Turns the arguments that choose a filter and its tuning into that filter."""

from __future__ import annotations

import math
from argparse import ArgumentParser, Namespace
from collections.abc import Collection, Sequence
from dataclasses import fields
from typing import Any

from kreisel import discovery
from kreisel.cli.values import UsageError, as_typed, number, one_of

FILTERS = "kreisel.estimate.filters"


def add_filter_arguments(parser: ArgumentParser) -> None:
    """--filter, --mode, --set and --declination-deg."""
    parser.add_argument(
        "--filter",
        default="dcm",
        metavar="NAME",
        type=one_of(_names),
        help=f"{', '.join(_names())} (default: dcm)",
    )
    parser.add_argument(
        "--mode",
        type=one_of(("auto", "9", "6", "gyro")),
        help="auto: with the magnetometer where there is one (default); 9: insist on it; 6: without it; "
        "gyro: the gyroscope alone after the start",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="a number of the filter's tuning, in SI units; may be given several times; --set help lists them",
    )
    parser.add_argument(
        "--declination-deg",
        type=number("degrees", lowest=-180.0, highest=180.0),
        metavar="DEG",
        help="magnetic declination, east positive: north is then true north (default 0: magnetic north)",
    )


def chosen_filter(args: Namespace) -> Any:
    """The filter with the tuning asked for, each key and value checked."""
    from kreisel.study.signature import Place, call

    make = _make(args.filter)
    tuning = parse_settings(
        args.set, {field.name for field in fields(make) if isinstance(field.default, str)}
    )
    if args.mode is not None:
        tuning["mode"] = args.mode
    if args.declination_deg is not None:
        tuning["declination"] = math.radians(args.declination_deg)
    with as_typed():
        return call(make, tuning, Place("--set"))


def tuning_help(name: str) -> str:
    """The tuning of a filter as its class declares it, comments and all."""
    import inspect

    make = _make(name)
    lines = [line.strip() for line in inspect.getsource(make).splitlines()]
    keys = tuple(f"{field}:" for field in inspect.signature(make).parameters)
    return "\n".join(line for line in lines if line.startswith(keys))


def parse_settings(pairs: Sequence[str], texts: Collection[str] = ()) -> dict[str, Any]:
    """{"mode": "6", "published": {"exact": True}} from ["mode=6", "published.exact=true"].

    Values are those of TOML, or bare words.
    texts : names whose value is a text even where it looks like a number.
    """
    settings: dict[str, Any] = {}
    for pair in pairs:
        name, equals, value = (part.strip() for part in pair.partition("="))
        *tables, last = name.split(".")
        if not equals or not value or not all([*tables, last]):
            raise UsageError(f"--set takes NAME=VALUE, such as --set accel_time=3; got {pair!r}.")
        inner = settings
        for table in tables:
            inner = inner.setdefault(table, {})
            if not isinstance(inner, dict):
                raise UsageError(f"--set {pair}: {table} has a value already.")
        parsed = _value(value)
        inner[last] = value if name in texts and not isinstance(parsed, str) else parsed
    return settings


def _value(text: str) -> Any:
    import tomllib

    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _names() -> list[str]:
    return [name.replace("_", "-") for name in discovery.names(FILTERS)]


def _make(name: str) -> Any:
    return discovery.load(FILTERS, name.replace("-", "_")).FILTER
