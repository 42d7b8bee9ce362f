"""Estimates lie over the truth at the right times, errors carry their RMSE, flags and convergence are marked."""

from __future__ import annotations

import time

import numpy as np
import pytest

from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.maths.rotations import exp_so3, matrix_from_euler
from kreisel.show import plot_attitude, plot_attitude_errors, plot_bias, style

pytestmark = pytest.mark.filterwarnings("error")

N = 1000
T = np.arange(N) / 100.0
PHI = np.column_stack([0.3 * np.sin(T), 0.2 * np.cos(T), 0.1 * T])
R = matrix_from_euler(PHI)


def wrong(dtheta_deg) -> AttitudeHistory:
    """The truth turned by `dtheta_deg` (n, 3) or (3,) about the axes of N."""
    dtheta = np.radians(np.broadcast_to(dtheta_deg, (N, 3)))
    return AttitudeHistory(T, exp_so3(dtheta) @ R, name="Mine")


def line(axes, colour):
    (found,) = (line for line in axes.get_lines() if line.get_color() == colour and len(line.get_xdata()) > 2)
    return found


def entries(axes) -> list[str]:
    return [text.get_text() for text in axes.get_legend().get_texts()]


def remarks(axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_the_estimate_is_drawn_in_degrees_over_the_truth_at_its_own_times() -> None:
    late = Reference(T[::4], R[::4], np.ones(250), t0_ns=500_000_000)
    figure = plot_attitude(AttitudeHistory(T, R, name="Mine"), late)
    assert "Mine" in figure.get_suptitle()
    for k, axes in enumerate(figure.axes):
        np.testing.assert_allclose(line(axes, style.XYZ[k]).get_ydata(), np.degrees(PHI[:, k]), atol=1e-9)
        truth = line(axes, style.TRUTH)
        np.testing.assert_allclose(truth.get_xdata(), T[::4] + 0.5, atol=1e-12)
        np.testing.assert_allclose(truth.get_ydata(), np.degrees(PHI[::4, k]), atol=1e-9)
        assert truth.get_zorder() < line(axes, style.XYZ[k]).get_zorder()


@pytest.mark.parametrize("truth", [None, Poses(T, np.zeros((N, 3)))])
def test_without_a_true_attitude_there_is_none(truth) -> None:
    for axes in plot_attitude(AttitudeHistory(T, R), truth).axes:
        assert "truth" not in entries(axes)


@pytest.mark.parametrize(
    "truth",
    [
        AttitudeHistory(T, R),
        Poses(T, np.zeros((N, 3)), R),
        Motion(T, *np.zeros((3, N, 3)), R, *np.zeros((2, N, 3))),
    ],
)
def test_any_noun_with_attitude_may_be_the_truth(truth) -> None:
    assert "truth" in entries(plot_attitude(AttitudeHistory(T, R), truth).axes[0])


def test_a_reference_out_of_sight_is_a_gap() -> None:
    hidden = R.copy()
    hidden[300:500] = np.nan
    figure = plot_attitude(AttitudeHistory(T, R), Reference(T, hidden, ~np.isnan(hidden[:, 0, 0])))
    t, y = line(figure.axes[1], style.TRUTH).get_data()
    assert not ((t >= 3.0) & (t < 5.0) & np.isfinite(y)).any() and np.isnan(y).any()


def test_flags_are_bars_where_they_are_up_and_absent_where_they_never_are() -> None:
    rest = (T >= 2.0) & (T < 3.0) | (T >= 7.0)
    estimate = AttitudeHistory(T, R, rest=rest, held=np.zeros(N))
    axes = plot_attitude(estimate).axes[2]
    assert "at rest" in entries(axes) and not any("missing" in entry for entry in entries(axes))
    (bars,) = axes.collections
    spans = [(path.vertices[:, 0].min(), path.vertices[:, 0].max()) for path in bars.get_paths()]
    np.testing.assert_allclose(spans, [(2.0, 3.0), (7.0, T[-1])], atol=1e-9)


def test_errors_are_drawn_in_degrees_with_their_rmse() -> None:
    figure = plot_attitude_errors(attitude_errors(AttitudeHistory(T, R), wrong([0.0, 3.0, -4.0])))
    total, heading, inclination = (
        line(axes, colour).get_ydata()
        for axes, colour in zip(figure.axes, (style.INK, style.XYZ[2], style.XYZ[0]), strict=True)
    )
    np.testing.assert_allclose(total, 5.0, rtol=1e-9)
    # Twist and swing of a small rotation are its parts about and across up, to the square of its angle.
    np.testing.assert_allclose(heading, -4.0, rtol=2e-3)
    np.testing.assert_allclose(inclination, 3.0, rtol=2e-3)
    assert [entries(axes)[-1] for axes in figure.axes] == ["RMSE 5°", "RMSE 4°", "RMSE 3°"]


def test_samples_that_do_not_count_are_grey() -> None:
    counts = T >= 4.0
    errors = attitude_errors(Reference(T, R, counts), wrong([1.0, 0.0, 0.0]))
    axes = plot_attitude_errors(errors).axes[0]
    np.testing.assert_array_equal(line(axes, style.UNCOUNTED).get_xdata(), T)
    assert line(axes, style.INK).get_xdata()[0] == 4.0
    assert "not counted" in entries(axes)


def fading(degrees: float, seconds: float) -> AttitudeHistory:
    return wrong(np.outer(degrees * np.exp(-T / seconds), [1.0, 0.0, 0.0]))


def test_convergence_is_marked_at_its_time() -> None:
    figure = plot_attitude_errors(attitude_errors(AttitudeHistory(T, R), fading(50.0, 1.0)), limit_deg=5.0)
    # 50 exp(-t) falls below 5 at ln 10 = 2.303 s; the next sample is at 2.31.
    assert remarks(figure.axes[0]) == ["below 5° for good after 2.31 s"]
    for axes in figure.axes:
        assert any(list(line.get_xdata()) == [2.31, 2.31] for line in axes.get_lines())


def test_errors_that_stay_are_said_to_stay_and_small_ones_need_no_mark() -> None:
    truth = AttitudeHistory(T, R)
    assert remarks(plot_attitude_errors(attitude_errors(truth, wrong([9.0, 0, 0]))).axes[0]) == [
        "never settles below 5°"
    ]
    assert remarks(plot_attitude_errors(attitude_errors(truth, wrong([1.0, 0, 0]))).axes[0]) == []


def test_a_bad_start_leaves_the_rest_readable_and_is_named() -> None:
    estimate = wrong(np.outer(170.0 * np.exp(-T / 0.05) + 1.0, [1.0, 0.0, 0.0]))
    axes = plot_attitude_errors(attitude_errors(AttitudeHistory(T, R), estimate)).axes[0]
    assert axes.get_ylim()[1] < 10.0
    assert "up to 171°, beyond this panel" in entries(axes)


def test_what_was_removed_stands_in_the_title() -> None:
    errors = attitude_errors(AttitudeHistory(T, R), wrong([0.0, 0.0, 7.0]), align="heading")
    assert plot_attitude_errors(errors).get_suptitle() == (
        "Mine: attitude error after removing heading offset 7°"
    )


def test_bias_is_drawn_in_degrees_per_second_over_the_true_one() -> None:
    bias = np.tile([0.01, -0.02, 0.03], (N, 1))
    figure = plot_bias(AttitudeHistory(T, R, bias), truth_bias=np.zeros((2, 3)), truth_t=T[[0, -1]])
    (axes,) = figure.axes
    for column, colour in zip(np.degrees(bias).T, style.XYZ, strict=True):
        assert any(np.array_equal(line.get_ydata(), column) for line in axes.get_lines())
        assert any(
            np.array_equal(line.get_xdata(), T[[0, -1]]) and line.get_color() == colour
            for line in axes.get_lines()
        )
    assert entries(axes) == ["x", "y", "z", "truth"]
    assert entries(plot_bias(AttitudeHistory(T, R, bias)).axes[0]) == ["x", "y", "z"]


def test_a_bias_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match="has no gyro_bias"):
        plot_bias(AttitudeHistory(T, R))
    with pytest.raises(ValueError, match="one row per time stamp"):
        plot_bias(AttitudeHistory(T, R, np.zeros((N, 3))), np.zeros((7, 3)))


def test_one_sample_and_perfect_estimates_can_be_drawn() -> None:
    one = AttitudeHistory(T[:1], R[:1], np.zeros((1, 3)), rest=[1])
    for figure in (
        plot_attitude(one, one),
        plot_attitude_errors(attitude_errors(one, one)),
        plot_bias(one),
        plot_attitude_errors(attitude_errors(AttitudeHistory(T, R), AttitudeHistory(T, R))),
    ):
        figure.draw_without_rendering()


def test_many_samples_draw_fast() -> None:
    n = 300_000
    t = np.arange(n) / 1000.0
    many = AttitudeHistory(t, np.tile(R, (300, 1, 1)), rest=np.arange(n) % 2)
    errors = attitude_errors(many, many)
    began = time.process_time()
    for figure in (plot_attitude(many, many), plot_attitude_errors(errors)):
        figure.draw_without_rendering()
    # 0.8 s of one core when measured.
    assert time.process_time() - began < 3.0
