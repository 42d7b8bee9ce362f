"""Pictures of ensembles show what is in them."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.show import plot_ensembles, plot_fans, plot_histograms, plot_tornado
from kreisel.study.monte_carlo import monte_carlo
from kreisel.study.scenario import Scenario

STILL = Scenario.from_toml(
    "duration = 1.0\nrate_hz = 20.0\ntrajectory = { kind = 'rest' }\nimu = { sensor = 'bmi088' }\n"
    "filter = { kind = 'dcm', published = {} }"
)


@pytest.fixture(scope="module")
def ensemble():
    return monte_carlo(STILL, 30, {"imu.p_BS[0]": "normal(0, 1)"})


def test_fans_show_the_median(ensemble):
    heading, inclination = plot_fans(ensemble).axes
    for axes, kind in ((heading, "heading"), (inclination, "inclination")):
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), ensemble.estimates[0].quantiles[kind][3])
        assert len(axes.collections) == 3


def test_histograms_count_every_run(ensemble):
    for axes in plot_histograms(ensemble).axes:
        assert sum(bar.get_height() for bar in axes.patches) + (
            int(axes.get_title(loc="left").split(", ")[1].split()[0])
            if "beyond" in axes.get_title(loc="left")
            else 0
        ) == len(ensemble)


def test_a_tornado_needs_something_that_varies(ensemble):
    (axes,) = plot_tornado(ensemble).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["imu.imu.p_BS[0]"]
    with pytest.raises(ValueError, match="no number varies"):
        plot_tornado(monte_carlo(STILL, 3))


def test_ensembles_side_by_side_have_a_row_each(ensemble):
    (axes,) = plot_ensembles({"one": ensemble, "two": ensemble}, "heading_max_deg", 1.0).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["one", "two"]
