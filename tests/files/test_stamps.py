"""Printed stamps are exact: integers of nanoseconds, never floats of seconds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kreisel.files.stamps import clock, from_nanoseconds, nanoseconds, seconds_text, to_nanoseconds


def fields(*texts: str) -> np.ndarray:
    return np.array([t.encode() for t in texts], dtype="S48")


def test_a_euroc_stamp_in_seconds_keeps_its_last_nanosecond() -> None:
    # In one float these seconds resolve 238 ns only.
    assert nanoseconds(fields("1403715524.907143168"), 9)[0] == 1403715524907143168


@pytest.mark.parametrize(
    ("text", "digits", "ns"),
    [
        ("12", 9, 12_000_000_000),
        ("-0.5", 9, -500_000_000),
        ("+1.000000001", 9, 1_000_000_001),
        ("1.0000000006", 9, 1_000_000_001),
        ("0.9999999996", 9, 1_000_000_000),
        ("1.5e3", 6, 1_500_000_000),
        ("17.25", 0, 17),
        ("250", 3, 250_000),
        (".5", 9, 500_000_000),
        ("5.", 9, 5_000_000_000),
    ],
)
def test_decimals_are_split_at_the_point(text: str, digits: int, ns: int) -> None:
    assert nanoseconds(fields(text), digits)[0] == ns


@given(st.lists(st.integers(-(2**62), 2**62), min_size=1, max_size=20))
def test_nine_decimals_print_and_parse_every_int64(stamps: list[int]) -> None:
    texts = [f"{'-' if ns < 0 else ''}{abs(ns) // 10**9}.{abs(ns) % 10**9:09d}" for ns in stamps]
    assert nanoseconds(fields(*texts), 9).tolist() == stamps


@given(st.integers(10**15, 2**62), st.lists(st.integers(1, 10**12), min_size=1, max_size=50))
def test_epoch_stamps_survive_t_and_t0(start: int, steps: list[int]) -> None:
    ns = start + np.cumsum([0, *steps], dtype=np.int64)
    t, t0_ns = from_nanoseconds(ns)
    assert (to_nanoseconds(t, t0_ns) == ns).all()
    again, again_t0 = clock(fields(*seconds_text(t, t0_ns)), 9)
    assert again_t0 == t0_ns
    assert (again == t).all()


@given(st.lists(st.floats(-1e5, 1e5), min_size=1, max_size=50))
def test_times_since_a_start_keep_their_bits(values: list[float]) -> None:
    t, t0_ns = clock(fields(*seconds_text(np.array(values), 0)), 9)
    assert t0_ns == 0
    assert t.tobytes() == np.array(values).tobytes()
