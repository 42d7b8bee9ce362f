"""Errors between motions: signs, lengths, and stamps that must agree."""

from dataclasses import replace

import numpy as np
import pytest

from kreisel.evaluate.motion_errors import motion_errors
from kreisel.maths.rotations import exp_so3
from kreisel.simulate.trajectories.lissajous import lissajous

TRUTH = lissajous().sample(np.arange(5) / 10.0)


def test_estimate_minus_truth_in_n():
    turn = np.array([0.01, -0.02, 0.03])
    estimate = replace(
        TRUTH,
        p_NB=TRUTH.p_NB + np.array([3.0, 0.0, 4.0]),
        v_NB=TRUTH.v_NB - [0.0, 2.0, 0.0],
        R_NB=exp_so3(turn) @ TRUTH.R_NB,
    )
    errors = motion_errors(TRUTH, estimate)
    np.testing.assert_allclose(errors.position, 5.0)
    np.testing.assert_allclose(errors.dv_N, np.tile([0.0, -2.0, 0.0], (5, 1)))
    np.testing.assert_allclose(errors.velocity, 2.0)
    np.testing.assert_allclose(errors.dtheta_N, np.tile(turn, (5, 1)), atol=1e-15)
    np.testing.assert_allclose(errors.attitude, np.linalg.norm(turn))
    assert len(errors) == 5


def test_the_same_stamps_after_another_epoch_are_the_same():
    estimate = replace(TRUTH, t=TRUTH.t + 5.0, t0_ns=TRUTH.t0_ns - 5_000_000_000)
    assert motion_errors(TRUTH, estimate).position.max() == 0.0


@pytest.mark.parametrize("other", [lissajous().sample(np.arange(4) / 10.0), replace(TRUTH, t=TRUTH.t + 1e-3)])
def test_other_stamps_are_refused(other):
    with pytest.raises(ValueError, match="same stamps"):
        motion_errors(TRUTH, other)
