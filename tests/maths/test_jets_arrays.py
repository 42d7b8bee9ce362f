"""What NumPy does with arrays of jets, and what a function of time may return."""

from typing import Any

import numpy as np
import pytest

from kreisel.maths.jets import Jet, differentiate

T = np.linspace(-1.0, 2.0, 7)
R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
PATH = np.stack([np.stack([T, T**2, T**3], -1), np.stack([0 * T + 1, 2 * T, 3 * T**2], -1)])


@pytest.mark.parametrize(
    "function",
    [
        lambda t: (t, t**2, t**3),
        lambda t: [t, t**2, t**3],
        lambda t: np.array([t, t**2, t**3]),
        lambda t: np.array([t, t**2, t**3]).T,
        lambda t: np.asarray((t, t**2, t**3)),
        lambda t: np.c_[t, t**2, t**3],
        lambda t: np.stack([t, t**2, t**3]),
        lambda t: np.stack([t, t**2, t**3], axis=-1),
        lambda t: np.column_stack([t, t**2, t**3]),
        lambda t: np.vstack([t, t**2, t**3]).T,
        lambda t: np.dstack([t, t**2, t**3])[0],
        lambda t: np.hstack([t[:, None], (t**2)[:, np.newaxis], np.expand_dims(t**3, -1)]),
        lambda t: np.concatenate(
            [t.reshape(-1, 1), np.reshape(t**2, (-1, 1)), np.atleast_2d(t**3).T], axis=1
        ),
        lambda t: t[:, None] ** np.array([1.0, 2.0, 3.0]),
        lambda t: np.power(np.moveaxis(np.broadcast_to(t, (3, len(t))), 0, 1), [1, 2, 3]),
        lambda t: np.take(np.stack([t**3, t, t**2], -1), [1, 2, 0], axis=1),
    ],
)
def test_ways_to_return_three_quantities(function: Any) -> None:
    np.testing.assert_allclose(differentiate(function, T, 1), PATH, rtol=4e-16, atol=0.0)


@pytest.mark.parametrize(
    "function",
    [
        lambda p: R @ p.T,
        lambda p: p @ R.T,
        lambda p: np.dot(p, R.T),
        lambda p: np.inner(p, R),
        lambda p: np.matmul(R, p[..., None])[..., 0],
        lambda p: np.einsum("ij,nj->ni", R, p),
        lambda p: np.einsum("in->ni", R @ p.T),
        lambda p: np.stack([-p[:, 1], p[:, 0], p[:, 2]]),
        lambda p: np.array([sum(a * x for a, x in zip(row, p.T, strict=True)) for row in R]),
        lambda p: np.cross([0.0, 0.0, 1.0], p) + p * [0.0, 0.0, 1.0],
        lambda p: np.sum(R * p[:, None, :], axis=-1),
        lambda p: np.mean(3 * R * p[:, None, :], axis=2),
        lambda p: (R * p[:, None, :]).sum(axis=-1),
    ],
)
def test_ways_to_turn_a_vector(function: Any) -> None:
    found = differentiate(lambda t: function(np.stack([t, t**2, t**3], axis=-1)), T, 1)
    np.testing.assert_allclose(found, PATH @ R.T, rtol=1e-15, atol=1e-15)


def test_length_of_a_vector() -> None:
    def length(t: Any) -> Any:
        return np.linalg.norm(np.stack([3 * t, 4 * t, 0 * t], axis=-1), axis=-1)

    np.testing.assert_allclose(
        differentiate(length, T[T > 0], 2), [5 * T[T > 0], 5 + 0 * T[T > 0], 0 * T[T > 0]]
    )


def test_unpacking_components() -> None:
    def function(t: Any) -> Any:
        x, y = np.stack([t, t**2])
        return x, y, 0.0

    np.testing.assert_array_equal(differentiate(function, T, 1)[1, :, 1], 2 * T)


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (lambda t: 2.5, 2.5),
        (lambda t: np.float32(2.5), 2.5),
        (lambda t: np.full(len(t), 2.5), 2.5),
        (lambda t: np.full_like(t, 2.5), 2.5),
        (lambda t: 2.5 * np.ones_like(t), 2.5),
        (lambda t: np.zeros(t.shape) + 2.5, 2.5),
        (lambda t: np.zeros_like(t, dtype=int) + 2.5, 2.5),
        (lambda t: (1, 2.0, np.float64(3)), [1, 2, 3]),
        (lambda t: np.array([1, 2, 3]), [1, 2, 3]),
        (lambda t: [t * 0 + 1, 2, 3.0], [1, 2, 3]),
        (lambda t: np.tile([1.0, 2.0, 3.0], (t.size, 1)), [1, 2, 3]),
        (lambda t: np.tile([[1.0], [2.0], [3.0]], t.size), [1, 2, 3]),
        (lambda t: (np.zeros(np.shape(t)), np.ones(np.size(t)), t.ndim), [0, 1, 1]),
    ],
)
def test_constants(function: Any, expected: Any) -> None:
    for times in (T, T[:1], T[:3]):
        found = differentiate(function, times, 2)
        np.testing.assert_array_equal(found[0], np.broadcast_to(expected, found[0].shape))
        np.testing.assert_array_equal(found[1:], 0.0)


def test_attributes_of_an_array() -> None:
    t = Jet.variable(T, 2)
    assert (t.shape, t.ndim, t.size, len(t), t.dtype) == ((7,), 1, 7, 7, np.float64)
    assert np.isrealobj(t)
    assert np.iscomplexobj(1j * t)
    assert "order=2" in repr(t)
    np.testing.assert_array_equal(np.copy(t).clip(0, 1).derivative(1), [0, 0, 1, 1, 0, 0, 0])
    np.testing.assert_array_equal(t.copy().conj().real.value, T)
