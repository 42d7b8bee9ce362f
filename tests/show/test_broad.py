"""Every filter has its mark in every trial, and its mean below them."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.show import plot_broad
from kreisel.study.broad import Score

pytestmark = pytest.mark.filterwarnings("error")

SCORES = [
    Score("dcm", "01_slow", 1.0, 0.8, 0.5, -0.3, 0.7, 0.6),
    Score("vqf", "01_slow", 2.0, 1.8, 0.5, 0.3, 1.7, 1.6),
    Score("dcm", "02_fast", 3.0, 0.8, 0.5, -0.3, 2.7, 2.6),
    Score("vqf", "02_fast", 4.0, 1.8, 0.5, 0.3, 3.7, 3.6),
]


def marks(axes) -> dict[str, list[float]]:
    return {
        line.get_label(): list(line.get_xdata()) for line in axes.get_lines() if len(line.get_xdata()) == 3
    }


def test_marks_stand_at_the_total_errors_and_their_mean() -> None:
    plain, free = plot_broad(SCORES).axes
    assert marks(plain) == {"dcm": [1.0, 3.0, 2.0], "vqf": [2.0, 4.0, 3.0]}
    np.testing.assert_allclose(marks(free)["dcm"], [0.7, 2.7, 1.7])
    assert [text.get_text() for text in plain.get_yticklabels()] == ["01 slow", "02 fast", "mean"]


def test_filters_are_told_apart_by_shape_and_colour() -> None:
    many = [Score(f"filter {k}", "01_slow", 1.0 + k, 1, 1, 1, 1.0 + k, 1) for k in range(7)]
    (legend,) = plot_broad(many).legends
    looks = {(handle.get_marker(), handle.get_color()) for handle in legend.legend_handles}
    assert len(looks) == 7 == len({marker for marker, _ in looks})
