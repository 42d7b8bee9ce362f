"""Functions as trajectories: ways to write them, notes, and what is refused."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from kreisel.simulate.trajectories.functions import FunctionTrajectory

Array = npt.NDArray[np.float64]
T = np.arange(0.0, 2.0, 0.01)


def x(t: Array) -> Array:
    return np.cos(2.0 * np.pi * t)


def y(t: Array) -> Array:
    return np.sin(2.0 * np.pi * t)


def test_three_functions_one_function_and_numbers_are_the_same() -> None:
    ways: list[Any] = [
        (x, y, 0.5),
        [x, y, lambda t: 0.5],
        lambda t: (x(t), y(t), 0.5),
        lambda t: np.stack([x(t), y(t), 0.5 + 0.0 * t], axis=1),
    ]
    first, *others = (FunctionTrajectory(way, (0, 0, 0)).sample(T) for way in ways)
    for other in others:
        for name in ("p_NB", "v_NB", "a_NB"):
            np.testing.assert_allclose(getattr(other, name), getattr(first, name), rtol=1e-15, atol=1e-14)


def test_pieces_written_with_numpy_work() -> None:
    ramp = FunctionTrajectory((lambda t: np.where(t < 1.0, 0.5 * t**2, t - 0.5), 0, 0), (0, 0, 0)).sample(T)
    np.testing.assert_allclose(ramp.a_NB[:, 0], np.where(T < 1.0, 1.0, 0.0), atol=1e-14)


def test_notes_say_where_the_path_reverses() -> None:
    motion = FunctionTrajectory((x, 0, 0)).sample(T)
    assert [note.kind for note in motion.notes] == ["heading-jump"] * 3
    np.testing.assert_allclose([note.t for note in motion.notes], [0.5, 1.0, 1.5], atol=1e-11)
    assert "the path reverses: the body turns by 180 deg" in motion.notes[0].text


def test_notes_say_where_the_path_is_vertical_and_its_rates() -> None:
    motion = FunctionTrajectory((x, 0, y)).sample(T + 0.1)
    assert len(motion.notes) == 4
    assert "passes through the vertical" in motion.notes[0].text
    assert "from (0, 6.283, 0) to (0, -6.283, 0) rad/s" in motion.notes[0].text


def test_notes_warn_of_impulses() -> None:
    bend = (
        lambda t: np.where(t < 1.0, t - 1.0, np.sin(t - 1.0)),
        lambda t: np.where(t < 1.0, 0.0, 1.0 - np.cos(t - 1.0)),
        0,
    )
    for orientation in ("tangent", "transport"):
        (note,) = FunctionTrajectory(bend, orientation).sample(T).notes
        assert note.kind == "rate-step" and note.t == pytest.approx(1.0, abs=1e-9)
        assert "steps by 1 rad/s" in note.text and "impulse" in note.text


def test_notes_say_that_a_body_without_heading_has_heading_zero() -> None:
    (note,) = FunctionTrajectory((0, 0, 0)).sample(T).notes
    assert note.kind == "rest" and "heading 0" in note.text


def test_transport_has_no_jumps_where_tangent_has() -> None:
    vertical = (x, 0, y)
    assert FunctionTrajectory(vertical, "tangent").sample(T + 0.1).notes
    assert not FunctionTrajectory(vertical, "transport").sample(T + 0.1).notes


@pytest.mark.parametrize(
    ("position", "orientation", "error", "message"),
    [
        ((x, y), "tangent", TypeError, "position must be three functions.*got 2 of function"),
        (np.zeros((5, 3)), "tangent", TypeError, "Samples go to SampledTrajectory"),
        (None, "tangent", TypeError, "position must be three functions.*got None"),
        ((x, y, 0), (x, y), TypeError, "orientation must be three functions"),
        ((x, y, 0), "tangnt", ValueError, "Did you mean 'tangent'"),
    ],
)
def test_what_is_no_trajectory_is_refused_at_once(
    position: Any, orientation: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        FunctionTrajectory(position, orientation)


@pytest.mark.parametrize(
    ("position", "error", "message"),
    [
        (x, ValueError, "position must return three quantities"),
        ((lambda t: np.sqrt(t), 0, 0), ValueError, "first derivative of position is not finite at t = 0 s"),
        ((lambda t: 1.0 if t > 1.0 else 0.0, 0, 0), TypeError, "np.where"),
        ((lambda t: np.sort(t), 0, 0), TypeError, "sort"),
    ],
)
def test_functions_that_cannot_be_differentiated_are_refused_with_the_cure(
    position: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        FunctionTrajectory(position).sample(T)


def test_a_position_is_refused_with_its_time_whatever_the_orientation() -> None:
    with pytest.raises(
        ValueError, match=r"first derivative of position is not finite at t = 0 s\. It is infinite"
    ):
        FunctionTrajectory((lambda t: t**0.5, 0, 0), (0, 0, 0)).sample(T)


def test_an_exp_that_overflows_is_suspected() -> None:
    """Finite in NumPy: 1 / inf is 0, but its derivative inf / inf."""
    step = FunctionTrajectory((lambda t: 1.0 / (1.0 + np.exp(-1000.0 * (t - 2.0))), 0, 0), (0, 0, 0))
    with pytest.raises(ValueError, match=r"at t = 0 s\. It is undefined: .* exp that overflows.*np\.tanh"):
        step.sample(np.linspace(0.0, 1.0, 5))


def test_orientation_that_is_not_finite_is_named_with_its_time() -> None:
    with pytest.raises(ValueError, match="value of orientation is not finite at t = 1 s"):
        FunctionTrajectory((0, 0, 0), (lambda t: 1.0 / (t - 1.0), 0, 0)).sample(np.array([0.0, 1.0, 2.0]))


def test_span_is_checked() -> None:
    with pytest.raises(ValueError, match=r"span must be \(first, last\).*; got 3\."):
        FunctionTrajectory((x, y, 0), span=3)
    with pytest.raises(ValueError, match="first < last"):
        FunctionTrajectory((x, y, 0), span=(1.0, 1.0))
    with pytest.raises(ValueError, match=r"0 to 1 s; row 101 is 1.01"):
        FunctionTrajectory((x, y, 0), span=(0.0, 1.0)).sample(T)


def test_a_long_request_equals_its_pieces() -> None:
    # Longer than a block, so that seams between blocks are crossed.
    t = np.arange(40_000) / 400.0
    moving = FunctionTrajectory((lambda u: np.cos(u), lambda u: np.sin(2.0 * u), 0))
    whole, piece = moving.sample(t), moving.sample(t[32_000:33_500])
    np.testing.assert_allclose(piece.omega_NB_B, whole.omega_NB_B[32_000:33_500], atol=1e-12)
