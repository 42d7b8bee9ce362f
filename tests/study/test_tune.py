"""What a proposal is worth is what it gains on recordings that had no part in it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from kreisel import DcmFilter, Environment, Imu, figure_eight
from kreisel.data.trial import Trial
from kreisel.simulate.effects.white_noise import WhiteNoise
from kreisel.study.scenario import Scenario
from kreisel.study.trials import paired, simulated
from kreisel.study.tune import _chance, tunable, tune

SEVERAL = 6


def trials(rng: np.random.Generator, count: int = SEVERAL) -> list[Trial]:
    """A figure of eight walked, 20 s each, with noise only."""
    imu = Imu(
        gyro_effects=(WhiteNoise(density=1e-3),),
        accel_effects=(WhiteNoise(density=3e-3),),
        mag_effects=(WhiteNoise(density=0.05),),
        environment=Environment(field_N_uT=[0.0, 20.0, -44.0]),
    )
    made = []
    for k in range(count):
        motion = figure_eight(period=6.0 + 0.5 * k).sample(np.arange(0.0, 20.0, 0.02))
        made.append(paired(imu.record(motion, rng).measured, motion, f"wave {k}"))
    return made


def test_a_filter_that_is_far_off_is_brought_back_and_the_gain_holds_on_recordings_left_out(rng) -> None:
    # A gyro taken for a thousand times better than it is: the filter hardly corrects anything.
    spoiled = replace(DcmFilter(), accel_time=160.0)
    found = tune(spoiled, trials(rng), vary=["accel_time"])
    assert found.filter.accel_time < 0.5 * spoiled.accel_time
    assert found.changed["accel_time"] == (160.0, found.filter.accel_time)
    assert found.significant and found.gain > 0.1
    # All six gain: of 2^6 ways to toss signs, one is as good.
    assert found.p_value == pytest.approx(2.0**-SEVERAL)
    low, high = found.spread["accel_time"]
    assert low <= found.filter.accel_time <= high
    assert "carries over" in found.verdict


def test_what_chance_explains_is_not_called_a_gain(rng) -> None:
    # `hold` bridges gaps, and there are none: nothing can change.
    found = tune(DcmFilter(), trials(rng, 3), vary=["hold"])
    assert found.changed == {} and not found.significant
    assert found.filter == DcmFilter()
    assert found.gain == 0.0 and found.p_value == 1.0
    assert "keep it" in found.verdict


def test_the_same_recordings_give_the_same_proposal(rng) -> None:
    some = trials(rng, 3)
    assert tune(DcmFilter(), some, vary=["mag_time"]) == tune(DcmFilter(), some, vary=["mag_time"])


def test_chance_is_that_of_tossed_signs(rng) -> None:
    assert _chance(np.array([1.0, 2.0, 3.0])) == 1.0 / 8.0
    assert _chance(np.array([1.0, -1.0])) == 3.0 / 4.0
    assert _chance(np.zeros(4)) == 1.0
    # Gains of which half are losses: by symmetry about a half, 20 000 draws give it to 1 %.
    many = rng.normal(size=20)
    assert _chance(np.concatenate([many, -many])) == pytest.approx(0.5, abs=0.02)


def test_what_cannot_be_tuned_is_refused(rng) -> None:
    some = trials(rng, 3)
    with pytest.raises(ValueError, match=r"at least 3 recordings.*got 2"):
        tune(DcmFilter(), some[:2])
    with pytest.raises(ValueError, match=r"vary must be one of.*got 'accel_tim'. Did you mean 'accel_time'"):
        tune(DcmFilter(), some, vary=["accel_tim"])
    with pytest.raises(ValueError, match="score"):
        tune(DcmFilter(), some, score="position")  # type: ignore[arg-type]
    assert "declination" not in tunable(DcmFilter()) and "mode" not in tunable(DcmFilter())


SCENARIO = """
name = "wave"
duration = 8.0
rate_hz = 50.0
[trajectory]
kind = "lissajous"
[environment]
field_N_uT = [0.0, 20.0, -44.0]
[[imu]]
sensor = "bmi088"
"""


def test_a_scenario_gives_as_many_trials_as_draws(tmp_path) -> None:
    path = tmp_path / "wave.toml"
    path.write_text(SCENARIO)
    first, second = simulated(Scenario.load(path), 2)
    assert first.name != second.name
    assert not np.array_equal(first.recording.gyro, second.recording.gyro)
    np.testing.assert_array_equal(first.reference.R_NS, second.reference.R_NS)
    assert first.reference.counts.all()


def test_the_command_line_tunes_on_scenarios_and_writes_a_filter(tmp_path, capsys) -> None:
    from kreisel.cli.main import main

    path, out = tmp_path / "wave.toml", tmp_path / "filter.toml"
    path.write_text(SCENARIO)
    call = ["tune", str(path), "--draws", "3", "--vary", "mag_time,accel_time", "--mode", "9"]
    assert main([*call, "--json", "-o", str(out)]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["schema"] == "kreisel.tune/1" and len(report["left_out"]) == 3
    assert out.read_text().startswith("filter = [") and '"9"' in out.read_text()
    assert main(call) == 0
    told = capsys.readouterr().out
    assert "chosen without this recording" in told and report["verdict"] in told


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["imu.csv"], 1, "no truth in it. Name it: imu.csv=TRUTH"),
        (["wave.toml", "--draws", "0"], 2, "--draws must be a whole number, 1 or more; got '0'"),
        (["wave.toml", "--draws", "1"], 1, "at least 3 recordings"),
        (["imu.csv=imu.csv"], 1, "a truth is a file of attitudes"),
    ],
)
def test_mistakes_are_one_sentence(arguments, code, sentence, tmp_path, monkeypatch, capsys) -> None:
    from kreisel.cli.main import main

    monkeypatch.chdir(tmp_path)
    (tmp_path / "wave.toml").write_text(SCENARIO)
    t = np.arange(0.0, 2.0, 0.02)
    rows = np.column_stack([t, np.zeros((len(t), 5)), np.full(len(t), 9.81)])
    np.savetxt(
        "imu.csv", rows, delimiter=",", header="t,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", comments=""
    )
    assert main(["tune", *arguments]) == code
    told = capsys.readouterr().err
    assert sentence in told and told.count("\n") == 1
