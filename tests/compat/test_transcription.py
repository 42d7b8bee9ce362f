"""The five functions agree with an independent transcription of the document's equations."""

import numpy as np
import pytest

from kreisel.compat import my_ang, my_imu, my_lin, my_rotate, my_tang
from tests.compat import transcription as document

Rng = np.random.Generator


@pytest.fixture(params=["even", "uneven"])
def t(request: pytest.FixtureRequest, rng: Rng) -> np.ndarray:
    steps = np.full(200, 0.005) if request.param == "even" else rng.uniform(0.002, 0.008, 200)
    return np.cumsum(steps)


def loop(t: np.ndarray) -> np.ndarray:
    angle = 2.0 * np.pi * t
    return np.stack([0.8 * np.cos(angle), 0.8 * np.sin(angle), 0.3 * np.cos(3.0 * angle)], axis=1)


def agree(ours: np.ndarray, theirs: np.ndarray) -> None:
    """1e-12 of the largest value: differencing twice at 5 ms turns an eps of s into 1e-13 of a."""
    assert ours.shape == theirs.shape
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-12 * np.abs(theirs).max())


def test_my_lin(t: np.ndarray) -> None:
    for ours, theirs in zip(
        my_lin(loop(t), "num", t), document.my_lin(loop(t).tolist(), t.tolist()), strict=True
    ):
        agree(ours, theirs)


def test_my_tang(t: np.ndarray, rng: Rng) -> None:
    v = rng.normal(size=(len(t), 3))
    for ours, theirs in zip(my_tang(v, t), document.my_tang(v.tolist()), strict=True):
        agree(ours, theirs)


@pytest.mark.parametrize("convention", ["document", "physical"])
def test_my_ang(t: np.ndarray, convention: str) -> None:
    phi = 3.0 * loop(t)  # turns over and past the vertical
    theirs = document.my_ang(phi.tolist(), t.tolist(), body=convention == "physical")
    for ours, wanted in zip(my_ang(phi, "num", t, convention=convention), theirs, strict=True):
        agree(ours, wanted)


@pytest.mark.parametrize("convention", ["document", "physical"])
def test_my_rotate(t: np.ndarray, rng: Rng, convention: str) -> None:
    phi, a = rng.uniform(-4.0, 4.0, (len(t), 3)), rng.normal(size=(len(t), 3))
    theirs = document.my_rotate(phi.tolist(), a.tolist(), back=convention == "physical")
    agree(my_rotate(phi, a, t, convention=convention), theirs)


def test_my_imu(t: np.ndarray, rng: Rng) -> None:
    a, w, dw = rng.normal(size=(3, len(t), 3))
    r = [-0.075, -0.075, 0.025]
    agree(my_imu(a, w, dw, r, t), document.my_imu(a.tolist(), w.tolist(), dw.tolist(), r))
