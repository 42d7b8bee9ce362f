"""Noise that was put in is read back with honest intervals, what the record does not show is said, gaps are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kreisel import Imu, ImuRecording, allan, rest
from kreisel.evaluate.allan import TERMS, allan_deviation
from kreisel.simulate.effects.bias_instability import BiasInstability
from kreisel.simulate.effects.bias_random_walk import BiasRandomWalk
from kreisel.simulate.effects.white_noise import WhiteNoise

RATE = 50.0
T = np.arange(30_000) / RATE


def noisy(N=0.0, B=0.0, K=0.0, seed=1) -> ImuRecording:
    band = {"lowest": 1e-5, "highest": 0.5 * RATE}
    effects = [WhiteNoise(N), BiasInstability(B, **band), BiasRandomWalk(K)]
    return Imu(gyro_effects=effects, accel_effects=effects).record(rest().sample(T), seed).measured


STILL = noisy(N=1e-3)


@pytest.mark.parametrize("unit", [1, 1000])
def test_agrees_with_allantools(unit) -> None:
    allantools = pytest.importorskip("allantools", reason="the extra oracle brings allantools")
    # Whole numbers, whose running sums are exact in both.
    y = np.random.default_rng(21).integers(-unit, unit + 1, 20_000).astype(float)
    sizes = np.unique(np.geomspace(1, 6000, 30).astype(int))
    tau, ours = allan_deviation(y, RATE, sizes)
    theirs = allantools.oadev(y, rate=RATE, data_type="freq", taus=tau)
    np.testing.assert_allclose(theirs[0], tau, rtol=1e-12)
    np.testing.assert_allclose(ours, theirs[1], rtol=1e-12)


@pytest.mark.parametrize(
    "true",
    [{"N": 1e-3}, {"N": 1e-3, "B": 5e-4}, {"N": 1e-3, "K": 3e-4}, {"N": 1e-3, "B": 5e-4, "K": 2e-4}],
    ids=str,
)
def test_intervals_cover_what_was_put_in(true) -> None:
    covered = []
    for seed in range(31, 37):
        fit = allan(noisy(**true, seed=seed), "gyro")
        terms = {name: getattr(fit, name) for name in TERMS}
        covered += [
            (term.low <= true.get(name, 0.0)) & (true.get(name, 0.0) <= term.high)
            for name, term in terms.items()
        ]
        assert fit.N.visible.all()
    # 54 intervals of 95 %, nearly independent: 46 or fewer covering has 1 % of all chances.
    assert np.sum(covered) >= 46, covered


def test_a_term_the_record_does_not_show_has_a_limit_and_no_value() -> None:
    fit = allan(STILL)
    assert np.isnan(fit.K.value).all() and (fit.K.low == 0.0).all()
    # A walk of twenty times the strength that reaches the white noise at the longest clusters, 200 s, would show.
    assert (fit.K.high < 20.0 * np.sqrt(3.0) * 1e-3 / 200.0).all()
    assert fit.N.visible.all() and np.allclose(fit.N.value, 1e-3, rtol=0.02)


def test_the_model_is_the_curve_of_the_visible_terms() -> None:
    fit = allan(STILL)
    np.testing.assert_allclose(fit.model(np.array([4.0])), 0.5 * fit.N.value[None], rtol=1e-12)
    assert (fit.low < fit.deviation).all() and (fit.deviation < fit.high).all()
    # Short clusters are many and sure, the longest are few.
    width = fit.high / fit.low
    assert (width[0] < 1.03).all() and (width[-1] > 2.0).all()


def test_units_of_time_do_not_matter() -> None:
    slow = allan(replace(STILL, t=STILL.t * 100.0))
    fast = allan(STILL)
    np.testing.assert_allclose(slow.N.value, 10.0 * fast.N.value, rtol=1e-9)
    np.testing.assert_allclose(slow.tau, 100.0 * fast.tau, rtol=1e-12)


def test_jitter_of_stamps_is_no_gap() -> None:
    jitter = np.random.default_rng(22).uniform(-2e-4, 2e-4, len(T))
    np.testing.assert_allclose(allan(replace(STILL, t=T + jitter)).N.value, allan(STILL).N.value, rtol=1e-5)


def test_gaps_and_missing_samples_are_refused_where_they_are() -> None:
    keep = np.delete(np.arange(len(T)), slice(500, 503))
    cut = ImuRecording(T[keep], STILL.gyro[keep], STILL.accel[keep])
    with pytest.raises(ValueError, match=r"from row 499 at t = 9\.98 s to row 500 pass 0\.08 s .* 0\.02 s"):
        allan(cut)
    gyro = STILL.gyro.copy()
    gyro[77] = np.nan
    with pytest.raises(
        ValueError, match=r"gyro row 77 at t = 1\.54 s is \[nan nan nan\] \(1 such rows\)"
    ) as told:
        allan(replace(STILL, gyro=gyro))
    # Rows 78 and later, at 50 Hz.
    assert f"runs from 1.56 to {T[-1] - T[0]:.10g} s after the first sample" in str(told.value)
    assert allan(replace(STILL, gyro=gyro).rows(slice(78, None))).samples == len(T) - 78


def test_an_axis_that_never_changes_and_a_record_too_short_are_refused() -> None:
    gyro = STILL.gyro * [1.0, 0.0, 1.0]
    with pytest.raises(ValueError, match="gyro y has no noise"):
        allan(replace(STILL, gyro=gyro))
    with pytest.raises(ValueError, match="32 samples or more"):
        allan(ImuRecording(T[:20], STILL.gyro[:20], STILL.accel[:20]))
    with pytest.raises(ValueError, match="sensor must be one of 'gyro', 'accel'"):
        allan(STILL, "gyr")
    with pytest.raises(ValueError, match="from 1 to half of the 100"):
        allan_deviation(np.arange(100.0), 1.0, [60])
