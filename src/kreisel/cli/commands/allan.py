"""Turns a recording at rest into a table of noise coefficients and log-log pictures: `kreisel allan`."""

from __future__ import annotations

import json
import math
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kreisel.cli.batch import derived, expanded, over_files
from kreisel.cli.inputs import add_input_arguments, add_trust_units, check_units_of, read_content_blocks
from kreisel.cli.memory import is_long
from kreisel.cli.output_options import add_output_folder
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import number
from kreisel.data.checks import SAME_INSTANT
from kreisel.data.facts import Units
from kreisel.data.frames import to_enu_flu
from kreisel.data.recording import ImuRecording
from kreisel.data.trial import Trial

if TYPE_CHECKING:
    from kreisel.evaluate.allan import AllanFit

HELP = "noise of a sensor at rest: Allan deviation, white noise, bias instability, random walk"

SCHEMA = "kreisel.allan/1"

_EXAMPLES = """\
examples:
  kreisel allan rest.csv
  kreisel allan rest.csv --sensor gyro -o noise/
  kreisel allan 'rest/*.csv' -o noise/            each in a folder of its own
  kreisel allan rest.csv --sensor all             the magnetometer too
  kreisel allan log.csv --column t='Time [ms]' --json
  kreisel allan rest.csv --start 1800           without the half hour of warming up

Leave the sensor still, at a steady temperature, for hours: a term shows where it is longer than its averaging time
by ten times or more. B is the bias instability of IEEE Std 952; the floor of the curve, which many datasheets
print as bias instability, is 0.664 B. N is two-sided as there; noise densities of datasheets are commonly
one-sided, sqrt(2) N. preset.toml in the folder is the same noise as a simulated sensor.
"""

