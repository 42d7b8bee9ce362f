"""Smoothing takes out the noise that is there and leaves the motion."""

import numpy as np
import pytest

from kreisel.maths.smoothing import smoothing_spline

T = np.arange(0.0, 5.0, 0.005)


def path(t, derivative=0):
    w = 2.0 * np.pi * np.array([1.0, 1.0, 3.0])
    size = np.array([0.8, 0.8, 0.3]) * w**derivative
    turn = np.array([0.0, -np.pi / 2, 0.0]) + derivative * np.pi / 2
    return size * np.cos(t[:, None] * w + turn)


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


@pytest.mark.parametrize("sigma", [1e-5, 1e-4, 1e-3])
def test_noise_level_is_found_and_acceleration_is_far_better_than_differences(rng, sigma):
    noisy = path(T) + sigma * rng.normal(size=(len(T), 3))
    smooth = smoothing_spline(T, noisy)
    # A thousand samples: 2.2 % standard error; 15 % allows for the freedom the fit takes.
    np.testing.assert_allclose(smooth.sigma, sigma, rtol=0.15)
    error = smooth(T, 2)[2] - path(T, 2)
    differences = np.gradient(np.gradient(noisy, T, axis=0), T, axis=0) - path(T, 2)
    # Differences leave 0.6 sigma / dt^2, a signal band of a sixth of the rate a tenth of it.
    assert rms(error[50:-50]) < 0.2 * rms(differences[50:-50])


def test_it_is_linear_in_scale_and_shift(rng):
    noisy = path(T) + 1e-4 * rng.normal(size=(len(T), 3))
    a, b = smoothing_spline(T, noisy), smoothing_spline(T, 1000.0 * noisy + 5.0)
    # The same optimum to the tolerance of its search: 0.02 in log10 of the penalty.
    np.testing.assert_allclose(b(T, 0)[0] - 5.0, 1000.0 * a(T, 0)[0], atol=2e-2)


def test_rates_help(rng):
    noisy = path(T) + 1e-4 * rng.normal(size=(len(T), 3))
    rate = path(T, 1) + 1e-4 * rng.normal(size=(len(T), 3))
    alone, helped = smoothing_spline(T, noisy), smoothing_spline(T, noisy, rate=rate)
    # At 1 Hz a rate as quiet as this one knows the motion far better than the positions do.
    assert rms(helped(T, 2)[2] - path(T, 2)) < 0.5 * rms(alone(T, 2)[2] - path(T, 2))


def test_shared_smoothness_serves_columns_that_do_not_move(rng):
    q = np.stack([np.cos(T), np.sin(T), 0 * T, 0 * T], axis=1) + 1e-4 * rng.normal(size=(len(T), 4))
    smooth = smoothing_spline(T, q, dimensions=4)
    np.testing.assert_allclose(smooth.sigma, 1e-4, rtol=0.15)
    # The mean of what is left over 1000 samples with about 20 free parameters: sigma sqrt(20 / 1000).
    assert rms(smooth(T, 0)[0, :, 2:]) < 3e-5


def test_smoothing_of_quaternions_is_the_same_in_all_frames(rng):
    """Penalty and residuals are lengths in four dimensions, which a turn of N or of B leaves alone."""
    half = 0.4 * np.sin(2.0 * np.pi * T)
    q = np.stack([np.cos(half), np.sin(half), 0.2 * half, 0 * T], axis=1) + 1e-4 * rng.normal(
        size=(len(T), 4)
    )
    turn = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    plain, turned = smoothing_spline(T, q, dimensions=3), smoothing_spline(T, q @ turn, dimensions=3)
    # The search for the smoothness sees the same likelihood but for round-off.
    np.testing.assert_allclose(turned(T, 2), plain(T, 2) @ turn, atol=1e-5)


def test_a_motionless_body_stays_where_it_is(rng):
    smooth = smoothing_spline(T, np.full((len(T), 3), [1.0, 2.0, 3.0]))
    np.testing.assert_allclose(smooth(T, 0)[0], np.full((len(T), 3), [1.0, 2.0, 3.0]), atol=1e-12)
    noisy = 1e-4 * rng.normal(size=(len(T), 3))
    # No motion at all: five parameters are left, whose second derivative over 5 s is of micro-metres.
    assert rms(smoothing_spline(T, noisy)(T, 2)[2]) < 1e-3


def test_uneven_times_and_a_gap_do_no_harm(rng):
    t = np.sort(rng.uniform(0.0, 5.0, 1000))
    t = t[(t < 2.0) | (t > 2.1)]
    smooth = smoothing_spline(t, path(t) + 1e-4 * rng.normal(size=(len(t), 3)))
    at = np.linspace(0.2, 4.8, 500)
    error, known = smooth(at, 0)[0] - path(at), np.sqrt(smooth.variances(at, range(1))[0])
    # 1500 places that are not independent; in the gap of 0.1 s, a third of the fastest period, ten times sigma.
    assert (np.abs(error) < 5.0 * known).all()
    assert known.max() < 2e-3


def test_long_recordings_take_their_smoothness_from_stretches(rng):
    t = np.arange(0.0, 150.0, 0.005)
    smooth = smoothing_spline(t, path(t) + 1e-4 * rng.normal(size=(len(t), 3)))
    assert rms(smooth(t, 2)[2][100:-100] - path(t, 2)[100:-100]) < 0.5


def test_standard_errors_are_honest_at_the_ends_and_in_a_gap(rng):
    t = np.delete(np.arange(0.0, 10.0, 0.01), np.arange(480, 540))
    at = np.arange(0.0, 9.995, 0.01)
    inside = []
    for _ in range(25):
        smooth = smoothing_spline(t, np.sin(t)[:, None] + 1e-3 * rng.normal(size=(len(t), 1)))
        known = np.sqrt(smooth.variances(at, range(1, 3))[:, :, 0])
        exact = np.stack([np.cos(at), -np.sin(at)])
        inside.append(np.abs(smooth(at, 2)[1:, :, 0] - exact) < 1.96 * known)
    # Neighbours share their errors: about forty independent places, and 25 draws, know 0.95 to 0.007.
    assert 0.90 < np.mean(inside) < 0.995
    # Ends and gap are a few places: 25 draws know 0.95 of each to 0.04.
    assert np.mean(inside, axis=0)[:, [0, 510, -1]].mean() > 0.8
    assert known[0, 0] > 3.0 * known[0, 200] and known[1, 510] > 1.2 * known[1, 200]
