"""Samples on straight lines betray the rate of their knots; measured and simulated ones betray none."""

from __future__ import annotations

import numpy as np
import pytest

import kreisel
from kreisel.maths.knots import knot_rate

EIGHT = kreisel.figure_eight(period=8.0)


def interpolated(rng, knots, rate, noise, *, span=20.0, start=0.3, decimals=None):
    """Stamps and positions at `rate` on straight lines between noisy ones at `knots` a second."""
    t, seen = np.arange(0.0, span, 1.0 / rate), (np.arange(-1.0, span * knots + 2.0) + start) / knots
    p = EIGHT.sample(seen - seen[0]).p_NB + noise * rng.normal(size=(len(seen), 3))
    x = np.stack([np.interp(t, seen, column) for column in p.T], axis=1)
    return t, x if decimals is None else np.round(x, decimals)


@pytest.mark.parametrize(
    ("knots", "rate"), [(120.0, 286.0), (100.0, 250.0), (30.0, 200.0), (20.0, 200.0), (5.0, 1000.0)]
)
@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4])
@pytest.mark.parametrize("start", [0.0, 0.3])
def test_the_rate_of_the_knots_is_found(rng, knots, rate, noise, start):
    t, x = interpolated(rng, knots, rate, noise, start=start)
    # One period in the 20 s or fewer that are looked at.
    assert knot_rate(t, x) == pytest.approx(knots, abs=1.0 / 15.0)


def test_decimals_of_a_file_lost_rows_and_gaps_do_not_hide_it(rng):
    t, x = interpolated(rng, 120.0, 286.0, 1e-4, decimals=6)
    kept = (rng.random(len(t)) > 0.02) & ((t < 5.0) | (t > 9.0))
    assert knot_rate(t[kept], x[kept]) == pytest.approx(120.0, abs=0.1)


@pytest.mark.parametrize(
    "kind", ["circle", "figure_eight", "helix", "lissajous", "lying_eight", "rounded_rectangle"]
)
@pytest.mark.parametrize("rate", [100.0, 120.0, 286.0])
@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4])
@pytest.mark.parametrize("step", [0.0, 1e-6, 1e-4, 1e-3])
def test_simulated_poses_have_none(rng, kind, rate, noise, step):
    """Clean, noisy or rounded, on paths that repeat themselves and on straight ones."""
    t = np.arange(0.0, 30.0, 1.0 / rate)
    x = getattr(kreisel, kind)().sample(t).p_NB + noise * rng.normal(size=(len(t), 3))
    assert knot_rate(t, np.round(x / step) * step if step else x) is None


def test_what_repeats_or_rests_has_none(rng):
    t = np.arange(0.0, 20.0, 0.01)
    assert knot_rate(t, np.zeros((len(t), 3))) is None
    assert knot_rate(t, rng.normal(size=(len(t), 3))) is None
    assert knot_rate(t, np.repeat(rng.normal(size=(len(t) // 2, 3)), 2, axis=0)) is None
    assert knot_rate(t[:50], np.outer(t[:50], [1.0, 2.0, 3.0])) is None


def test_an_uninterpolated_camera_that_an_imu_carries_on_has_none(rng):
    """20 corrections a second at 200 Hz, in steps of micrometres: kinks, but curves between them."""
    t = np.arange(0.0, 60.0, 0.005)
    steps = np.repeat(1e-4 * rng.normal(size=(len(t) // 10, 3)), 10, axis=0)
    assert knot_rate(t, np.round(EIGHT.sample(t).p_NB + steps, 6)) is None
