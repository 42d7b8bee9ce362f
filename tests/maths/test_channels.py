"""Ramps and the quantities they drive, and integrals over time."""

import numpy as np
import pytest

from kreisel.maths.channels import RAMP_SLOPE, Ramp, cell_edges, change, channel, lasts
from kreisel.maths.running_integral import RunningIntegral


def test_a_change_is_made_in_its_time():
    ramps = change(3.0, 4.0, 1.0)
    assert lasts(ramps) == 4.0
    quantity = channel(10.0, ramps)
    value, rate, bend, jolt = quantity(np.array([0.0, 1.0, 2.0, 3.0, 4.0]), 3)[..., 0]
    np.testing.assert_allclose(value[[0, 4]], [10.0, 13.0], atol=1e-14)
    np.testing.assert_allclose(rate, [0.0, 1.0, 1.0, 1.0, 0.0], atol=1e-14)
    np.testing.assert_allclose([bend, jolt], 0.0, atol=1e-13)


def test_the_rate_and_two_derivatives_of_it_are_continuous():
    quantity = channel(
        0.0, [*change(1.0, 2.0, 0.5), Ramp(0.5, 0.0, 2.0), Ramp(0.0, 2.0, 2.0), Ramp(1.0, 2.0, -1.0)]
    )
    for at in quantity.breaks[1:-1]:
        before, after = quantity(np.array([at - 1e-9, at]), 3)[..., 0].T
        # 1e-9 s times the next derivative, of some hundred.
        np.testing.assert_allclose(before, after, atol=1e-6)


def test_the_slope_of_a_ramp():
    quantity = channel(0.0, [Ramp(1.0, 0.0, 1.0)])
    assert quantity(np.linspace(0.0, 1.0, 101), 2)[2].max() == pytest.approx(RAMP_SLOPE, rel=1e-12)


def test_a_change_that_is_short_of_time_has_no_steady_part():
    assert change(1.0, 1.0, 5.0) == [Ramp(0.5, 0.0, 2.0), Ramp(0.0, 2.0, 2.0), Ramp(0.5, 2.0, 0.0)]


def test_cells_end_at_breaks_and_turn_little():
    turning, other = (
        channel(0.0, [Ramp(1.0, 0.0, 0.0), Ramp(2.0, 0.0, 6.0)]),
        channel(0.0, [Ramp(3.0, 1.0, 1.0)]),
    )
    edges = cell_edges([turning], [other])
    assert {0.0, 1.0, 3.0} <= {*edges}
    assert np.diff(turning(edges, 0)[0, :, 0]).max() <= 0.5


def test_an_integral_of_waves_is_exact_at_any_time():
    edges = np.linspace(0.0, 20.0, 51)
    integral = RunningIntegral(lambda t: np.stack([np.cos(t), np.exp(-t), t**15 / 1e15], axis=1), edges)
    t = np.linspace(0.0, 20.0, 333)
    exact = np.stack([np.sin(t), 1.0 - np.exp(-t), t**16 / 16e15], axis=1)
    # Fifty cells of round-off; the last column reaches 4e4.
    np.testing.assert_allclose(integral(t), exact, rtol=1e-13, atol=1e-13)
