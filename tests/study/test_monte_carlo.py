"""Many runs are the runs that `study.run` makes, on any number of threads and in blocks of any size."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.study.ensemble.work import INSTANTS
from kreisel.study.monte_carlo import gather, monte_carlo, prepare
from kreisel.study.run import run
from kreisel.study.scenario import Scenario

TEXT = """
seed = 3
duration = 2.0
rate_hz = 100.0
trajectory = { kind = "lissajous", frequency = 0.3 }
environment = { field_N_uT = [1.0, 20.0, -44.0] }

[[imu]]
name = "wrist"
sensor = "bmi088"

[[imu]]
name = "perfect"

[[filter]]
kind = "dcm"
published = { weight_accel = 0.02 }

[[filter]]
kind = "mekf"

[[filter]]
kind = "dcm"
name = "free"
mode = "6"
align = "heading"
"""

VARY = {
    "trajectory.frequency": {"uniform": [0.2, 0.4]},
    "imu.wrist.p_BS[0]": {"normal": [0.0, 0.05]},
    "imu.wrist.sensor": {"choice": ["bmi088", "mpu6050"]},
    "filter.dcm.start_error_deg[2]": {"normal": [0.0, 10.0]},
    "filter.free.accel_time": {"loguniform": [1.0, 20.0]},
}
PLAIN = Scenario.from_toml(TEXT)
RUNS = 37


def bits(ensemble):
    """Everything an ensemble holds of its runs, as bytes."""
    return [
        {name: x.tobytes() for name, x in {**each.figures, **each.quantiles}.items()}
        for each in ensemble.estimates
    ]


@pytest.fixture(scope="module", params=[{}, VARY], ids=["seeds", "values"])
def ensemble(request):
    return monte_carlo(PLAIN, RUNS, request.param)


@pytest.mark.parametrize("k", [0, 15, 16, RUNS - 1])
def test_a_run_is_replayed_to_the_bit(ensemble, k):
    result = run(ensemble.scenario(k))
    assert len(result.estimates) == len(ensemble.estimates) == 6
    for once, many in zip(result.estimates, ensemble.estimates, strict=True):
        assert (once.imu, once.filter) == (many.imu, many.filter)
        for name, values in many.figures.items():
            if name != "nees":
                alone = getattr(once.summary, name)
                assert values[k] == (np.inf if alone is None else alone), name


def test_a_scenario_of_a_run_is_one_of_its_own(ensemble):
    one = ensemble.scenario(5)
    assert one.run == 5 and one.vary == {}
    assert Scenario.from_toml(one.to_toml()) == one


def test_threads_and_blocks_change_no_bit(ensemble):
    work = prepare(ensemble.base, RUNS)
    for size in (1, 10, 16, 64):
        part = replace(work, size=size)
        assert bits(gather(part, [part(number) for number in part.blocks])) == bits(ensemble)
    for threads in (1, 2):
        assert bits(monte_carlo(ensemble.base, RUNS, threads=threads)) == bits(ensemble)


def test_blocks_in_any_order_and_after_a_journey_are_the_same():
    work = replace(prepare(PLAIN, RUNS, VARY), size=10)
    elsewhere = pickle.loads(pickle.dumps(work))
    blocks = {number: elsewhere(number) for number in reversed(work.blocks)}
    for number in work.blocks:
        assert {k: x.tobytes() for k, x in work(number).items()} == {
            k: x.tobytes() for k, x in blocks[number].items()
        }


def test_the_first_runs_of_more_are_the_same_runs():
    few, many = monte_carlo(PLAIN, 3, VARY), monte_carlo(PLAIN, 20, VARY)
    for path, values in few.inputs.items():
        assert list(values) == list(many.inputs[path][:3])
    assert few.estimates[0].figures["total_rmse_deg"].tolist() == (
        many.estimates[0].figures["total_rmse_deg"][:3].tolist()
    )


def test_one_more_input_leaves_the_values_of_the_others_alone():
    few = monte_carlo(PLAIN, 5, {"imu.wrist.p_BS[0]": {"normal": [0.0, 0.05]}})
    many = monte_carlo(PLAIN, 5, VARY)
    assert few.inputs["imu.wrist.p_BS[0]"].tolist() == many.inputs["imu.wrist.p_BS[0]"].tolist()


def test_quantiles_over_time_are_those_of_a_plain_loop():
    ensemble = monte_carlo(PLAIN, 9)
    results = [run(ensemble.scenario(k)) for k in range(9)]
    rows = np.round(np.linspace(0, 200, INSTANTS)).astype(int)
    np.testing.assert_allclose(ensemble.t, results[0].motion.t[rows])
    for k, many in enumerate(ensemble.estimates):
        for kind, quantiles in many.quantiles.items():
            errors = [np.degrees(getattr(r.estimates[k].errors, kind)[rows]) for r in results]
            # Traces are kept in single precision, 6e-8 of an error.
            expected = np.quantile(errors, [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0], axis=0)
            np.testing.assert_allclose(quantiles, expected, rtol=1e-6, atol=1e-6)


def test_a_trajectory_of_functions_has_many_runs_too():
    moving = FunctionTrajectory((np.cos, np.sin, 0.0), span=(0.0, 3.0))
    ensemble = monte_carlo(replace(PLAIN, trajectory=moving), 4, {"imu.wrist.p_BS[1]": "normal(0, 0.1)"})
    once = run(ensemble.scenario(3)).estimates[0].summary
    assert ensemble.estimates[0].figures["total_rmse_deg"][3] == once.total_rmse_deg


def test_a_trajectory_of_functions_keeps_no_checkpoints(tmp_path):
    moving = FunctionTrajectory((np.cos, np.sin, 0.0), span=(0.0, 3.0))
    with pytest.raises(ValueError, match="FunctionTrajectory cannot be written"):
        monte_carlo(replace(PLAIN, trajectory=moving), 4, folder=tmp_path)


def test_progress_counts_runs():
    seen = []
    monte_carlo(PLAIN, 40, on_done=seen.append)
    assert seen == sorted(seen) and seen[-1] == 40


@pytest.mark.parametrize("samples", [1, 2, 257])
def test_runs_of_any_length_are_replayed(samples):
    # One sample, which no sensor with noise can take; a block of those that go abreast, and one more.
    text = TEXT.replace("duration = 2.0", f"duration = {(samples - 0.5) / 100.0}")
    scenario = Scenario.from_toml(text if samples > 1 else text.replace('sensor = "bmi088"\n', ""))
    many = monte_carlo(scenario, 16)
    for alone, together in zip(run(replace(scenario, run=7)).estimates, many.estimates, strict=True):
        assert together.figures["total_rmse_deg"][7] == alone.summary.total_rmse_deg


@pytest.mark.parametrize("runs", [0, -1, 2.5, True])
def test_no_runs_are_refused(runs):
    with pytest.raises(ValueError, match="runs must be a whole number, 1 or more"):
        monte_carlo(PLAIN, runs)


def test_without_filters_there_is_nothing_to_gather():
    with pytest.raises(ValueError, match="without filters"):
        monte_carlo(replace(PLAIN, filters=()), 2)


def test_a_value_that_cannot_be_is_named_with_its_run():
    with pytest.raises(
        ValueError,
        match=r"run \d+: filter\.free\.accel_time = -\d.* of normal\(1, 1\): .*must not be negative",
    ):
        monte_carlo(
            PLAIN, 60, {"filter.free.accel_time": "normal(1, 1)", "imu.wrist.p_BS[0]": "normal(0, 1)"}
        )
