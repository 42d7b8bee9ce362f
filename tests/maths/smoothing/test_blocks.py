"""Smoothing block by block is smoothing the whole."""

import numpy as np
import pytest

from kreisel.maths.smoothing import blocks
from kreisel.maths.smoothing.blocks import Piece
from kreisel.maths.smoothing.likelihood import Choice
from kreisel.maths.smoothing.system import Samples, Smoothness


def evaluated(piece: Piece, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    value, variance = np.empty((3, len(t), 2)), np.empty((3, len(t)))
    piece(t, 2, value)
    piece.variances(t, range(3), variance)
    return value, variance


@pytest.mark.parametrize("smoothness", [Smoothness(1e4), Smoothness(1e4, 0.02), Smoothness(1e-3)])
def test_blocks_give_what_the_whole_gives(rng, monkeypatch, smoothness):
    t = 0.01 * np.arange(3000.0) + 0.002 * rng.uniform(size=3000)
    x = np.stack([np.sin(t), np.cos(3.0 * t)], axis=1) + 1e-3 * rng.normal(size=(3000, 2))
    samples, at = Samples(t, x), np.sort(rng.uniform(t[0], t[-1], 500))
    whole = Piece(samples, Choice(smoothness, 0.01))
    expected = evaluated(whole, at)
    monkeypatch.setattr(blocks, "BLOCK", 256)
    parts = Piece(samples, Choice(smoothness, 0.01))
    value, variance = evaluated(parts, at)
    # Round-off of equations whose condition is 1e7, differentiated twice over 10 ms; the margin forgets to 1e-16.
    for found, exact in zip(value, expected[0], strict=True):
        np.testing.assert_allclose(found, exact, rtol=0, atol=2e-6 * np.abs(exact).max())
    np.testing.assert_allclose(variance, expected[1], rtol=1e-7)
    np.testing.assert_allclose(parts.energy, whole.energy, rtol=1e-6)


def test_the_variance_of_noise_alone_is_what_draws_show(rng):
    """Of a straight line nothing is smoothed away: what is left is noise, less than standard errors say."""
    t, choice = 0.01 * np.arange(400.0), Choice(Smoothness(1e4), 0.01)
    draws = [evaluated(Piece(Samples(t, rng.normal(size=(400, 2))), choice), t)[0] for _ in range(150)]
    spread = np.mean(np.square(draws), axis=(0, 3))[:, 100:-100].mean(axis=1)
    known = evaluated(Piece(Samples(t, np.zeros((400, 2))), choice), t)[1][:, 100:-100].mean(axis=1)
    shares = np.array([1.0 - blocks.lost_share(order) for order in range(3)])
    # 300 draws of some 40 independent places: a hundredth; at this penalty samples differ from the integrals over all
    # frequencies, from which the shares come, by another.
    np.testing.assert_allclose(spread / known, shares, rtol=0.05)
