"""ImuIncrements: what is refused, what is kept."""

import numpy as np
import pytest

from kreisel.data.increments import ImuIncrements

T, ROWS = np.arange(4.0), np.ones((3, 3))


def test_one_row_for_every_interval():
    increments = ImuIncrements(T, ROWS, 2 * ROWS, t0_ns=5, name="unit")
    assert len(increments) == 3
    assert increments.dp is None
    assert (increments.t0_ns, increments.name) == (5, "unit")


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            {"dtheta": np.ones((4, 3))},
            "dtheta must have one row fewer than t has stamps.*got 4 rows for 4 stamps",
        ),
        ({"dv": np.ones((3, 2))}, r"dv must be \(3, 3\); got \(3, 2\)"),
        ({"dp": np.ones(3)}, r"dp must be \(3, 3\)"),
        ({"t": [0.0, 1.0, 1.0, 2.0]}, "stands still"),
        ({"t": []}, "both ends of every interval"),
    ],
)
def test_what_cannot_be_is_refused(columns, message):
    with pytest.raises(ValueError, match=message):
        ImuIncrements(**{"t": T, "dtheta": ROWS, "dv": ROWS} | columns)


def test_arrays_are_read_only_and_the_callers_stay_writable():
    mine = np.ones((3, 3))
    increments = ImuIncrements(T, mine, ROWS)
    with pytest.raises(ValueError, match="read-only"):
        increments.dtheta[0, 0] = 2.0
    mine[0, 0] = 2.0


def test_a_missing_interval_is_life():
    assert np.isnan(ImuIncrements(T, np.full((3, 3), np.nan), ROWS).dtheta).all()


def test_mean_rates_stand_at_the_end_of_their_interval():
    increments = ImuIncrements(
        [1.0, 1.5, 3.5], [[1.0, 0, 0], [0, 4.0, 0]], [[0, 0, 5.0], [np.nan] * 3], t0_ns=7, name="u"
    )
    means = increments.mean_rates()
    np.testing.assert_array_equal(means.t, [1.5, 3.5])
    np.testing.assert_array_equal(means.gyro, [[2.0, 0, 0], [0, 2.0, 0]])
    np.testing.assert_array_equal(means.accel, [[0, 0, 10.0], [np.nan] * 3])
    assert (means.t0_ns, means.name, means.mag_uT) == (7, "u", None)
