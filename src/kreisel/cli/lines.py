"""Turns lines of text that come in one by one into samples of an IMU, and what was wrong with the others into words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal, InvalidOperation
from typing import NamedTuple

from kreisel.files.columns import GROUP_OF, GROUPS, Column, bind, split_unit
from kreisel.files.stamps import EPOCH_FROM_NS
from kreisel.files.text import is_number, split_row
from kreisel.files.units import UNITS, scale

Axes = tuple[float, float, float]

# Columns of lines without a header, by their number.
_PLAIN = ("t", *(f"{group}_{axis}" for group in ("gyro", "accel", "mag") for axis in "xyz"))
_WITHOUT_TIME, _WITH_TIME = (6, 9), (7, 10)

# Lines in a row that lie behind the clock, each later than the one before, after which it has begun anew: a board
# was reset, or its counter of microseconds ran over. Fewer may be echoes of a buffer.
_ANEW = 10

_DIGITS = {"s": 9, "ms": 6, "us": 3, "ns": 0}


class Sample(NamedTuple):
    """What an IMU read, in S."""

    t: float  # s after t0_ns of the lines it is from
    dt: float  # s since the sample before, 0 for the first
    gyro: Axes  # rad/s
    accel: Axes  # m/s^2
    mag_uT: Axes  # NaN where there is none


class Lines:
    """A stream of lines, of which it knows the header, the clock and what has gone wrong so far."""

    def __init__(
        self,
        units: Mapping[str, str | None] | None = None,
        rate_hz: float | None = None,
        columns: Mapping[str, str] | None = None,
    ) -> None:
        """`units` of the groups "t", "gyro", "accel" and "mag" where no header names them; None is ours.

        rate_hz : of lines without time. columns : our name -> header, as `kreisel.read` has it.
        Raises ValueError for a unit that is none and a rate that is not positive.
        """
        if rate_hz is not None and not (rate_hz > 0.0 and math.isfinite(rate_hz)):
            raise ValueError(f"--rate must be a number of hertz above 0; got {rate_hz}.")
        self._units = {group: unit for group, unit in (units or {}).items() if unit is not None}
        for group, unit in self._units.items():
            scale(unit, GROUPS[group][1])
        self._rate_hz = rate_hz
        self._columns = columns
        self._headers: list[str] = []
        self._bound: dict[int, dict[str, Column]] = {}
        self._clock = _Clock()
        self.count = 0  # lines with something on them
        self.good = 0
        self.complaint = ""  # about the first line that was skipped
        self.skipped = 0
        self._number = 0

    @property
    def t0_ns(self) -> int:
        """Epoch of t = 0, ns; 0 for times since a start."""
        return self._clock.t0_ns

    def over(self, lines: Iterable[str | None]) -> Iterator[Sample | None]:
        """What `take` makes of each line, as soon as it is there; None stands for a moment without one.

        The first sample waits for the line after it: who starts to listen in the midst of a line hears its end, which
        may look like a shorter one.
        """
        held, fresh = "", True
        for line in lines:
            if line is None:
                yield None
            elif fresh and _is_numeric(line):
                held, fresh = line, False
            else:
                fresh = fresh and not self._headers
                if held:
                    yield self.take(held, cut=len(_fields(held)) < len(_fields(line)) and _is_numeric(line))
                held = ""
                yield self.take(line)
        if held:
            yield self.take(held)

    def take(self, line: str, cut: bool = False) -> Sample | None:
        """The sample on `line`, None where it has none: it is blank, a header, or skipped and counted.

        cut : its beginning is not there.
        Raises ValueError for a header without gyroscope or accelerometer, or with units that are none.
        """
        self._number += 1
        text = line.strip().strip("\0")
        if not text or self._is_header(text):
            return None
        if text[0] in "#%":
            return None
        self.count += 1
        try:
            if cut:
                raise _Malformed("whose beginning is missing")
            sample = self._sample(_fields(text))
        except _Malformed as malformed:
            self.skipped += 1
            self.complaint = self.complaint or f"line {self._number}, {malformed}"
            return None
        self.good += 1
        return sample

    def told(self) -> str:
        """ "3 of 1200 lines skipped; the first: line 17, ..."; empty where none was."""
        if not self.skipped:
            return ""
        lines = "lines" if self.count > 1 else "line"
        return f"{self.skipped} of {self.count} {lines} skipped; the first: {self.complaint}"

    def _is_header(self, text: str) -> bool:
        """Whether these are names; boards print words of other kinds as they start."""
        headers = _fields(text.lstrip("#% "))
        if len(headers) < 6 or any(map(is_number, headers)):
            return False
        found = bind("standard input", self._with_units(headers), self._columns)
        lacking = [name for name in ("gyro_x", "accel_x") if name not in found]
        if len(lacking) == 2:
            return False
        if lacking:
            raise ValueError(f"standard input, line {self._number}: the header has no column {lacking[0]}.")
        if "t" not in found and self._rate_hz is None:
            raise ValueError(
                f"standard input, line {self._number}: the header has no time. Name its column with "
                "--column t='HEADER [UNIT]', or say --rate HZ."
            )
        if self._headers:
            self._clock.begin_anew()
        self._headers, self._bound = headers, {len(headers): found}
        return True

    def _with_units(self, headers: Sequence[str]) -> list[str]:
        """The headers, with the units asked for where they have none."""
        known = bind("standard input", headers, self._columns)
        units = {column.index: self._units.get(GROUP_OF[name]) for name, column in known.items()}
        plain = [split_unit(header)[1] is None for header in headers]
        return [
            f"{header} [{units[k]}]" if units.get(k) and plain[k] else header
            for k, header in enumerate(headers)
        ]

    def _sample(self, fields: list[str]) -> Sample:
        found = self._bound.get(len(fields)) or self._guessed(len(fields))
        gyro, accel = (_triple(fields, found, group) for group in ("gyro", "accel"))
        mag = _triple(fields, found, "mag") if "mag_x" in found else (math.nan,) * 3
        stamp = found.get("t")
        if stamp is None:
            assert self._rate_hz is not None
            t, dt = self._clock.even(self._rate_hz)
        else:
            t, dt = self._clock.take(fields[stamp.index], stamp)
        return Sample(t, dt, gyro, accel, mag)

    def _guessed(self, width: int) -> dict[str, Column]:
        """The columns of lines without a header, by how many there are."""
        if self._headers:
            raise _Malformed(f"{width} fields where the header has {len(self._headers)}")
        if self._columns:
            headers = [f"#{k}" for k in range(1, width + 1)]
            found = bind("standard input", headers, self._columns)
            if not {"gyro_x", "accel_x"} <= set(found) or ("t" not in found and self._rate_hz is None):
                raise ValueError("--column must name gyro_x ... accel_z, and t where there is no --rate.")
        elif width in _WITH_TIME:
            found = self._plain(_PLAIN[:width])
        elif width in _WITHOUT_TIME and self._rate_hz is not None:
            found = self._plain(_PLAIN[1 : width + 1])
        elif width in _WITHOUT_TIME:
            raise _Malformed(f"{width} numbers and no time: say --rate HZ")
        else:
            expected = "7 or 10" if self._rate_hz is None else "6, 7, 9 or 10"
            raise _Malformed(f"{width} field{'s' if width > 1 else ''} where {expected} are expected")
        self._bound[width] = found
        return found

    def _plain(self, names: Sequence[str]) -> dict[str, Column]:
        return bind("standard input", self._with_units(names), None)


class _Malformed(Exception):
    """Why a line is skipped."""


class _Clock:
    """Stamps that rise, from stamps as they were printed."""

    def __init__(self) -> None:
        self.t0_ns = 0
        self._last: Decimal | None = None  # ns, the latest stamp as printed
        self._shift = Decimal(0)  # ns, of a clock that has begun anew
        self._t = 0.0  # s, of the latest sample
        self._step = 0.0  # s, before it
        self._behind: list[Decimal] = []  # stamps behind the clock, each later than the one before
        self._count = 0

    def begin_anew(self) -> None:
        """Take the next stamp for one that follows the latest, whatever it says."""
        self._behind = [Decimal("-Infinity")] * (_ANEW - 1)

    def even(self, rate_hz: float) -> tuple[float, float]:
        """(t, dt) of the next of samples that come at a rate."""
        t = self._count / rate_hz
        dt = t - (self._count - 1) / rate_hz if self._count else 0.0
        self._count += 1
        return t, dt

    def take(self, field: str, column: Column) -> tuple[float, float]:
        """(t, dt) of a stamp as printed; _Malformed where it is no number or does not rise."""
        stamp = _nanoseconds(field, column)
        if self._last is None:
            self.t0_ns = int(stamp) if abs(stamp) >= EPOCH_FROM_NS else 0
            self._last, self._t = stamp, self._seconds(stamp, field, column)
            return self._t, 0.0
        if stamp <= self._last:
            self._wait(stamp, field)
            self._shift += self._last - stamp + Decimal(self._step or 0.01) * 10**9
        self._behind.clear()
        t = self._seconds(stamp, field, column)
        dt, self._t, self._last = t - self._t, t, stamp
        self._step = dt
        return t, dt

    def _wait(self, stamp: Decimal, field: str) -> None:
        """Let a stamp that does not rise pass after as many of its kind as make a clock; else _Malformed."""
        if self._behind and stamp <= self._behind[-1]:
            self._behind.clear()
        self._behind.append(stamp)
        if len(self._behind) < _ANEW:
            verb = "stands still" if stamp == self._last else "runs back"
            raise _Malformed(f"time {verb} at {_quoted(field)}")

    def _seconds(self, stamp: Decimal, field: str, column: Column) -> float:
        if self._shift or self.t0_ns:
            return float(stamp + self._shift - self.t0_ns) / 1e9
        # The division that files are read with, to the bit.
        return float(field) / 10.0 ** (9 - _digits(column))


def _nanoseconds(field: str, column: Column) -> Decimal:
    try:
        stamp = Decimal(field)
    except InvalidOperation:
        raise _Malformed(f"the time {_quoted(field)} is not a number") from None
    # Stamps are int64 nanoseconds, and so many seconds are milliseconds or less without their name.
    if not stamp.is_finite() or abs(stamp.scaleb(_digits(column))) >= 2**63:
        raise _Malformed(f"the time {_quoted(field)} cannot be in {column.unit or 's'}: say --time-unit")
    return stamp.scaleb(_digits(column))


def _digits(column: Column) -> int:
    return next(_DIGITS[unit] for unit in _DIGITS if column.scale == UNITS["time"][unit])


def _triple(fields: Sequence[str], found: Mapping[str, Column], group: str) -> Axes:
    x, y, z = (_value(fields, found[name]) for name in GROUPS[group][0])
    return x, y, z


def _value(fields: Sequence[str], column: Column) -> float:
    field = fields[column.index]
    if not field:
        return math.nan
    if not is_number(field):
        raise _Malformed(f"{_quoted(field)} is not a number")
    value = float(field)
    if math.isinf(value):
        raise _Malformed(f"{column.name} is {value}")
    return value * column.scale.times / column.scale.over


def _is_numeric(line: str) -> bool:
    return any(map(is_number, _fields(line)))


def _quoted(field: str) -> str:
    return repr(field if len(field) < 30 else field[:27] + "...")


def _fields(text: str) -> list[str]:
    delimiter = next((d for d in (";", "\t", ",") if d in text), None)
    if delimiter is None:
        # "gyro_x [rad/s]" is one name.
        return re.sub(r"\s+([\[(])", r"\1", text).split()
    return split_row(text, delimiter)
