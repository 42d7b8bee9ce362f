"""MATLAB's gradient, the rates it gives, and the fused kernel that does all in one pass."""

import numpy as np
import pytest

from kreisel.maths.gradient import BLOCK, gradient, gradient_motion, gradient_rotation
from kreisel.maths.kinematics import specific_force
from kreisel.maths.rotations import exp_so3, matrix_from_euler

Rng = np.random.Generator
G_N = np.array([0.0, 0.0, -9.80665])


def uneven(n: int, rng: Rng) -> np.ndarray:
    return np.cumsum(rng.uniform(0.5e-2, 1.5e-2, n))


def test_matlabs_own_numbers() -> None:
    """gradient([1 4 9 16 25], [0 1 3 4 7]) of MATLAB: 3, 8/3, 4, 4, 3."""
    np.testing.assert_allclose(
        gradient(np.array([1.0, 4.0, 9.0, 16.0, 25.0]), np.array([0.0, 1.0, 3.0, 4.0, 7.0])),
        [3.0, 8.0 / 3.0, 4.0, 4.0, 3.0],
        rtol=1e-15,
    )


@pytest.mark.parametrize("shape", [(), (1,), (3,), (3, 3)])
def test_line_has_one_slope_on_any_steps(shape: tuple[int, ...], rng: Rng) -> None:
    t, slope = uneven(50, rng), rng.normal(size=shape)
    x = t.reshape(-1, *[1] * len(shape)) * slope
    # Differences of numbers near 1 over 1e-2: 100 eps.
    np.testing.assert_allclose(gradient(x, t), np.broadcast_to(slope, x.shape), rtol=0, atol=1e-13)


def test_order_two_inside_and_one_at_the_ends() -> None:
    """Halving the step quarters the error inside and halves it at the ends."""
    errors = []
    for n in (101, 201):
        t = np.linspace(0.0, 1.0, n)
        errors.append(np.abs(gradient(np.exp(t), t) - np.exp(t)))
    inside = errors[0][1:-1].max() / errors[1][1:-1].max()
    ends = errors[0][[0, -1]] / errors[1][[0, -1]]
    # The next order of the error is the step, 0.01, away.
    assert inside == pytest.approx(4.0, rel=0.05)
    np.testing.assert_allclose(ends, 2.0, rtol=0.05)


def test_two_samples_have_one_slope() -> None:
    np.testing.assert_array_equal(gradient(np.array([[1.0], [4.0]]), np.array([0.0, 2.0])), [[1.5], [1.5]])


def test_rate_of_steady_turning(rng: Rng) -> None:
    """R_k^T (R_k+1 - R_k-1) of a turn by w h a step is 2 sin(w h) about the axis, both in N and in B."""
    axis, rate, step = rng.normal(size=3), 3.0, 1e-2
    axis /= np.linalg.norm(axis)
    t = np.arange(60) * step
    start = matrix_from_euler(rng.uniform(-3, 3, 3))
    R = start @ exp_so3(rate * t[:, None] * axis)
    seen = axis * np.sin(rate * step) / step
    for axes, expected in (("B", seen), ("N", start @ seen)):
        omega, alpha = gradient_rotation(t, R, axes)
        # Round-off: eps of R over a step of 1e-2, once for omega and once more for alpha.
        np.testing.assert_allclose(omega[1:-1], np.tile(expected, (58, 1)), atol=1e-13)
        np.testing.assert_allclose(alpha[2:-2], 0.0, atol=1e-11)


def test_rates_in_N_and_B_are_one_vector(rng: Rng) -> None:
    t = np.arange(500) * 1e-3
    phi = np.stack([np.cos(5 * t), np.sin(4 * t), 2 * t], axis=1)
    R = matrix_from_euler(phi)
    omega_B, omega_N = gradient_rotation(t, R)[0], gradient_rotation(t, R, "N")[0]
    # The two take differently what is not skew in the differences of R: (w h)^2 = 1e-4 of 5 rad/s inside, and
    # w h / 2 = 3e-3 of it at the ends.
    seen_N = np.einsum("nij,nj->ni", R, omega_B)
    np.testing.assert_allclose(seen_N[1:-1], omega_N[1:-1], atol=1e-3)
    np.testing.assert_allclose(seen_N, omega_N, atol=1.5e-2)


# Around every edge of the blocks: an end that falls beside, on and just behind one.
LENGTHS = [2, 3, 4, 5, *range(BLOCK - 2, BLOCK + 5), *range(2 * BLOCK - 1, 2 * BLOCK + 4), 3000]


@pytest.mark.parametrize("axes", ["B", "N"])
@pytest.mark.parametrize("n", LENGTHS)
def test_fused_kernel_does_what_its_parts_do(n: int, axes: str, rng: Rng) -> None:
    t, s, phi = uneven(n, rng), rng.normal(size=(n, 3)), rng.uniform(-7, 7, (n, 3))
    v, a, R, omega, alpha, f = gradient_motion(t, s, phi, G_N, axes)
    separate_v = gradient(s, t)
    separate_R = matrix_from_euler(phi)
    separate = (separate_v, gradient(separate_v, t), separate_R, *gradient_rotation(t, separate_R, axes))
    for fused, single in zip((v, a, R, omega, alpha), separate, strict=True):
        # eps of order-one values over a step of 5e-3 once and twice, relative to values that grow likewise.
        np.testing.assert_allclose(fused, single, rtol=0, atol=1e-13 * max(1.0, np.abs(single).max()))
    np.testing.assert_allclose(f, specific_force(a, R, G_N), rtol=0, atol=1e-14 * np.abs(f).max())


def test_inputs_may_be_views_and_stay_untouched(rng: Rng) -> None:
    n = 300
    t, both = uneven(n, rng), rng.normal(size=(n, 6))
    before = both.copy()
    strided = gradient_motion(t, both[:, :3], both[:, 3:], G_N)
    whole = gradient_motion(t, both[:, :3].copy(), both[:, 3:].copy(), G_N)
    np.testing.assert_array_equal(both, before)
    for x, y in zip(strided, whole, strict=True):
        np.testing.assert_array_equal(x, y)


def test_outputs_do_not_overlap(rng: Rng) -> None:
    n = 130
    outputs = gradient_motion(uneven(n, rng), rng.normal(size=(n, 3)), rng.normal(size=(n, 3)), G_N)
    kept = [x.copy() for x in outputs]
    for k, x in enumerate(outputs):
        x[...] = np.nan
        for other, before in list(zip(outputs, kept, strict=True))[k + 1 :]:
            np.testing.assert_array_equal(other, before)
