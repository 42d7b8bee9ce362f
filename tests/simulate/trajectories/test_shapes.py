"""What single shapes promise beyond the contract of trajectories."""

import numpy as np
import pytest

from kreisel.simulate.trajectories.circle import circle
from kreisel.simulate.trajectories.coning import coning
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.helix import helix
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.trajectories.lying_eight import figure_eight, lying_eight
from kreisel.simulate.trajectories.rounded_rectangle import rounded_rectangle


def test_the_lying_eight_is_the_documents() -> None:
    t = np.linspace(0.0, 1.0, 21)
    u = 2.0 * np.pi * t
    expected = np.stack([0.8 * np.cos(u), 0.8 * np.sin(u) * np.cos(u), 0.3 * np.cos(3.0 * u)], axis=1)
    np.testing.assert_allclose(lying_eight().sample(t).p_NB, expected, atol=1e-14)
    np.testing.assert_allclose(figure_eight(period=8.0).sample(8.0 * t).p_NB, expected, atol=1e-14)


def test_a_rounded_rectangle_says_when_its_rate_steps() -> None:
    shape = rounded_rectangle()
    notes = shape.sample(np.arange(0.0, 2.0 * shape.lap, 0.01)).notes
    # Half a side of 0.4 m, then corners of 0.05 pi m and sides of 0.8 m, at 0.8 m/s.
    pieces = np.array([0.4, *[0.05 * np.pi, 0.8] * 7, 0.05 * np.pi])
    np.testing.assert_allclose([note.t for note in notes], np.cumsum(pieces) / 0.8, rtol=1e-14)
    assert all(note.kind == "rate-step" and "steps by 8 rad/s" in note.text for note in notes)


def test_a_row_at_a_joint_belongs_to_what_follows() -> None:
    shape = rounded_rectangle()
    joints = np.array([note.t for note in shape.sample(np.array([0.0, 50.0 * shape.lap])).notes])
    rate = shape.sample(joints).omega_NB_B[:, 2]
    np.testing.assert_allclose(rate[0::2], 8.0)
    np.testing.assert_array_equal(rate[1::2], 0.0)


def test_a_rounded_rectangle_closes_and_keeps_within_its_sides() -> None:
    shape = rounded_rectangle(length=2.0, width=1.0, radius=0.25, speed=0.5)
    motion = shape.sample(np.linspace(0.0, shape.lap, 4001))
    np.testing.assert_allclose(motion.p_NB[[0, -1]], [[0.0, -0.5, 0.0]] * 2, atol=1e-12)
    np.testing.assert_allclose(np.abs(motion.p_NB).max(axis=0), [1.0, 0.5, 0.0], atol=1e-12)
    steps = np.linalg.norm(np.diff(motion.p_NB, axis=0), axis=1)
    # A chord of 1.4 mm falls short of its arc by (1.4e-3 / 0.25)^2 / 24.
    np.testing.assert_allclose(steps, shape.lap / 4000.0 * 0.5, rtol=2e-6)


def test_without_sides_a_rounded_rectangle_is_a_circle() -> None:
    shape = rounded_rectangle(length=1.0, width=1.0, radius=0.5, speed=1.0)
    motion = shape.sample(np.linspace(0.0, 2.0 * shape.lap, 200))
    np.testing.assert_allclose(np.linalg.norm(motion.p_NB, axis=1), 0.5, rtol=1e-14)
    assert motion.notes == ()


def test_the_joints_of_a_rounded_rectangle_are_found_in_its_functions_too() -> None:
    # One corner written as a user would, against the closed form.
    s0, r, speed = 0.4, 0.1, 0.8
    corner = FunctionTrajectory(
        (
            lambda t: np.where(speed * t < s0, speed * t, s0 + r * np.sin((speed * t - s0) / r)),
            lambda t: np.where(speed * t < s0, -0.5, -0.5 + r - r * np.cos((speed * t - s0) / r)),
            0,
        )
    )
    t = np.linspace(0.0, 0.69, 101)
    ours, theirs = corner.sample(t), rounded_rectangle().sample(t)
    for name in ("p_NB", "v_NB", "a_NB", "R_NB", "omega_NB_B"):
        np.testing.assert_allclose(getattr(ours, name), getattr(theirs, name), atol=1e-12, err_msg=name)
    assert [note.text for note in ours.notes] == [note.text for note in theirs.notes]


@pytest.mark.parametrize(
    ("change", "message"),
    [({"radius": 0.6}, "at most half a side, 0.5 m"), ({"speed": 0.0}, "speed must be above")],
)
def test_impossible_rectangles_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        rounded_rectangle(**change)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: circle(1.0, 0.0), "period must not be 0"),
        (lambda: helix(1.0, 1.0, 0.0), "period must not be 0"),
        (lambda: lying_eight(0.0), "period must not be 0"),
        (lambda: circle(np.nan), "radius must be a finite number; got nan"),
        (lambda: rounded_rectangle(length=np.nan), "length must be a finite number; got nan"),
        (lambda: rounded_rectangle(speed=np.inf), "speed must be a finite number; got inf"),
        (lambda: coning(rate=np.nan), "rate must be a finite number; got nan"),
        (lambda: lissajous(frequency="1"), "frequency must be a finite number; got '1'"),
    ],
)
def test_numbers_that_make_no_shape_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()
