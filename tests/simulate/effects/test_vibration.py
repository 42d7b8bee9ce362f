"""Vibration, as lines and as a spectrum."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.simulate.effects.vibration_lines import VibrationLines
from kreisel.simulate.effects.vibration_noise import VibrationNoise
from tests.simulate.effects.recordings import error_at_rest, first_errors

T = np.arange(2000) / 200.0


def seed_of(rng: np.random.Generator) -> int:
    return int(rng.integers(2**62))


def spectrum(x: np.ndarray) -> np.ndarray:
    """Amplitude (n / 2 + 1, 3) of the waves in x (n, 3)."""
    return 2.0 * np.abs(np.fft.rfft(x, axis=0)) / len(x)


def test_lines_have_their_amplitudes_and_phases_of_their_own(rng: np.random.Generator) -> None:
    effect = VibrationLines(frequency=(30.0, 50.0), amplitude=((1.0, 0.0, 2.0), (0.0, 0.5, 0.0)))
    x = error_at_rest(effect, T, seed_of(rng))
    expected = np.zeros((1001, 3))
    expected[300], expected[500] = (1.0, 0.0, 2.0), (0.0, 0.5, 0.0)
    # Phases of 50 Hz at 10 s err by 1e-12.
    np.testing.assert_allclose(spectrum(x), expected, atol=1e-11)
    assert np.abs(x[:, 2] - 2.0 * x[:, 0]).max() > 1e-3


def test_a_line_above_half_the_rate_folds(rng: np.random.Generator) -> None:
    x = error_at_rest(VibrationLines(frequency=[170.0], amplitude=[[1.0, 1.0, 1.0]]), T, seed_of(rng))
    assert spectrum(x)[:, 0].argmax() == 300  # 200 - 170 Hz, in tenths of a hertz


def test_level_noise_has_density_times_bandwidth(rng: np.random.Generator) -> None:
    effect = VibrationNoise(frequency=(10.0, 60.0), density=(0.04, 0.04), gain=(1.0, 2.0, 0.0))
    assert effect.variance == pytest.approx(2.0)
    x = first_errors(effect, 30, seed_of(rng), T)
    # 128 lines, 30 runs: 2.3 % standard deviation of a variance.
    np.testing.assert_allclose((x**2).mean(axis=(0, 1)), [2.0, 8.0, 0.0], rtol=0.12)


def test_the_spectrum_is_straight_on_logarithmic_paper(rng: np.random.Generator) -> None:
    effect = VibrationNoise(frequency=(10.0, 80.0), density=(0.1, 0.1 / 64.0))  # falls with 1 / f^2
    assert effect.variance == pytest.approx(0.1 * 100.0 * (1 / 10.0 - 1 / 80.0), rel=1e-5)
    power = np.mean([spectrum(x) ** 2 / 2.0 for x in first_errors(effect, 40, seed_of(rng), T)], axis=(0, 2))
    for low, high in ((10.0, 20.0), (20.0, 40.0), (40.0, 80.0)):
        band = power[int(low * 10) : int(high * 10)].sum()
        # 16 lines or more in 120 records: 3.5 %; a line leaks over the edge of a band now and then.
        assert band == pytest.approx(0.1 * 100.0 * (1.0 / low - 1.0 / high), rel=0.2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: VibrationLines([-1.0], [[0.0] * 3]), "frequency must be positive, Hz"),
        (lambda: VibrationLines([1.0, 2.0], [[0.0] * 3]), r"amplitude must be \(2, 3\)"),
        (
            lambda: VibrationLines([1.0], [[0.0, -1.0, 0.0]]),
            "amplitude must not be negative, unit of the sensor",
        ),
        (lambda: VibrationNoise([2.0, 1.0], [1.0, 1.0]), "frequency must increase strictly"),
        (lambda: VibrationNoise([1.0, 2.0], [1.0, -1.0]), r"density must be positive .*unit\^2/Hz"),
        (lambda: VibrationNoise([1.0, 2.0], [1.0, 0.0]), "never reaches zero"),
        (lambda: VibrationNoise([0.0, 2.0], [1.0, 1.0]), "positive numbers, Hz"),
    ],
)
def test_bad_parameters(make, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
