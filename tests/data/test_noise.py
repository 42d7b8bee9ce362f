"""NoiseModel: checked, per axis, and the Allan deviation of its three coefficients."""

import numpy as np
import pytest

from kreisel.data.noise import ALLAN_FLOOR, NoiseModel


def test_one_number_is_for_all_axes_and_three_are_one_each():
    model = NoiseModel(white_noise=2.0, bias_instability=(1.0, 2.0, 3.0))
    assert model.white_noise.tolist() == [2.0, 2.0, 2.0]
    assert model.bias_instability.tolist() == [1.0, 2.0, 3.0]
    assert not model.bias_random_walk.any()


def test_allan_deviation_has_the_slopes_of_its_coefficients():
    tau = np.array([1.0, 100.0])
    # N at one second, a tenth of it at a hundred; the floor; K / sqrt(3) at one second, ten times that later.
    np.testing.assert_allclose(NoiseModel(white_noise=3.0).allan_deviation(tau)[:, 0], [3.0, 0.3])
    np.testing.assert_allclose(NoiseModel(bias_instability=2.0).allan_deviation(tau)[:, 0], 2.0 * ALLAN_FLOOR)
    walk = NoiseModel(bias_random_walk=1.0).allan_deviation(tau)[:, 0]
    np.testing.assert_allclose(walk, np.array([1.0, 10.0]) / np.sqrt(3.0))
    assert pytest.approx(0.6643, abs=1e-4) == ALLAN_FLOOR  # the figure of IEEE Std 952


@pytest.mark.parametrize("name", ["white_noise", "bias_instability", "bias_random_walk", "turn_on_bias"])
def test_negative_values_are_refused_by_name(name):
    with pytest.raises(ValueError, match=f"{name} must be 0 or more, unit"):
        NoiseModel(**{name: -1.0})


def test_a_wandering_bias_needs_its_time():
    with pytest.raises(ValueError, match="needs a correlation_time"):
        NoiseModel(gauss_markov=1.0)
    assert NoiseModel(gauss_markov=1.0, correlation_time=300.0).correlation_time[2] == 300.0
