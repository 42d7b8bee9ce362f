"""Waves, at times and as means over intervals."""

import numpy as np

from kreisel.maths.waves import add_mean_waves, add_waves


def test_means_are_those_of_many_samples(rng):
    t = np.cumsum(rng.uniform(0.002, 0.02, 50))
    dt = rng.uniform(0.002, 0.02, 50)
    frequency, cosines, sines = rng.uniform(0.1, 300.0, 7), *rng.normal(size=(2, 7, 3))
    x = rng.normal(size=(50, 3))
    mean = add_mean_waves(x, t, dt, frequency, cosines, sines)
    places, weights = np.polynomial.legendre.leggauss(40)
    inside = (t[:, None] - 0.5 * dt[:, None] * (1.0 - places)).ravel()
    waves = add_waves(np.zeros((inside.size, 3)), inside, frequency, cosines, sines).reshape(50, 40, 3)
    # Forty Gauss points see the six turns of the fastest wave to round-off; one turn in 20 ms has 1e-3 of a radian.
    np.testing.assert_allclose(mean, x + np.einsum("g,kga->ka", 0.5 * weights, waves), atol=1e-11)
