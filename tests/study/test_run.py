"""A run is the four lines of the design: motion, recording, estimate, errors; the same every time."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from datetime import date
from inspect import signature
from pathlib import Path

import numpy as np
import pytest

from kreisel import discovery
from kreisel.data.environment import Environment
from kreisel.data.motion import Mount
from kreisel.data.segment import Segment
from kreisel.data.trajectory import Poses
from kreisel.data.waypoint import Waypoint
from kreisel.files.doors import write
from kreisel.maths.rotations import matrix_from_euler
from kreisel.simulate.clock import Clock, Sampling
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.trajectories.lissajous import lissajous
from kreisel.simulate.vocabulary import FUNCTIONS
from kreisel.study.building import (
    DISTURBANCES,
    TRAJECTORIES,
    build,
    declination,
    disturbance_kinds,
    trajectory_kinds,
)
from kreisel.study.imus import EFFECTS, effect_kinds
from kreisel.study.run import run
from kreisel.study.scenario import (
    DisturbanceRecipe,
    EnvironmentRecipe,
    FilterRecipe,
    ImuRecipe,
    Scenario,
    TrajectoryRecipe,
)

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "scenarios"
CIRCLE = TrajectoryRecipe("circle", {"radius": 2.0, "period": 10.0})
FIELD = (1.0, 20.0, -44.0)
COLUMNS = ("gyro", "accel", "mag_uT")


def test_recordings_are_those_of_the_parts_put_together_by_hand():
    scenario = Scenario(
        TrajectoryRecipe("lissajous", {"frequency": 0.5}),
        2.0,
        100.0,
        imus=(ImuRecipe("wrist", (0.1, 0.0, 0.2), (0.0, 10.0, 90.0)), ImuRecipe("elbow")),
        environment=EnvironmentRecipe(9.81, FIELD),
    )
    result = run(scenario)
    mount = Mount(np.array([0.1, 0.0, 0.2]), matrix_from_euler(np.deg2rad([0.0, 10.0, 90.0])), "wrist")
    environment = Environment(np.array([0.0, 0.0, -9.81]), np.array(FIELD))
    motion = lissajous(frequency=0.5).sample(np.arange(201) / 100.0)
    expected = Imu(mount, environment=environment).ideal(motion)
    for name in COLUMNS:
        assert getattr(result.recordings[0], name).tobytes() == getattr(expected, name).tobytes()
    assert [recording.name for recording in result.recordings] == ["wrist", "elbow"]
    assert result.motion.p_NB.tobytes() == motion.p_NB.tobytes()


SAME_BITS = ["figure_1.toml", "expressions.toml", "past_iron.toml", "drone.toml", "round_the_block.toml"]


@pytest.mark.parametrize("name", SAME_BITS)
def test_a_scenario_and_the_one_read_back_give_the_same_bits(name):
    scenario = Scenario.load(EXAMPLES / name)
    first, second = run(scenario), run(Scenario.from_toml(scenario.to_toml()))
    for one, other in zip(first.recordings, second.recordings, strict=True):
        for column in COLUMNS:
            assert getattr(one, column).tobytes() == getattr(other, column).tobytes()
    for one, other in zip(first.estimates, second.estimates, strict=True):
        assert one.attitude.R_NS.tobytes() == other.attitude.R_NS.tobytes()
    assert json.dumps(first.report()) == json.dumps(second.report())


def test_a_heading_that_nothing_tells_can_be_left_out_of_the_errors():
    turned = TrajectoryRecipe("rest", {"phi": (0.1, 0.2, 1.0)})
    filters = (FilterRecipe("dcm", name="as it is"), FilterRecipe("dcm", name="aligned", align="heading"))
    as_it_is, aligned = (e.summary for e in run(Scenario(turned, 5.0, 100.0, filters=filters)).estimates)
    assert as_it_is.heading_rmse_deg > 10.0
    # At rest the answer stays where it began: nothing but the offset is wrong.
    assert aligned.heading_rmse_deg < 1e-6
    assert abs(aligned.heading_offset_deg) == pytest.approx(as_it_is.heading_rmse_deg)


def test_a_trajectory_of_functions_runs_too():
    moving = FunctionTrajectory((np.cos, np.sin, 0.0), span=(0.0, 3.0))
    result = run(Scenario(moving, rate_hz=10.0))
    assert len(result.motion) == 31
    assert result.report()["scenario"]["trajectory"] == {"kind": "FunctionTrajectory", "parameters": {}}


def test_the_report_is_json_with_a_schema():
    scenario = Scenario(CIRCLE, 1.0, 100.0, name="c", seed=3, environment=EnvironmentRecipe(field_N_uT=FIELD))
    report = json.loads(json.dumps(run(scenario).report(), allow_nan=False))
    assert report["schema"] == "kreisel.run/1"
    assert report["samples"] == 101
    assert report["scenario"]["seed"] == 3
    assert report["scenario"]["trajectory"] == {
        "kind": "circle",
        "parameters": {"radius": 2.0, "period": 10.0},
    }
    assert report["imus"] == [{"name": "imu", "magnetometer": True}]
    # East over north.
    assert report["scenario"]["environment"]["declination_deg"] == pytest.approx(
        np.rad2deg(np.arctan(1 / 20))
    )


def test_notes_of_the_motion_are_reported():
    corner = TrajectoryRecipe("rounded_rectangle")
    notes = run(Scenario(corner, 5.0, 100.0)).report()["notes"]
    assert {note["kind"] for note in notes} == {"rate-step"}
    assert json.dumps(notes, allow_nan=False)


def test_every_kind_of_trajectory_is_offered():
    assert set(trajectory_kinds()) >= {
        "circle",
        "expressions",
        "file",
        "lissajous",
        "rest",
        "rounded_rectangle",
    }


@pytest.mark.parametrize(
    "kind", sorted(set(trajectory_kinds()) - {"expressions", "file", "profile", "waypoints"})
)
def test_a_kind_runs_with_its_defaults(kind):
    result = run(Scenario(TrajectoryRecipe(kind), 0.5, 50.0))
    assert len(result.recordings[0]) == 26


DOCS = (Path(__file__).resolve().parents[2] / "docs" / "scenarios.md").read_text(encoding="utf-8")


def test_the_docs_have_every_key_kind_and_function():
    recipes = (Scenario, ImuRecipe, EnvironmentRecipe, Waypoint, Segment, Clock, Sampling)
    keys = {f.name for recipe in recipes for f in fields(recipe)} - {
        "imus",
        "filters",
        "disturbances",
        "folder",
    }
    makers = [
        getattr(discovery.load(TRAJECTORIES, kind), kind) for kind in set(trajectory_kinds()) - {"file"}
    ]
    makers += [discovery.load(DISTURBANCES, kind).DISTURBANCE for kind in disturbance_kinds()]
    makers += [type(discovery.load(EFFECTS, kind).example()) for kind in effect_kinds()]
    parameters = {name for make in makers for name in signature(make).parameters}
    words = {*keys, *parameters, *trajectory_kinds(), *disturbance_kinds(), *effect_kinds(), *FUNCTIONS}
    assert [word for word in sorted(words) if not re.search(rf"[`\[]{word}[`(\]]", DOCS)] == []


# --- times ---


def times(**settings):
    return build(Scenario(settings.pop("trajectory", CIRCLE), **settings)).t


def test_times_are_counted_from_the_start_to_the_end():
    t = times(duration=3.0, rate_hz=1000.0, start=-1.0)
    assert len(t) == 3001
    assert (t[0], t[-1]) == (-1.0, 2.0)
    # Steps of counted times differ by the round-off of the times alone.
    np.testing.assert_allclose(np.diff(t), 1e-3, rtol=0, atol=1e-15)
    assert len(times(duration=0.1, rate_hz=30.0)) == 4
    assert len(times(duration=0.09, rate_hz=30.0)) == 3


@pytest.fixture
def recorded(tmp_path):
    """A file of uneven poses with an attitude, and the recipe that reads it."""
    t = 10.0 + np.cumsum(np.full(60, 0.02) + 1e-3 * np.sin(np.arange(60)))
    p = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    write(tmp_path / "p.csv", Poses(t, p, matrix_from_euler(np.stack([0 * t, 0 * t, t], axis=1))))
    return tmp_path, t


def test_a_file_brings_its_own_times(recorded):
    folder, t = recorded
    recipe = TrajectoryRecipe("file", {"path": "p.csv"})
    np.testing.assert_array_equal(times(trajectory=recipe, folder=folder), t)
    part = times(trajectory=recipe, folder=folder, start=10.5, duration=0.3)
    np.testing.assert_array_equal(part, t[(t >= 10.5) & (t <= 10.8)])
    even = times(trajectory=recipe, folder=folder, rate_hz=400.0)
    assert even[0] == t[0]
    np.testing.assert_allclose(np.diff(even), 1 / 400.0, rtol=1e-9)
    with pytest.raises(ValueError, match="scenario: start and duration ask for"):
        times(trajectory=recipe, folder=folder, duration=2.0)


def test_method_orientation_and_frame_of_a_file_are_passed_on(recorded):
    folder, t = recorded
    recipe = TrajectoryRecipe(
        "file", {"path": str(folder / "p.csv"), "orientation": "tangent", "frame": "ned-frd"}
    )
    motion = run(Scenario(recipe)).motion
    # In NED x is north: the file's (cos, sin, 0) goes to east = sin, north = cos; clockwise, nose along it.
    np.testing.assert_allclose(motion.p_NB, np.stack([np.sin(t), np.cos(t), 0 * t], axis=1), atol=1e-12)
    middle = slice(20, 40)
    np.testing.assert_allclose(motion.omega_NB_B[middle], np.tile([0, 0, -1.0], (20, 1)), atol=1e-6)
    method = TrajectoryRecipe("file", {"path": str(folder / "p.csv"), "method": "gradient"})
    assert "central differences" in run(Scenario(method)).motion.notes[0].text


# --- declination and filters ---


def test_declination_is_that_of_the_field_unless_it_is_said():
    assert declination(EnvironmentRecipe()) == 0.0
    assert declination(EnvironmentRecipe(field_N_uT=(20.0, 20.0, -40.0))) == pytest.approx(np.pi / 4)
    assert declination(EnvironmentRecipe(field_N_uT=FIELD, declination_deg=-90.0)) == pytest.approx(
        -np.pi / 2
    )


def test_filters_are_told_the_declination_and_find_the_heading():
    """A body that turns slowly on the spot: the field is east of north, and the heading true north's."""
    turning = TrajectoryRecipe("expressions", {"position": [0, 0, 0], "orientation": [0, 0, "0.2*t"]})
    scenario = Scenario(
        turning,
        10.0,
        100.0,
        environment=EnvironmentRecipe(field_N_uT=(5.0, 20.0, -44.0)),
        filters=(FilterRecipe("dcm"), FilterRecipe("dcm", {"declination": 0.0}, "untold")),
    )
    told, untold = run(scenario).estimates
    assert (told.imu, told.filter, untold.filter) == ("imu", "dcm", "untold")
    # Nothing but the first sample's round-off stands between a noise-free start and the truth.
    assert told.summary.total_max_deg < 0.01
    assert untold.summary.heading_rmse_deg == pytest.approx(np.rad2deg(np.arctan2(5.0, 20.0)), abs=0.01)


