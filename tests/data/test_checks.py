"""What users pass in is checked once, kept apart from their own arrays, and refused with a sentence that teaches."""

import numpy as np
import pytest

from kreisel.data import checks
from kreisel.data.motion import Mount
from kreisel.data.trajectory import Poses


def test_lists_and_integers_become_read_only_floats():
    x = checks.shaped("x", [[1, 2, 3]], ("n", 3))
    assert x.dtype == np.float64
    assert not x.flags.writeable


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda: checks.shaped("accel", np.zeros((3, 9)), ("n", 3)),
            ValueError,
            r"got \(3, 9\). Did you mean accel.T",
        ),
        (
            lambda: checks.shaped("accel", "text", ("n", 3)),
            TypeError,
            "accel must be an array of numbers; got str",
        ),
        (lambda: checks.finite("p", np.array([[1.0, np.inf, 0.0]])), ValueError, "row 0 is"),
        (
            lambda: checks.increasing("t", np.array([0.0, 2.0, 1.0])),
            ValueError,
            "runs back from 2 to 1 s at row 2",
        ),
        (lambda: checks.increasing("t", np.array([0.0, 1.0, 1.0])), ValueError, "stands still"),
        (lambda: checks.rotations("R", np.diag([1.0, 1.0, -1.0])), ValueError, "mirrors"),
        (lambda: checks.rotations("R", 1.1 * np.eye(3)), ValueError, "differs from identity by 0.21"),
        (
            lambda: checks.unit_quaternions("q", np.array([[0.5, 0, 0, 0]])),
            ValueError,
            "row 0 has length 0.5",
        ),
        (lambda: checks.choice("method", "splin", ("spline", "auto")), ValueError, "Did you mean 'spline'"),
        (
            lambda: checks.choice(
                "key", "gyro_dps", [f"{s}_{k}" for s in ("gyro", "mag") for k in range(50)]
            ),
            ValueError,
            "^key must be one of 100 names, as 'gyro_[0-9].{,60}; got 'gyro_dps'",
        ),
        (
            lambda: checks.whole_number("run", 1.5),
            ValueError,
            "run must be a whole number, 0 or more; got 1.5",
        ),
        (lambda: checks.whole_number("run", True), ValueError, "whole number"),
        (lambda: checks.same_length(np.zeros(3), v=np.zeros((2, 3))), ValueError, "got 2 rows for 3 stamps"),
        (lambda: Mount(p_BS=[0.1, np.nan, 0.0]), ValueError, "p_BS must be finite"),
    ],
)
def test_mistakes_are_named_with_their_place(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_nouns_keep_their_values_when_the_arrays_they_were_made_of_change():
    t, p = np.arange(3.0), np.ones((3, 3))
    poses = Poses(t, p)
    t[:], p[:] = 7.0, 7.0
    np.testing.assert_array_equal(poses.t, [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(poses.p_NB, np.ones((3, 3)))
    with pytest.raises(ValueError, match="read-only"):
        poses.p_NB[0, 0] = 1.0


def test_read_only_arrays_are_taken_without_a_copy():
    p = checks.read_only(np.ones((3, 3)))
    assert np.shares_memory(Poses(np.arange(3.0), p).p_NB, p)
