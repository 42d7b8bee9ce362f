"""Histories of a filter: taken without checks, their acceleration made when it is asked for."""

import dataclasses
import pickle

import numpy as np
import pytest

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.run import run
from kreisel.maths.rotations import rotation_defect


def history(rng: np.random.Generator, n: int = 50) -> tuple[ImuRecording, AttitudeHistory]:
    gyro, accel, mag = rng.normal(size=(3, n, 3))
    recording = ImuRecording(np.arange(n) * 0.01, gyro, accel, mag_uT=mag, t0_ns=7, name="x")
    return recording, run(DcmFilter(), recording)


def test_it_is_what_the_constructor_would_have_checked(rng: np.random.Generator) -> None:
    _, found = history(rng)
    values = {field.name: getattr(found, field.name) for field in dataclasses.fields(found)}
    checked = AttitudeHistory(**values)
    for name, value in values.items():
        assert np.array_equal(getattr(checked, name), value), name
        assert not isinstance(value, np.ndarray) or not value.flags.writeable
    assert rotation_defect(found.R_NS).max() < 1e-12


def test_acceleration_is_made_once_and_of_what_was_measured(rng: np.random.Generator) -> None:
    recording, found = history(rng)
    up = np.array([0.0, 0.0, STANDARD_GRAVITY])
    expected = np.einsum("nij,nj->ni", found.R_NS, recording.accel) - up
    # Three products of numbers below ten, rounded.
    np.testing.assert_allclose(found.a_N, expected, atol=1e-14)
    assert found.a_N is found.a_N and not found.a_N.flags.writeable
    assert AttitudeHistory(found.t, found.R_NS).a_N is None


def test_copies_have_it_too(rng: np.random.Generator) -> None:
    for copy in (lambda x: pickle.loads(pickle.dumps(x)), lambda x: dataclasses.replace(x, name="y")):
        _, found = history(rng)
        assert np.array_equal(copy(found).a_N, found.a_N)


def test_other_names_are_unknown_as_ever(rng: np.random.Generator) -> None:
    with pytest.raises(AttributeError, match="no attribute 'a_B'"):
        _ = history(rng)[1].a_B  # type: ignore[attr-defined]
