"""Fields that come and go: a step between two times, a drift from one to the other."""

import numpy as np
import pytest

from kreisel.simulate.disturbances.drift import FieldDrift
from kreisel.simulate.disturbances.step import FieldStep

FIELD = (3.0, -4.0, 12.0)


def test_a_step_is_there_from_its_start_until_its_end():
    t = np.array([0.0, 0.999, 1.0, 1.5, 2.0, 9.0])
    added = FieldStep(FIELD, 1.0, 2.0).added_N_uT(t, np.zeros((6, 3)))
    np.testing.assert_array_equal(added, np.outer([0, 0, 1, 1, 0, 0], FIELD))
    for_good = FieldStep(FIELD, 1.0).added_N_uT(t, np.zeros((6, 3)))
    np.testing.assert_array_equal(for_good, np.outer([0, 0, 1, 1, 1, 1], FIELD))


def test_a_drift_grows_evenly_and_stays():
    t = np.array([-5.0, 0.0, 2.5, 5.0, 10.0, 99.0])
    added = FieldDrift(FIELD, 0.0, 10.0).added_N_uT(t, np.zeros((6, 3)))
    np.testing.assert_allclose(added, np.outer([0.0, 0.0, 0.25, 0.5, 1.0, 1.0], FIELD), atol=1e-15)


@pytest.mark.parametrize("kind", [FieldStep, FieldDrift])
def test_times_that_do_not_follow_each_other_are_refused(kind):
    with pytest.raises(ValueError, match=r"end must be after start, 5 s; got 3 s\."):
        kind(FIELD, 5.0, 3.0)
    with pytest.raises(ValueError, match=r"end must be after start, 5 s; got 5 s\."):
        kind(FIELD, 5.0, 5.0)
    with pytest.raises(ValueError, match=r"start must be one number, finite, s; got nan"):
        kind(FIELD, np.nan, 5.0)
    with pytest.raises(ValueError, match="field_N_uT must be three finite numbers, uT in N"):
        kind(FIELD[:2], 0.0, 5.0)
    # Motions may begin before zero, and so may what disturbs them.
    assert kind(FIELD, -5.0, -1.0).span[0] == -5.0
