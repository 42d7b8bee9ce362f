"""The figure of a real IMU and its twin: both on every axis, the numbers beside them, the liveliest seconds apart."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel import ImuRecording, align
from kreisel.show import plot_twin
from kreisel.show.twin import liveliest
from tests.evaluate.align.moving import Truth, every_way

pytestmark = pytest.mark.filterwarnings("error")


def test_every_axis_has_both_lines_and_its_numbers() -> None:
    recording = Truth(np.random.default_rng(5)).recording()
    found = align(recording, every_way())
    named = ImuRecording(recording.t, recording.gyro, recording.accel, name="Mine")
    figure = plot_twin(named, found)
    assert figure.get_suptitle() == "Mine: the real IMU and its simulated twin"
    assert len(figure.axes) == 12
    for k in range(6):
        whole = figure.axes[2 * k]
        sensor, axis = ("gyro", "accel")[k // 3], k % 3
        real, twin = whole.get_lines()
        np.testing.assert_allclose(real.get_ydata(), getattr(recording, sensor)[:, axis])
        drawn = twin.get_ydata()
        np.testing.assert_allclose(drawn, getattr(found.twin, sensor)[:, axis][-len(drawn) :], atol=1e-12)
        assert f"RMSE {getattr(found, sensor).rmse[axis]:.3g}" in whole.get_title(loc="right")
    texts = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert texts == ["real", "twin"]


def test_the_liveliest_seconds_hold_the_fastest_turn() -> None:
    t = np.arange(1000) / 100.0
    rate = np.zeros((1000, 3))
    rate[600:700, 1] = 5.0
    rate[:50] = np.nan
    first, last = liveliest(t, rate)
    assert first <= 600 and last >= 700 and 1.9 < t[last - 1] - t[first] < 2.01