_NAMES = {"N": "white noise N", "B": "bias instability B", "K": "random walk K"}
_SENSORS = {
    "gyro": ("gyro",),
    "accel": ("accel",),
    "mag": ("mag",),
    "both": ("gyro", "accel"),
    "all": ("gyro", "accel", "mag"),
}


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser, many=True)
    parser.add_argument(
        "--sensor", choices=tuple(_SENSORS), default="both", help="which; both is gyro and accel (default)"
    )
    add_output_folder(parser, "folder for pictures, allan.json and preset.toml")
    parser.add_argument(
        "--start",
        type=number("seconds"),
        metavar="S",
        help="leave out what comes before, s after the first sample",
    )
    parser.add_argument(
        "--end",
        type=number("seconds"),
        metavar="S",
        help="leave out what comes after, s after the first sample",
    )
    add_report_arguments(parser, dry_run=True)
    add_trust_units(parser)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, fit, report."""
    from kreisel.evaluate.allan import allan
    from kreisel.files.blocks import joined, mapped

    paths = expanded(args.input)
    folders = _folders(args.output, paths)
    sensors = _SENSORS[args.sensor]

    def one(path: str) -> dict[str, Any]:
        blocks = _blocks(args, path)
        recording = mapped(blocks) if is_long(Path(path)) else joined(list(blocks))
        assert isinstance(recording, ImuRecording)  # the kind asked for
        recording = _piece(recording, args.start, args.end)
        if args.dry_run:
            return {"file": path, "what": described(recording)}
        fits = [allan(recording, sensor) for sensor in sensors]
        report = {"file": path, "sensors": {fit.sensor: _as_json(fit) for fit in fits}}
        files = [] if folders is None else _write(folders[path], {"schema": SCHEMA, **report}, fits)
        if not args.json:
            _print(path, fits, files)
        return report

    batch = over_files(paths, one, "reading" if args.dry_run else "fitting the noise")
    if args.dry_run:
        made = [f for path in batch.done if folders for f in _files_of(folders[path], sensors)]
        tell_plan(args, {path: report["what"] for path, report in batch.done.items()}, made)
    elif args.json:
        files = list(batch.done.values())
        one_alone = files[0] if len(paths) == 1 else {"files": files, "failed": batch.failed}
        print_json({"schema": SCHEMA, **one_alone})
    return batch.code


def _folders(output: Path | None, paths: Sequence[str]) -> dict[str, Path] | None:
    """Where the files of each recording go: FOLDER, or for several a folder of its own in there."""
    if output is None:
        return None
    places = [output] if len(paths) == 1 else derived(paths, str(output), "")
    return dict(zip(paths, places, strict=True))


def _files_of(folder: Path, sensors: Sequence[str]) -> list[Path]:
    return [folder / name for name in ("allan.json", "preset.toml", *(f"allan_{s}.png" for s in sensors))]


def _blocks(args: Namespace, path: str) -> Iterator[ImuRecording]:
    """What the file holds, in our axes; refused at its end where the units of the whole cannot be."""
    units = Units()
    for content in read_content_blocks(args, path, kind="imu"):
        recording = content.recording if isinstance(content, Trial) else content
        block = to_enu_flu(recording, args.frame)
        assert isinstance(block, ImuRecording)  # the kind asked for
        units.add(block)
        yield block
    check_units_of(units, path, args.trust_units)


def _piece(recording: ImuRecording, start: float | None, end: float | None) -> ImuRecording:
    """What lies between two times, s after the first sample; ValueError where that is nothing."""
    if start is None and end is None:
        return recording
    since = recording.t - recording.t[0]
    first, last = (0.0 if start is None else start), (float(since[-1]) if end is None else end)
    rows = slice(*np.searchsorted(since, [first - SAME_INSTANT, last + SAME_INSTANT]))
    if not rows.start < rows.stop:
        raise ValueError(
            f"--start {first:g} and --end {last:g} leave no sample; the recording lasts {since[-1]:.6g} s."
        )
    return recording.rows(rows)


def _as_json(fit: AllanFit) -> dict[str, Any]:
    """SI units; null where a term is not visible."""
    curve = {name: getattr(fit, name).tolist() for name in ("tau", "deviation", "low", "high")}
    terms = {
        name: {part: _numbers(getattr(getattr(fit, name), part)) for part in ("value", "low", "high")}
        for name in _NAMES
    }
    return {"samples": fit.samples, "rate_hz": fit.rate_hz, **terms, "curve": curve}


def _numbers(values: Any) -> list[float | None]:
    return [float(v) if math.isfinite(v) else None for v in values]


def _print(path: str, fits: list[AllanFit], files: list[str]) -> None:
    from kreisel.cli.outputs import aligned
    from kreisel.cli.tables import print_table

    fit = fits[0]
    print(f"{path}: {fit.samples} samples, {fit.samples / fit.rate_hz:.6g} s at {fit.rate_hz:.6g} Hz")
    for fit in fits:
        print()
        print_table([fit.sensor, "unit", "x", "y", "z"], _rows(fit))
    print(
        "\nIn brackets 95 % intervals; < where a term is not visible in this record: it would have shown above.\n"
        "Datasheets commonly state the noise density sqrt(2) N, one-sided, and as bias instability the floor of the "
        "curve, 0.664 B."
    )
    if files:
        print("\n" + aligned(files))


def _rows(fit: AllanFit) -> list[list[str]]:
    from kreisel.evaluate.noise_units import COEFFICIENT

    rows = []
    for term, name in _NAMES.items():
        for unit in COEFFICIENT[fit.sensor][term]:
            cells = [_cell(fit, term, axis, unit.factor) for axis in range(3)]
            rows.append([name if unit is COEFFICIENT[fit.sensor][term][0] else "", unit.name, *cells])
    return rows


def _cell(fit: AllanFit, term: str, axis: int, factor: float) -> str:
    found = getattr(fit, term)
    value, low, high = (factor * part[axis] for part in (found.value, found.low, found.high))
    return f"{value:.3g} ({low:.3g} to {high:.3g})" if math.isfinite(value) else f"< {_two_digits(high)}"


def _two_digits(x: float) -> str:
    """Two digits that count, and no exponent where four or five figures do."""
    return f"{float(f'{x:.2g}'):.5g}"


def _write(folder: Path, report: dict[str, Any], fits: list[AllanFit]) -> list[str]:
    """Write numbers and pictures; one line for each."""
    from kreisel import show
    from kreisel.atomic import replacing

    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / "allan.json") as out:
        out.write((json.dumps(report, indent=2, allow_nan=False) + "\n").encode())
    with replacing(folder / "preset.toml") as out:
        out.write(_preset(fits, report["file"]).encode())
    lines = [
        f"{folder / 'allan.json'}  coefficients and curves in SI units, for programs",
        f"{folder / 'preset.toml'}  the visible terms as a sensor to simulate, Imu.from_preset",
    ]
    for fit in fits:
        path = folder / f"allan_{fit.sensor}.png"
        show.save(show.plot_allan(fit), path)
        lines.append(f"{path}  the curves with their asymptotes")
    return lines


def _preset(fits: list[AllanFit], path: str) -> str:
    from kreisel.data.noise import NoiseModel
    from kreisel.simulate.presets import text_of

    noise = {fit.sensor: fit.noise for fit in fits}
    gyro, accel, mag = (noise.get(sensor, NoiseModel()) for sensor in _SENSORS["all"])
    part, source = fits[0].name or Path(path).stem, f"Allan deviation of {Path(path).name}"
    return text_of(gyro, accel, part, source, mag)
