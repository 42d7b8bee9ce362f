"""Temperature over time."""

import numpy as np
import pytest

from kreisel.data.temperature import TemperatureHistory


def test_it_runs_straight_between_its_times():
    history = TemperatureHistory([0.0, 10.0, 20.0], [20.0, 40.0, 30.0])
    np.testing.assert_allclose(
        history.at(np.array([0.0, 5.0, 10.0, 15.0])), [20.0, 30.0, 40.0, 35.0], rtol=1e-15
    )


def test_a_constant_holds_at_any_time_to_the_bit():
    history = TemperatureHistory.constant(35.7)
    t = np.array([-1e9, 0.0, 1.7e9, 1e12])
    history.check_covers(t[0], t[-1])
    np.testing.assert_array_equal(history.at(t), 35.7)


@pytest.mark.parametrize(
    ("t", "degrees", "message"),
    [
        ([0.0, 0.0], [1.0, 2.0], "t must increase strictly"),
        ([0.0, 1.0], [1.0], "temperature_degC must have one row per time stamp"),
        ([0.0, 1.0], [20.0, -300.0], "temperature_degC must be from -273.15 to 2000, deg C; row 1 is -300"),
        ([0.0, 1.0], [20.0, np.nan], "temperature_degC must be finite"),
    ],
)
def test_what_is_no_temperature(t, degrees, message):
    with pytest.raises(ValueError, match=message):
        TemperatureHistory(t, degrees)


def test_a_history_that_is_too_short():
    with pytest.raises(ValueError, match="must cover the motion, from 0 to 12 s; it covers 0 to 10 s"):
        TemperatureHistory([0.0, 10.0], [20.0, 40.0]).check_covers(0.0, 12.0)
