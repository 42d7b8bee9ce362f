"""Motions and recordings whose pictures are known."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from kreisel.data.motion import Motion, Mount, Note
from kreisel.data.recording import ImuRecording
from kreisel.maths.rotations import matrix_from_euler


def _circle(n: int = 501, radius: float = 2.0, rate: float = 2.0, notes: tuple[Note, ...] = ()) -> Motion:
    """Counter-clockwise round a level circle, nose along the tangent."""
    t = np.linspace(0.0, 5.0, n)
    angle = rate * t
    zero, one = np.zeros(n), np.ones(n)
    inward = -np.stack([np.cos(angle), np.sin(angle), zero], axis=1)
    forward = np.stack([-np.sin(angle), np.cos(angle), zero], axis=1)
    return Motion(
        t=t,
        p_NB=-radius * inward,
        v_NB=radius * rate * forward,
        a_NB=radius * rate**2 * inward,
        R_NB=matrix_from_euler(np.stack([zero, zero, angle + 0.5 * np.pi], axis=1)),
        omega_NB_B=np.stack([zero, zero, rate * one], axis=1),
        alpha_NB_B=np.zeros((n, 3)),
        name="Circle",
        notes=notes,
    )


def _rest(n: int = 101, jitter: float = 0.0) -> Motion:
    """Standing still at (3, 4, 5) m, but for round-off of size `jitter`."""
    noise = jitter * (-1.0) ** np.arange(n)[:, None] * np.ones(3)
    return Motion(
        t=0.01 * np.arange(n),
        p_NB=np.array([3.0, 4.0, 5.0]) + noise,
        v_NB=noise,
        a_NB=noise,
        R_NB=np.tile(np.eye(3), (n, 1, 1)),
        omega_NB_B=noise,
        alpha_NB_B=noise,
    )


def _recording(n: int = 400, mag: bool = False) -> ImuRecording:
    """A sine, a cosine and a constant on each sensor at 100 Hz; the magnetometer has every tenth sample."""
    t = 0.01 * np.arange(n)
    values = np.stack([np.sin(t), np.cos(t), np.full(n, 9.8)], axis=1)
    field = np.full((n, 3), np.nan)
    field[::10] = 40.0 * values[::10]
    return ImuRecording(t=t, gyro=values, accel=values, mag_uT=field if mag else None, name="Sine")


@pytest.fixture
def circle():
    return _circle


@pytest.fixture
def rest():
    return _rest


@pytest.fixture
def recording():
    return _recording


@pytest.fixture
def corner_mount() -> Mount:
    return Mount(p_BS=np.array([-0.075, -0.075, 0.025]))


@pytest.fixture(autouse=True)
def no_pyplot():
    """pyplot keeps figures alive and wants a display; nothing here may load it."""
    yield
    assert "matplotlib.pyplot" not in sys.modules
