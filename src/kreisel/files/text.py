"""Turns the bytes of a text file into rows of numbers, and what is wrong there into file, line and column."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from kreisel.data.checks import Array
from kreisel.files.stamps import Fields, clock

CONTROL = bytes({*range(32), 127} - {*b"\t\n\v\f\r"})
_NEIGHBOURS = 100  # lines by which the last one is judged
STAMP_WIDTH = 48  # bytes; float64 in full takes 25, nanosecond epochs 20
UTF_16 = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True, slots=True)
class TextFile:
    """A text file, or one block of it, taken apart into lines of data and the comments above them."""

    path: Path
    lines: list[str]  # every line
    rows: list[str]  # the lines that hold data
    comments: list[str]  # comment lines before the first row of the file, without their mark
    first_line: int = 1  # number of the first of the lines
    last: bool = True  # whether its last line is that of the file

    def line_of(self, row: int) -> int:
        """Line number, from 1, of row number `row`, from 0."""
        numbers = (k for k, line in enumerate(self.lines, start=self.first_line) if is_data(line))
        return next(k for i, k in enumerate(numbers) if i == row)

    def error(self, row: int, what: str, column: str | None = None) -> ValueError:
        """A complaint about one row, and one column of it, for the caller to raise."""
        where = f", column {column!r}" if column else ""
        return ValueError(f"{self.path}, line {self.line_of(row)}{where}: {what}")


class Before(NamedTuple):
    """The end of the block before: what the next one has to go on from."""

    stamp: bytes  # as it was printed
    t0_ns: int


def is_data(line: str) -> bool:
    """Whether a line is neither blank nor a comment."""
    stripped = line.lstrip()
    return bool(stripped) and stripped[0] not in "#%"


def read_text(path: Path) -> TextFile:
    """The file's lines; ValueError where it is empty or no text."""
    data = path.read_bytes()
    if not data.strip():
        raise ValueError(f"{path} is empty.")
    return taken_apart(path, decode(path, data))


def taken_apart(path: Path, text: str, above: TextFile | None = None, last: bool = True) -> TextFile:
    """The lines of a whole file, or of the block of it that follows the one `above`."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if not last:
        lines.pop()  # what follows the last line end is the next block's
    rows = [line for line in lines if is_data(line)]
    if above is None:
        if last and not rows:
            raise ValueError(f"{path} has no rows: every line is blank or a comment.")
        file = TextFile(path, lines, rows, comments_above(lines), last=last)
    else:
        file = TextFile(path, lines, rows, above.comments, above.first_line + len(above.lines), last)
    # The first row may be a header.
    if last and lines[-1] and len(rows) > 2 and _ends_early(rows[-1], rows[1:-1][-_NEIGHBOURS:]):
        warnings.warn(
            f"{path}, line {file.first_line + len(lines) - 1}: the last line has no line end, and its last number "
            "fewer digits than is usual in its column; the file may have been cut off there. Compare its size with "
            "the original's.",
            stacklevel=3,
        )
    return file


def _ends_early(last: str, above: Sequence[str]) -> bool:
    """Whether the last number of a line has fewer digits than half of those above it have."""
    return _last_digits(last) < sorted(map(_last_digits, above))[len(above) // 2]


def _last_digits(row: str) -> int:
    return sum(map(str.isdigit, re.split(r"[,;\s]", row.rstrip())[-1]))


def comments_above(lines: Iterable[str]) -> list[str]:
    """The comments before the first row, without their mark."""
    comments = []
    for line in lines:
        if is_data(line):
            break
        comments.append(line.strip().lstrip("#%").strip())
    return [comment for comment in comments if comment]


def decode(path: Path, data: bytes, at: int = 0) -> str:
    """Text in UTF-8, UTF-16 with its mark, or Latin-1 for a degree sign; ValueError on control bytes.

    at : number of the first byte in its file.
    """
    if at == 0 and data[:2] in UTF_16:
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise ValueError(f"{path} is not a text file: broken UTF-16. Save it again as UTF-8.") from None
    if len(data.translate(None, CONTROL)) < len(data):
        k = next(k for k, byte in enumerate(data) if byte in CONTROL)
        raise ValueError(
            f"{path} is not a text file: byte {at + k} is {data[k]:#04x}. "
            "Check that it was not cut or compressed, or name its format."
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def first_rows(head: bytes) -> tuple[list[str], list[str]]:
    """(comments, rows) among the first bytes of a file; both empty where they are no text."""
    try:
        lines = decode(Path(), head).splitlines()
    except ValueError:
        return [], []
    # The last line of the piece may be half a line.
    whole = lines[:-1] if len(lines) > 1 else lines
    return comments_above(whole), [line for line in whole if is_data(line)]


def starts_with_numbers(head: bytes, count: int) -> bool:
    """Whether the first row of a file is `count` numbers between blanks."""
    _, rows = first_rows(head)
    fields = rows[0].split() if rows else []
    return len(fields) == count and all(map(is_number, fields))


def starts_with_nanoseconds(comments: Sequence[str], rows: Sequence[str], widths: Sequence[int]) -> bool:
    """Whether rows look like EuRoC's: one of `widths` numbers between commas, the first an integer stamp."""
    fields = [field.strip() for field in rows[0].split(",")] if rows else []
    if len(fields) not in widths or not fields[0].isdigit() or not all(map(is_number, fields)):
        return False
    announced = bool(comments) and comments[-1].lower().startswith("timestamp")
    # Sixteen digits: nanoseconds since 1970 have nineteen, and nobody prints other integers that long.
    return announced or len(fields[0]) >= 16


