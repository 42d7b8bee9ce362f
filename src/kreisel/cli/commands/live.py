"""Turns samples that arrive line by line on standard input into attitude while it happens: `kreisel live`."""

from __future__ import annotations

import contextlib
import os
import queue
import sys
import threading
from argparse import ArgumentParser, Namespace
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from kreisel.atomic import refuse_unwritable
from kreisel.cli.filters import add_filter_arguments, chosen_filter, tuning_help
from kreisel.cli.inputs import add_trust_units, check_unit, parse_columns
from kreisel.cli.lines import Lines, Sample
from kreisel.cli.output_options import add_output_file
from kreisel.cli.outputs import check_format
from kreisel.cli.values import number
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.facts import impossible_units
from kreisel.data.recording import ImuRecording
from kreisel.estimate.stream import Stream
from kreisel.files.doors import write
from kreisel.files.stamps import seconds_text
from kreisel.maths.rotations import quat_wxyz_from_matrix

HELP = "attitude while it happens, from samples on standard input"

_EXAMPLES = """\
examples:
  cat /dev/ttyUSB0 | kreisel live --gyro-unit deg/s --accel-unit g
  python3 read_my_imu.py | kreisel live --rate 100 -o attitude.tum
  kreisel live < imu.csv > attitude.txt

A line is t gx gy gz ax ay az [mx my mz], between commas, semicolons or blanks: s, rad/s, m/s^2 and uT where nothing
else is said. A header names other columns and units as in our csv files: t [ms], gyro_x [deg/s], ... In a terminal the
attitude is shown ten times a second; elsewhere every sample makes a line of t and the quaternion q_w q_x q_y q_z.
Ctrl-C ends it. docs/live.md has the sketch for a microcontroller.
"""

# Samples after which the units are judged.
_JUDGED = 100

# A line that has not ended after so many bytes comes from a port at the wrong speed.
_LONGEST = 4096

_MOMENT = 0.1  # s


