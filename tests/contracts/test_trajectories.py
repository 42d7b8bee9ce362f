"""What every trajectory promises: sampling is a function of time, and its derivatives belong together."""

import numpy as np
import numpy.typing as npt
import pytest

from kreisel import discovery
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Trajectory
from kreisel.maths.rotations import log_so3

Array = npt.NDArray[np.float64]

PACKAGE = "kreisel.simulate.trajectories"
VECTORS = ("p_NB", "v_NB", "a_NB", "omega_NB_B", "alpha_NB_B")


@pytest.fixture(params=discovery.names(PACKAGE))
def trajectory(request: pytest.FixtureRequest) -> Trajectory:
    made = discovery.load(PACKAGE, request.param).example()
    assert isinstance(made, Trajectory)
    return made


def times(trajectory: Trajectory, n: int = 201) -> Array:
    """Uneven times inside the span, away from its ends."""
    first, last = np.clip(trajectory.span, -1.0, 4.0)
    u = np.linspace(0.03, 0.97, n)
    return first + (last - first) * (u + 0.002 * np.sin(40.0 * u))


def smooth_rows(motion: Motion, t: Array, reach: float) -> npt.NDArray[np.bool_]:
    """Rows with no step of attitude or rate within `reach` s, by the motion's own notes."""
    steps = np.array([note.t for note in motion.notes if note.t is not None])
    return np.abs(t[:, None] - steps).min(axis=1, initial=np.inf) > reach


def test_every_field_is_there_and_finite(trajectory: Trajectory) -> None:
    t = times(trajectory)
    motion = trajectory.sample(t)
    np.testing.assert_array_equal(motion.t, t)
    for name in (*VECTORS, "R_NB"):
        assert np.isfinite(getattr(motion, name)).all(), name


def test_attitudes_are_rotations(trajectory: Trajectory) -> None:
    R = trajectory.sample(times(trajectory)).R_NB
    # Products of a few sines and cosines.
    np.testing.assert_allclose(
        np.einsum("nji,njk->nik", R, R), np.tile(np.eye(3), (len(R), 1, 1)), atol=3e-15
    )
    assert (np.linalg.det(R) > 0.0).all()


def test_derivatives_agree_with_finite_differences(trajectory: Trajectory) -> None:
    h, t = 1e-5, times(trajectory, 51)
    before, now, after = (trajectory.sample(t + shift) for shift in (-h, 0.0, h))
    smooth = smooth_rows(trajectory.sample(np.linspace(t[0] - h, t[-1] + h, 401)), t, 2.0 * h)
    assert smooth.any()
    for value, rate in (("p_NB", "v_NB"), ("v_NB", "a_NB"), ("omega_NB_B", "alpha_NB_B")):
        slope = (getattr(after, value) - getattr(before, value)) / (2.0 * h)
        exact = getattr(now, rate)
        # Truncation h^2 / 6 times a third derivative; round-off 1e-15 / h of what is differenced.
        scale = 1.0 + np.abs(exact).max() + np.abs(getattr(now, value)).max()
        np.testing.assert_allclose(
            slope[smooth], exact[smooth], atol=2e-6 * scale, err_msg=f"{value} -> {rate}"
        )
    turn = log_so3(np.einsum("nji,njk->nik", before.R_NB, after.R_NB)) / (2.0 * h)
    scale = 1.0 + np.abs(now.omega_NB_B).max()
    np.testing.assert_allclose(turn[smooth], now.omega_NB_B[smooth], atol=1e-6 * scale)


def test_a_row_does_not_depend_on_the_others(trajectory: Trajectory) -> None:
    t = times(trajectory)
    whole = trajectory.sample(t)
    for rows in (slice(0, 1), slice(77, 78), slice(13, 90), slice(0, None, 7)):
        part = trajectory.sample(t[rows])
        for name in (*VECTORS, "R_NB"):
            exact = getattr(whole, name)[rows]
            # Vectorised sines differ in their last bit between the body and the tail of a loop.
            scale = 1.0 + np.abs(getattr(whole, name)).max()
            np.testing.assert_allclose(getattr(part, name), exact, rtol=0.0, atol=1e-12 * scale, err_msg=name)


def test_times_are_left_as_they_were(trajectory: Trajectory) -> None:
    t = times(trajectory)
    copy = t.copy()
    motion = trajectory.sample(t)
    np.testing.assert_array_equal(t, copy)
    assert t.flags.writeable and not motion.p_NB.flags.writeable


def test_the_span_is_kept(trajectory: Trajectory) -> None:
    first, last = trajectory.span
    assert first < last
    if np.isfinite(last):
        with pytest.raises(ValueError, match="t must lie"):
            trajectory.sample(np.array([last + 1.0]))


def test_times_that_run_back_are_refused(trajectory: Trajectory) -> None:
    with pytest.raises(ValueError, match="t must increase strictly"):
        trajectory.sample(np.array([1.0, 0.5]))