def is_number(field: str) -> bool:
    """Whether a field reads as a float, in the digits 0 to 9."""
    try:
        float(field)
    except ValueError:
        return False
    return field.isascii()


def load(
    file: TextFile, delimiter: str | None, names: Sequence[str], stamp: int | None, use: Sequence[int]
) -> tuple[Fields | None, Array]:
    """(stamps, values): column `stamp` as byte strings, columns `use` as float64 (n, len(use)).

    names : one per column of the file, for complaints; every row must have as many fields.
    """
    columns = list(use) if stamp is None else [stamp, *use]
    kind: Any = np.float64
    if stamp is not None:
        kind = np.dtype([("stamp", f"S{STAMP_WIDTH}"), ("values", np.float64, (len(use),))])
    rows, text = file.rows, "\n".join(file.rows)
    if delimiter is not None and _has_gaps(text, delimiter):
        gap = re.compile(rf"(?:(?<={re.escape(delimiter)})|^)[ ]*(?={re.escape(delimiter)}|$)")
        rows = [gap.sub("nan", row.strip(" ")) for row in rows]
    quote = '"' if '"' in text else None
    _check_widths(file, rows, delimiter, len(names))
    try:
        table = np.loadtxt(
            rows, dtype=kind, delimiter=delimiter, usecols=columns, comments=None, quotechar=quote, ndmin=1
        )
    except ValueError as error:
        raise _diagnosis(file, rows, delimiter, names, columns, str(error)) from None
    if stamp is None:
        return None, table.reshape(len(rows), len(use))
    return _stamps(file, np.ascontiguousarray(table["stamp"]), names[stamp]), np.ascontiguousarray(
        table["values"]
    )


def load_timed(
    file: TextFile,
    delimiter: str | None,
    names: Sequence[str],
    use: Sequence[int],
    digits: int,
    nan_ok: bool = False,
    before: Before | None = None,
) -> tuple[Array, Before, Array]:
    """(t, end, values): the stamps in the first column and the numbers in columns `use`, all checked.

    digits : of the stamps' unit down to nanoseconds, as `clock` takes them. nan_ok : NaN is a missing sample.
    before : the end of the block that these rows follow.
    """
    stamps, values = load(file, delimiter, names, 0, use)
    assert stamps is not None  # the column asked for
    t, end = checked_clock(file, stamps, digits, names[0], before)
    return t, end, checked_finite(file, values, [names[k] for k in use], nan_ok)


def _has_gaps(text: str, delimiter: str) -> bool:
    """Whether a field is empty, as loggers leave it where a sensor had no sample."""
    d = delimiter
    inside = d + d in text or f"{d} {d}" in text
    return inside or f"{d}\n" in text or f"\n{d}" in text or text.startswith(d) or text.endswith(d)


def _check_widths(file: TextFile, rows: list[str], delimiter: str | None, width: int) -> None:
    counts = [_width(row, delimiter) for row in rows]
    wrong = np.flatnonzero(np.array(counts) != width)
    if wrong.size:
        k = int(wrong[0])
        hint = "Repair or remove that line."
        if file.last and k == len(rows) - 1 and counts[k] < width:
            hint = "It is the last line: the file was cut off. Copy it again or remove that line."
        elif delimiter == "," and k == 0 and counts[k] >= 2 * width - 1:
            hint = "Are these decimal commas? Write numbers with a decimal point."
        raise file.error(k, f"{counts[k]} fields where {width} are expected. {hint}")


def _width(row: str, delimiter: str | None) -> int:
    if delimiter is None or '"' in row:
        return len(split_row(row, delimiter))
    return row.count(delimiter) + 1


