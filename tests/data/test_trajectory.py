"""Poses thinned to the rate at which they were seen, which they tell themselves where they were interpolated."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.data.trajectory import Poses

N = 100
T = np.arange(N) / (2000.0 / 7.0)
POSES = Poses(T, np.outer(T, [1.0, 2.0, 3.0]), np.tile(np.eye(3), (N, 1, 1)), t0_ns=5, name="thin")


@pytest.mark.parametrize(
    ("rate_hz", "every"), [(120.0, 3), (2000.0 / 14.0, 2), (2000.0 / 7.0, 1), (1e6, 1), (1.0, 286)]
)
def test_thinned_poses_come_no_faster_than_asked(rate_hz, every) -> None:
    thin = POSES.thinned(rate_hz)
    np.testing.assert_array_equal(thin.t, T[::every])
    np.testing.assert_array_equal(thin.p_NB, POSES.p_NB[::every])
    assert thin.R_NB is not None and len(thin.R_NB) == len(thin)
    assert (thin.v_NB, thin.t0_ns, thin.name) == (None, 5, "thin")


@pytest.mark.parametrize("rate_hz", [0.0, -1.0, np.nan, np.inf])
def test_a_rate_that_is_none_is_refused(rate_hz) -> None:
    with pytest.raises(ValueError, match="rate_hz must be a positive number"):
        POSES.thinned(rate_hz)


def test_the_cameras_rate_is_told_by_the_poses(rng) -> None:
    t, seen = np.arange(600) / (2000.0 / 7.0), np.arange(-1.0, 255.0) / 120.0
    p_NB = [np.interp(t, seen, column) for column in rng.normal(size=(3, len(seen)))]
    # They are two seconds long.
    assert Poses(t, np.transpose(p_NB)).camera_rate() == pytest.approx(120.0, abs=0.5)
    assert POSES.camera_rate() is None