MUNICH = EnvironmentRecipe(
    latitude_deg=48.14, longitude_deg=11.58, height_m=520.0, date="2026-05-01", turning=True
)


def test_at_a_place_filters_are_told_its_declination():
    filters = (FilterRecipe("dcm"), FilterRecipe("dcm", {"declination": 0.0}, "untold"))
    scenario = Scenario(TrajectoryRecipe("rest"), 10.0, 100.0, environment=MUNICH, filters=filters)
    result = run(scenario)
    there = Environment.at(48.14, 11.58, 520.0, date(2026, 5, 1)).declination
    assert declination(MUNICH) == there
    told, untold = result.estimates
    # 15 deg/h times 10 s are 0.04 deg, of which a filter that takes N for inertial follows the magnetometer's share.
    assert told.summary.total_max_deg < 0.05
    assert untold.summary.heading_rmse_deg == pytest.approx(np.rad2deg(there), abs=0.05)
    np.testing.assert_allclose(np.linalg.norm(result.recordings[0].gyro, axis=1), 7.292115e-5, rtol=1e-12)
    reported = json.loads(json.dumps(result.report(), allow_nan=False))["scenario"]["environment"]
    assert reported["date"] == "2026-05-01" and reported["turning"] is True
    assert reported["gravity"] == pytest.approx(9.8074, abs=1e-4)
    assert np.linalg.norm(reported["field_N_uT"]) == pytest.approx(48.8, abs=0.1)


