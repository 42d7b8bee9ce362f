"""Turns printed time stamps into exact nanoseconds, those into `t` and `t0_ns`, and all back to text."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import numpy.typing as npt

from kreisel.data.checks import Array

Nanoseconds = npt.NDArray[np.int64]
Fields = npt.NDArray[np.bytes_]

# Below 1e6 s (11 days) float64 seconds still resolve 0.1 ns, so that such stamps are times since a start
# and keep their bits; above it they are an epoch, which only integers carry exactly.
EPOCH_FROM_NS = 1e15


def clock(fields: Fields, digits: int, t0_ns: int | None = None) -> tuple[Array, int]:
    """(t, t0_ns) from printed stamps in units of 10^-digits s.. 9 for seconds, 0 for nanoseconds.

    fields : (n,) byte strings, each a finite number. t0_ns : of the block before, where these go on.
    t : (n,) s after t0_ns. Stamps that start below 1e6 s have t0_ns = 0; others start at t = 0 exactly.
    """
    values = fields.astype(np.float64)
    if t0_ns == 0 or (t0_ns is None and abs(values[0]) * 10.0**digits < EPOCH_FROM_NS):
        return values / 10.0 ** (9 - digits), 0
    ns = nanoseconds(fields, digits)
    return from_nanoseconds(ns) if t0_ns is None else ((ns - t0_ns) / 1e9, t0_ns)


def from_nanoseconds(ns: Nanoseconds) -> tuple[Array, int]:
    """(t, t0_ns) from int64 stamps (n,); small ones (a time since a start) have t0_ns = 0."""
    t0_ns = 0 if abs(int(ns[0])) < EPOCH_FROM_NS else int(ns[0])
    return (ns - t0_ns) / 1e9, t0_ns


def to_nanoseconds(t: Array, t0_ns: int) -> Nanoseconds:
    """int64 stamps (n,): exact for spans up to 26 days, where t * 1e9 still has a spare bit."""
    return np.int64(t0_ns) + np.rint(t * 1e9).astype(np.int64)


def nanoseconds(fields: Fields, digits: int) -> Nanoseconds:
    """Printed decimals as int64 nanoseconds, split at the decimal point and never a float.

    Digits beyond the nanosecond are rounded half up.
    """
    chars = fields.view(np.uint8).reshape(len(fields), -1)
    chars = chars[:, : 1 + int(np.flatnonzero(chars.any(axis=0)).max(initial=0))]
    signed = (chars[:, 0] == ord("-")) | (chars[:, 0] == ord("+"))
    plain = ((chars >= ord("0")) & (chars <= ord("9"))) | (chars == ord(".")) | (chars == 0)
    plain[:, 0] |= signed
    if not plain.all():
        shift = Decimal(10) ** digits
        return np.array(
            [int((Decimal(f.decode()) * shift).to_integral_value()) for f in fields], dtype=np.int64
        )
    magnitude = _accumulate(chars, digits)
    return np.where(chars[:, 0] == ord("-"), -magnitude, magnitude)


def _accumulate(chars: npt.NDArray[np.uint8], digits: int) -> Nanoseconds:
    total = np.zeros(len(chars), dtype=np.int64)
    decimals = np.zeros(len(chars), dtype=np.int64)
    after_point = np.zeros(len(chars), dtype=bool)
    round_up = np.zeros(len(chars), dtype=bool)
    for column in np.ascontiguousarray(chars.T):
        digit = (column >= ord("0")) & (column <= ord("9"))
        kept = digit & (decimals < digits) | digit & ~after_point
        first_dropped = digit & after_point & (decimals == digits)
        total = np.where(kept, total * 10 + (column - np.int64(ord("0"))), total)
        round_up |= first_dropped & (column >= ord("5"))
        decimals += digit & after_point
        after_point |= column == ord(".")
    return np.asarray(total * 10 ** (digits - np.minimum(decimals, digits)) + round_up)


def seconds_text(t: Array, t0_ns: int) -> list[str]:
    """Stamps in seconds: the shortest text with the same bits, or epoch seconds with nine decimals."""
    if t0_ns == 0:
        return list(map(repr, t.tolist()))
    return [_nine_decimals(ns) for ns in to_nanoseconds(t, t0_ns).tolist()]


def _nine_decimals(ns: int) -> str:
    seconds, rest = divmod(abs(ns), 1_000_000_000)
    return f"{'-' if ns < 0 else ''}{seconds}.{rest:09d}"