def split_row(row: str, delimiter: str | None) -> list[str]:
    """The fields of a row, blanks and quotes taken off; None splits at blanks."""
    if delimiter is None:
        return row.split()
    if '"' in row:
        return [
            field.strip() for field in next(csv.reader([row], delimiter=delimiter, skipinitialspace=True))
        ]
    return [field.strip() for field in row.split(delimiter)]


def _stamps(file: TextFile, stamps: Fields, column: str) -> Fields:
    full = stamps.view(np.uint8).reshape(len(stamps), -1)[:, -1] != 0
    if full.any():
        k = int(np.argmax(full))
        what = f"the time stamp has {STAMP_WIDTH} characters or more. Write it with fewer decimals."
        raise file.error(k, what, column)
    stripped = np.char.strip(stamps) if (stamps.view(np.uint8) == ord(" ")).any() else stamps
    try:
        values = stripped.astype(np.float64)
    except ValueError as error:
        raise _diagnosis(file, stripped.astype(str).tolist(), None, [column], [0], str(error)) from None
    if not np.isfinite(values).all():
        k = int(np.argmax(~np.isfinite(values)))
        raise file.error(
            k,
            f"the time stamp is {stripped[k].decode()!r}. Every row needs its time; remove that line.",
            column,
        )
    return np.ascontiguousarray(stripped.astype(f"S{STAMP_WIDTH}"))


def _diagnosis(
    file: TextFile,
    rows: list[str],
    delimiter: str | None,
    names: Sequence[str],
    columns: Sequence[int],
    fallback: str,
) -> ValueError:
    """Which field it was, found again row by row."""
    for k, row in enumerate(rows):
        fields = split_row(row, delimiter)
        for c in columns:
            field = fields[c]
            if not is_number(field):
                hint = "Repair or remove that line."
                if re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", field):
                    hint = "This is a decimal comma: write numbers with a decimal point."
                return file.error(k, f"{field!r} is not a number. {hint}", names[c])
    return ValueError(f"{file.path}: {fallback}")


def checked_clock(
    file: TextFile, stamps: Fields, digits: int, column: str, before: Before | None = None
) -> tuple[Array, Before]:
    """(t, end) of stamps that follow those `before`; ValueError with the line where time stands still or runs back."""
    first = 0 if before is None else 1
    if before is not None:
        stamps = np.concatenate([np.array([before.stamp], stamps.dtype), stamps])
    t, t0_ns = clock(stamps, digits, None if before is None else before.t0_ns)
    steps = np.diff(t)
    if steps.size and steps.min() <= 0.0:
        k = int(np.argmax(steps <= 0.0))
        what = "stands still" if steps[k] == 0.0 else "runs back"
        raise file.error(
            k + 1 - first,
            f"time {what}, from {stamps[k].decode()} to {stamps[k + 1].decode()}. "
            "Sort the rows and drop repeated stamps.",
            column,
        )
    return t[first:], Before(stamps[-1], t0_ns)


def checked_finite(file: TextFile, values: Array, names: Sequence[str], nan_ok: bool = False) -> Array:
    """`values` (n, m) itself; ValueError with line and column of the first NaN or infinity."""
    bad = np.isinf(values) if nan_ok else ~np.isfinite(values)
    if bad.any():
        k, c = (int(i) for i in np.argwhere(bad)[0])
        raise file.error(k, f"the value is {values[k, c]}. Remove or fill such rows first.", names[c])
    return values


def checked_quaternions(file: TextFile, q: Array, column: str) -> Array:
    """Quaternions (n, 4) scaled to unit length; ValueError with the line of one that is 1 % off."""
    length = np.linalg.norm(q, axis=1)
    bad = np.abs(length - 1.0) > 1e-2
    if bad.any():
        k = int(np.argmax(bad))
        raise file.error(
            k,
            f"the quaternion has length {length[k]:.4g}, not 1. Check which columns hold it and their order.",
            column,
        )
    return np.asarray(q / length[:, None])


def write_rows(out: BinaryIO, header: str, columns: Sequence[list[str] | Array], delimiter: str) -> None:
    """A header and one line per row; floats in the shortest text that reads back to the same bits."""
    if header:
        out.write((header + "\n").encode())
    # Pieces bound the memory: text takes ten times the room of the numbers.
    piece = 32768
    for start in range(0, len(columns[0]), piece):
        texts = [_texts(column[start : start + piece]) for column in columns]
        out.write("".join(f"{delimiter.join(row)}\n" for row in zip(*texts, strict=True)).encode())


def _texts(column: list[str] | Array) -> list[str]:
    return column if isinstance(column, list) else list(map(repr, column.tolist()))