class _View(Protocol):
    """What becomes of the attitude."""

    def __enter__(self) -> Any: ...

    def __exit__(self, *exception: object) -> None: ...

    def show(self, sample: Sample | None, stream: Stream, lines: Lines) -> None:
        """Tell of a sample, or of a moment without one."""
        ...


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "--rate", type=number("hertz", above=0.0), metavar="HZ", help="rate of lines that hold no time"
    )
    for name, ours in (("time", "s"), ("gyro", "rad/s"), ("accel", "m/s^2"), ("mag", "uT")):
        parser.add_argument(
            f"--{name}-unit", metavar="UNIT", help=f"where no header names it (default: {ours})"
        )
    parser.add_argument(
        "--column",
        action="append",
        metavar="NAME=HEADER",
        help="a column of other lines: --column gyro_x='#2 [deg/s]' for the second; may be given several times",
    )
    add_filter_arguments(parser)
    add_trust_units(parser)
    add_output_file(parser, AttitudeHistory, "file to keep the attitude in at the end")
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Follow standard input to its end or to Ctrl-C, then sum up."""
    if "help" in args.set:
        print(tuning_help(args.filter))
        return 0
    if args.output is not None:
        check_format(args.output, args.to)
        refuse_unwritable(args.output)
    units = {"t": args.time_unit, "gyro": args.gyro_unit, "accel": args.accel_unit, "mag": args.mag_unit}
    for group, unit in units.items():
        if unit is not None:
            check_unit(f"--{'time' if group == 't' else group}-unit", unit, group)
    lines = Lines(units, args.rate, parse_columns(args.column))
    filter = chosen_filter(args)
    samples, stream = _Samples(), Stream(filter)
    try:
        _follow(lines, samples, stream, args.trust_units)
    except KeyboardInterrupt:
        # How one leaves an instrument, not a mistake.
        pass
    except BrokenPipeError:
        _keep(args, filter, samples, lines)
        raise
    _keep(args, filter, samples, lines)
    _sum_up(samples, lines, args.output)
    return 0 if lines.good else 1


def _follow(lines: Lines, samples: _Samples, stream: Stream, trusted: bool) -> None:
    # Loaded before the first sample waits for it.
    stream.snapshot()
    with _view() as view:
        for sample in lines.over(_incoming()):
            if sample is not None:
                stream.update(sample.gyro, sample.accel, sample.mag_uT, dt=sample.dt)
                samples.add(sample)
                if len(samples) == _JUDGED and not trusted:
                    samples.refuse_units(lines.t0_ns)
            view.show(sample, stream, lines)
    if len(samples) < _JUDGED and not trusted:
        samples.refuse_units(lines.t0_ns)


def _keep(args: Namespace, filter: Any, samples: _Samples, lines: Lines) -> None:
    """Write the attitude: what a run over the samples says, to the bit what the stream has said."""
    if args.output is not None and len(samples):
        from kreisel.estimate.run import run as estimated

        write(Path(args.output), estimated(filter, samples.recording(lines.t0_ns)), args.to)


def _sum_up(samples: _Samples, lines: Lines, output: str | None) -> None:
    told = []
    if len(samples):
        t = samples.t
        rate = f" at {(len(t) - 1) / (t[-1] - t[0]):.4g} Hz" if len(t) > 1 else ""
        told.append(f"{len(t)} samples over {t[-1] - t[0]:.6g} s{rate}")
    else:
        told.append("no sample on standard input")
    if lines.skipped:
        told.append(lines.told())
    if output is not None and len(samples):
        told.append(f"written: {output}")
    sys.stderr.write("".join(f"kreisel: {line}\n" for line in told))


class _Samples:
    """All samples so far, 80 bytes each."""

    def __init__(self) -> None:
        self._numbers = array("d")

    def __len__(self) -> int:
        return len(self._numbers) // 10

    def add(self, sample: Sample) -> None:
        """Keep one more."""
        self._numbers.extend((sample.t, *sample.gyro, *sample.accel, *sample.mag_uT))

    @property
    def t(self) -> Any:
        """(n,) s."""
        return np.array(self._numbers[::10])

    def recording(self, t0_ns: int) -> ImuRecording:
        """What has been kept, with a magnetometer if any sample had one."""
        table = np.array(self._numbers).reshape(-1, 10)
        mag = table[:, 7:] if np.isfinite(table[:, 7:]).any() else None
        return ImuRecording(table[:, 0], table[:, 1:4], table[:, 4:7], mag, t0_ns, "live")

    def refuse_units(self, t0_ns: int) -> None:
        """ValueError where the numbers cannot be rad/s and m/s^2."""
        impossible = impossible_units(self.recording(t0_ns)) if len(self) else []
        if impossible:
            raise ValueError(
                f"standard input: {' And '.join(impossible)} Name the unit (--accel-unit g, --gyro-unit deg/s), "
                "or insist with --trust-units."
            )


def _incoming() -> Iterator[str | None]:
    """Lines of standard input; None where a moment has passed without a whole one.

    A thread reads, for a moment is not to be waited out: silence is shown too. It reads the descriptor itself: held
    in a buffered read, it would keep the interpreter from ending.
    """
    pieces: queue.Queue[bytes] = queue.Queue(maxsize=64)

    def read(descriptor: int) -> None:
        # A port that is unplugged is an OSError, and the end.
        with contextlib.suppress(OSError):
            while piece := os.read(descriptor, 65536):
                pieces.put(piece)
        pieces.put(b"")

    if sys.stdin is None:
        raise ValueError("standard input is closed. Pipe samples in: cat /dev/ttyUSB0 | kreisel live")
    threading.Thread(target=read, args=(sys.stdin.fileno(),), daemon=True).start()
    rest = b""
    while True:
        try:
            piece = pieces.get(timeout=_MOMENT)
        except queue.Empty:
            yield None
            continue
        *whole, rest = (rest + piece).split(b"\n")
        if len(rest) > _LONGEST or not piece:
            whole, rest = [*whole, rest], b""
        yield from (line.decode("utf-8", "replace") for line in whole)
        if not piece:
            return


def _view() -> _View:
    if not sys.stdout.isatty():
        return _Rows()
    from kreisel.cli.screen import Screen

    return Screen()


class _Rows:
    """A line of numbers per sample, for whatever reads them next."""

    def __init__(self) -> None:
        self._q = np.array([1.0, 0.0, 0.0, 0.0])

    def __enter__(self) -> _Rows:
        return self

    def __exit__(self, *exception: object) -> None: ...

    def show(self, sample: Sample | None, stream: Stream, lines: Lines) -> None:
        """Print t and quaternion, of the sign that goes on from the row before."""
        if sample is None:
            return
        q = quat_wxyz_from_matrix(stream.R_NS)
        self._q = -q if q @ self._q < 0.0 else q
        t = seconds_text(np.array([sample.t]), lines.t0_ns)[0]
        print(t, *(f"{x:.9f}" for x in self._q), flush=True)
