"""A start in full motion: up and north within seconds, by the force whose accelerations have ended."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.mekf import MekfFilter
from kreisel.estimate.run import run
from tests.estimate.filters.test_mekf import FS, worn
from tests.estimate.filters.turning import Array, angles_deg


def swung(rng: np.random.Generator, amplitude: float, seconds: float = 30.0) -> tuple[ImuRecording, Array]:
    """A tumbling sensor on a circle of `amplitude` m at 1 Hz, its plane upright: at first it reads upside down."""
    recording, truth = worn(seconds, rng, rest=0.0)
    angle = 2.0 * np.pi * recording.t
    path = amplitude * np.stack([0.0 * angle, np.sin(angle), np.cos(angle)], axis=1)
    pushed = np.einsum("nji,nj->ni", truth, -((2.0 * np.pi) ** 2) * path)
    return dataclasses.replace(recording, accel=recording.accel + pushed), truth


@pytest.mark.parametrize("mode", ["9", "6"])
def test_up_is_found_in_full_swing(mode: Any, rng: np.random.Generator) -> None:
    recording, truth = swung(rng, 0.8)
    history = run(MekfFilter(mode=mode), recording)
    _, heading, inclination = angles_deg(history.R_NS, truth)
    assert inclination[0] > 150.0
    # The way moved is within 0.8 m: 12 x 0.8 / (9.8 T^2) = 14 deg after two seconds; 13 in 15 draws.
    assert inclination[round(2.0 * FS) : round(4.0 * FS)].max() < 20.0
    if mode == "9":
        # The field dips by 68 deg: a tilt turns the heading by 2.4 times as much.
        assert heading[round(4.0 * FS) :].max() < 50.0
    assert history.sigma is not None
    assert history.sigma[0, 0] > 0.9


def test_half_of_gravity_is_an_ordinary_start(rng: np.random.Generator) -> None:
    recording, _ = swung(rng, 0.0, seconds=1.0)
    for factor, sigma in (0.6, 20.0), (1.4, 20.0), (0.4, 57.0), (1.6, 57.0):
        accel = np.array(recording.accel)
        accel[0] *= factor
        history = run(MekfFilter(), dataclasses.replace(recording, accel=accel))
        assert history.sigma is not None
        assert np.degrees(history.sigma[0, 0]) == pytest.approx(sigma, abs=1.0)