def test_a_perfect_imu_in_a_disturbed_world_comes_with_the_truth_of_it():
    step = DisturbanceRecipe("step", {"field_N_uT": (3.0, 0.0, 0.0), "start": 0.5})
    world = EnvironmentRecipe(field_N_uT=FIELD, disturbances=(step,))
    result = run(Scenario(CIRCLE, 1.0, 100.0, environment=world))
    (recorded,) = result.recorded
    np.testing.assert_array_equal(recorded.disturbance_N_uT[:, 0], np.where(result.motion.t < 0.5, 0.0, 3.0))
    np.testing.assert_array_equal(result.recordings[0].mag_uT, recorded.ideal.mag_uT)
    assert not run(Scenario(CIRCLE, 1.0, 100.0, environment=EnvironmentRecipe(field_N_uT=FIELD))).recorded


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("mod = '6'", "s: filter[0].mod is unknown; did you mean 'mode'?"),
        ("mode = 6", "s: filter[0].mode must be 'auto', '9', '6' or 'gyro'; got 6."),
        ("accel_time = '1'", "s: filter[0].accel_time must be a number; got '1'."),
        ("accel_time = -1", "s: filter[0]: accel_time must not be negative; got -1.0."),
        (
            "published = {weight_acel = 1}",
            "s: filter[0].published.weight_acel is unknown; did you mean 'weight_accel'?",
        ),
        (
            "published = {weight_accel = 'a'}",
            "s: filter[0].published.weight_accel must be a number; got 'a'.",
        ),
    ],
)
def test_tuning_is_checked_against_the_filter(line, message):
    text = f"duration = 1\nrate_hz = 100\n[trajectory]\nkind = 'circle'\n[[filter]]\nkind = 'dcm'\n{line}\n"
    with pytest.raises(ValueError) as caught:
        Scenario.from_toml(text, source="s")
    assert str(caught.value) == message


def test_nested_tuning_survives_the_file():
    recipe = FilterRecipe("dcm", {"published": {"weight_accel": 0.02}}, "published")
    scenario = Scenario(CIRCLE, 1.0, 100.0, filters=(recipe,))
    again = Scenario.from_toml(scenario.to_toml())
    assert again == scenario
    assert build(again).filters[0][1].published.weight_accel == 0.02
