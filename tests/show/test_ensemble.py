"""Pictures of ensembles show what is in them."""

from __future__ import annotations

import re

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
        beyond = re.search(r"(\d+) more beyond", axes.get_xlabel())
        left_out = int(beyond[1]) if beyond else 0
        assert sum(bar.get_height() for bar in axes.patches) + left_out == len(ensemble)


def test_a_single_run_stands_in_the_middle():
    for axes in plot_histograms(monte_carlo(STILL, 1)).axes:
        (x, _), width = axes.lines[0].get_xdata(), np.diff(axes.get_xlim())[0]
        assert axes.get_xlim()[0] + 0.4 * width < x < axes.get_xlim()[1] - 0.4 * width


def test_legends_look_as_what_they_stand_for(ensemble):
    """Bands lie over each other, the inner one darkest; a kind's patch is plain, whatever its first bar is."""
    alphas = [handle.get_alpha() for handle in plot_fans(ensemble).axes[0].get_legend().get_patches()]
    np.testing.assert_allclose(alphas, [0.1, 1.0 - 0.9 * 0.78, 1.0 - 0.9 * 0.78 * 0.6])
    (legend,) = plot_tornado(ensemble).legends
    hatched = {
        text.get_text(): bool(patch.get_hatch())
        for text, patch in zip(legend.get_texts(), legend.get_patches(), strict=True)
    }
    assert hatched == {
        "heading RMSE": False,
        "inclination RMSE": False,
        "by its distance from the median": True,
        "as chance makes them": False,
    }


def test_a_tornado_needs_something_that_varies(ensemble):
    (axes,) = plot_tornado(ensemble).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["imu.imu.p_BS[0]"]
    with pytest.raises(ValueError, match="no number varies"):
        plot_tornado(monte_carlo(STILL, 3))


def test_ensembles_side_by_side_have_a_row_each(ensemble):
    (axes,) = plot_ensembles({"one": ensemble, "two": ensemble}, "heading_max_deg", 1.0).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["one", "two"]
