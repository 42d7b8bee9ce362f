"""The figure shows the curves in datasheet units, the asymptotes of what is visible, and the coefficients."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel import ImuRecording, allan
from kreisel.show import plot_allan, style

pytestmark = pytest.mark.filterwarnings("error")

T = np.arange(5000) / 100.0


def white(scale=1.0) -> ImuRecording:
    y = scale * np.random.default_rng(3).standard_normal((5000, 3))
    return ImuRecording(T, y, y, name="Mine")


@pytest.mark.parametrize(("sensor", "factor"), [("gyro", 180.0 / np.pi), ("accel", 1.0)])
def test_curves_are_in_the_unit_of_the_axis(sensor, factor) -> None:
    fit = allan(white(), sensor)
    (axes,) = plot_allan(fit).axes
    for k, colour in enumerate(style.XYZ):
        (line,) = (line for line in axes.get_lines() if line.get_color() == colour)
        np.testing.assert_allclose(line.get_ydata(), fit.deviation[:, k] * factor, rtol=1e-12)
    assert axes.get_xscale() == axes.get_yscale() == "log"


def test_only_visible_terms_have_an_asymptote_and_values() -> None:
    figure = plot_allan(allan(white()))
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.texts] == ["N: white noise"]
    legend = [text.get_text() for text in axes.get_legend().get_texts()]
    # White noise of deviation 1 rad/s at 100 Hz: 0.1 rad/s/sqrt(Hz), 5.73 deg/s/sqrt(Hz).
    assert [float(line.split()[1]) for line in legend] == pytest.approx([5.73] * 3, rel=0.02)
    assert all(line.count("not visible") == 2 for line in legend)
    assert "Mine" in figure.get_suptitle()
