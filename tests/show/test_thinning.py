"""Few points, same picture."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.show.thinning import alone, along_path, drawable

SEED = 20260


def pieces(t: np.ndarray, y: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The strokes that a line with NaN values in it draws."""
    ends = np.flatnonzero(np.isnan(y))
    return [
        (a[~np.isnan(b)], b[~np.isnan(b)]) for a, b in zip(np.split(t, ends), np.split(y, ends), strict=True)
    ]


def drawn_columns(t: np.ndarray, y: np.ndarray, columns: int, span: tuple[float, float]) -> np.ndarray:
    """Lowest and highest point (columns, 2) that the polyline reaches in each time column."""
    found = np.full((columns, 2), np.nan)
    for at, value in pieces(t, y):
        if not len(at):
            continue
        c = np.clip(((at - span[0]) / (span[1] - span[0]) * columns).astype(int), 0, columns - 1)
        for k, v in zip(c, value, strict=True):
            found[k] = np.fmin(found[k, 0], v), np.fmax(found[k, 1], v)
    return found


def test_short_series_are_drawn_as_they_are() -> None:
    t, y = np.arange(50.0), np.random.default_rng(SEED).normal(size=50)
    np.testing.assert_array_equal(drawable(t, y), (t, y))


@pytest.mark.parametrize("n", [100_000, 123_457])
def test_every_column_keeps_its_smallest_and_largest_value(n: int) -> None:
    rng = np.random.default_rng(SEED)
    t = np.cumsum(rng.uniform(0.5, 1.5, n))  # stamps as uneven as they come
    y = np.cumsum(rng.normal(size=n))
    y[n // 3], y[2 * n // 3] = 1e4, -1e4  # peaks one sample wide
    at, value = drawable(t, y, columns=500)
    assert len(at) <= 4 * 500
    span = (t[0], t[-1])
    np.testing.assert_array_equal(drawn_columns(at, value, 500, span), drawn_columns(t, y, 500, span))
    assert np.isin(at, t).all() and np.all(np.diff(at) > 0.0)


def test_missing_samples_break_the_line_and_survive_thinning() -> None:
    for n in (1000, 100_000):
        t, y = np.arange(float(n)), np.ones(n)
        y[n // 2 : n // 2 + n // 10] = np.nan
        strokes = pieces(*drawable(t, y, columns=500))
        assert [(a[0], a[-1]) for a, _ in strokes] == [(0, n // 2 - 1), (n // 2 + n // 10, n - 1)]


def test_gaps_narrower_than_a_column_are_bridged_only_where_columns_hold_many_samples() -> None:
    t, y = np.arange(100_000.0), np.ones(100_000)
    y[50_000] = np.nan
    assert len(pieces(*drawable(t, y, columns=500))) == 1
    assert len(pieces(*drawable(t[49_900:50_100], y[49_900:50_100]))) == 2


def test_a_slow_sensor_has_no_gaps_but_its_lost_sample_is_one() -> None:
    t, y = np.arange(200.0), np.full(200, np.nan)
    y[::10] = 1.0
    assert len(pieces(*drawable(t, y))) == 1
    y[100] = np.nan
    assert [len(a) for a, _ in pieces(*drawable(t, y))] == [10, 9]


def test_uneven_stamps_alone_are_no_gap() -> None:
    t = np.array([0.0, 1.0, 2.0, 50.0, 51.0])
    assert not np.isnan(drawable(t, np.ones(5))[1]).any()


def test_infinite_samples_are_missing() -> None:
    y = np.ones(20)
    y[5], y[15] = np.inf, -np.inf
    assert [len(a) for a, _ in pieces(*drawable(np.arange(20.0), y))] == [5, 9, 4]


def test_jumps_break_the_line() -> None:
    t = np.arange(8.0)
    y = np.array([170.0, 175, -179, -175, -170, 179, 170, 160])
    strokes = pieces(*drawable(t, y, jump=120.0))
    assert [list(v) for _, v in strokes] == [[170, 175], [-179, -175, -170], [179, 170, 160]]


@pytest.mark.parametrize(
    ("turns", "noise"), [(0.0, 4.0), (40.0, 0.0), (30_000.0, 0.0)], ids=["noise at 180", "some wraps", "spin"]
)
def test_no_stroke_of_a_thinned_angle_crosses_a_wrap(turns: float, noise: float) -> None:
    n, columns = 300_000, 500
    t = np.linspace(0.0, 1.0, n)
    angle = 180.0 + 360.0 * turns * t + noise * np.random.default_rng(SEED).normal(size=n)
    y = (angle + 180.0) % 360.0 - 180.0
    at, value = drawable(t, y, jump=120.0, columns=columns)
    assert len(at) < 12 * columns
    # Values of one side of the wrap are joined to strokes; a heap of dots would leave a fast spin unfilled.
    assert len(alone(value)) < 0.01 * len(value)
    # A stroke that bridges a wrap would be nearly 360 high; a quarter more than half a turn is a fast spin.
    assert max(np.abs(np.diff(v)).max(initial=0.0) for _, v in pieces(at, value)) < 190.0
    span = (0.0, 1.0)
    np.testing.assert_array_equal(drawn_columns(at, value, columns, span), drawn_columns(t, y, columns, span))


def test_alone_finds_samples_without_neighbours() -> None:
    nan = np.nan
    assert alone(np.array([1.0, nan, 2.0, 3.0, nan, 4.0])).tolist() == [0, 5]
    assert alone(np.array([1.0])).tolist() == [0]
    assert alone(np.array([])).tolist() == []


def test_a_thinned_path_stays_near_every_point() -> None:
    s = np.linspace(0.0, 60.0, 200_000)
    p = np.stack([np.cos(s), np.sin(s), 0.01 * s], axis=1)
    rows = along_path(p, finest=0.02)
    assert rows[0] == 0 and rows[-1] == len(p) - 1 and len(rows) < 60 / 0.02 + 3
    # Between kept rows the path is at most `finest` long, so no point is further than that from the first.
    holder = rows[np.searchsorted(rows, np.arange(len(p)), side="right") - 1]
    assert np.linalg.norm(p - p[holder], axis=1).max() <= 0.02 + 1e-12


def test_a_path_without_length_is_its_ends() -> None:
    assert along_path(np.ones((1000, 3)), 0.0).tolist() == [0, 999]
    assert along_path(np.ones((1, 3)), 0.1).tolist() == [0]


def test_a_very_long_path_keeps_a_bounded_number_of_rows() -> None:
    p = np.random.default_rng(SEED).normal(size=(50_000, 3))
    assert len(along_path(p, 1e-6, most=5000)) <= 5001
