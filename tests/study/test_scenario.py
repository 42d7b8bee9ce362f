"""Scenario files: read, written, and every mistake in them answered with one sentence that names the key."""

from __future__ import annotations

import datetime
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kreisel.data.environment import Environment
from kreisel.data.trajectory import Poses
from kreisel.files.doors import write
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.study.building import build, surroundings
from kreisel.study.scenario import (
    DisturbanceRecipe,
    EffectRecipe,
    EnvironmentRecipe,
    FilterRecipe,
    ImuRecipe,
    Scenario,
    TrajectoryRecipe,
)

ROOT = Path(__file__).resolve().parents[2]

CIRCLE = '[trajectory]\nkind = "circle"\n'
SOUND = "duration = 1.0\nrate_hz = 100\n"


def read(text: str) -> Scenario:
    return Scenario.from_toml(text, source="s.toml")


def test_a_short_file_has_defaults_for_the_rest():
    scenario = read(SOUND + CIRCLE)
    assert scenario == Scenario(TrajectoryRecipe("circle"), 1.0, 100.0)
    assert scenario.imus == (ImuRecipe("imu", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),)
    assert scenario.environment == EnvironmentRecipe()
    np.testing.assert_array_equal(surroundings(scenario.environment).g_N, [0.0, 0.0, -9.80665])


def test_a_filter_says_which_offsets_do_not_count():
    text = (
        SOUND + CIRCLE + '[[filter]]\nkind = "dcm"\nmode = "6"\nalign = "heading"\nclock_offset = "estimate"'
    )
    scenario = read(text)
    assert scenario.filters == (FilterRecipe("dcm", {"mode": "6"}, "", "heading", "estimate"),)
    assert read(scenario.to_toml()) == scenario
    with pytest.raises(ValueError, match="clock_offset must be a finite number"):
        FilterRecipe("dcm", clock_offset=float("nan"))


def test_a_full_file_is_read_as_it_stands():
    scenario = read(
        'name = "all"\nseed = 7\nstart = -1\n' + SOUND + CIRCLE + "radius = 2\n"
        '[[imu]]\nname = "a"\np_BS = [1, 0, 0]\n[[imu]]\nname = "b"\nrotation_deg = [0, 0, 90]\n'
        "[environment]\ngravity = 9.81\nfield_N_uT = [0, 20, -44]\ndeclination_deg = 3\n"
    )
    assert scenario == Scenario(
        TrajectoryRecipe("circle", {"radius": 2}),
        1.0,
        100.0,
        -1.0,
        "all",
        7,
        (ImuRecipe("a", (1.0, 0.0, 0.0)), ImuRecipe("b", rotation_deg=(0.0, 0.0, 90.0))),
        EnvironmentRecipe(9.81, (0.0, 20.0, -44.0), 3.0),
    )


def test_a_place_a_date_and_what_disturbs_the_field_there():
    scenario = read(
        SOUND + CIRCLE + MUNICH + "height_m = 520\ndate = 2026-05-01\nturning = true\n" + STEP + "end = 0.7\n"
    )
    step = DisturbanceRecipe("step", {"field_N_uT": (3, 0, 0), "start": 0.5, "end": 0.7})
    expected = EnvironmentRecipe(
        latitude_deg=48.14,
        longitude_deg=11.58,
        height_m=520.0,
        date="2026-05-01",
        turning=True,
        disturbances=(step,),
    )
    assert scenario.environment == expected
    found = surroundings(scenario.environment)
    there = Environment.at(48.14, 11.58, 520.0, datetime.date(2026, 5, 1), turning=True)
    for name in ("g_N", "field_N_uT", "omega_IN_N"):
        np.testing.assert_array_equal(getattr(found, name), getattr(there, name))
    assert found.disturbances[0].span == (0.5, 0.7)


def test_what_is_given_goes_before_what_the_place_has():
    recipe = EnvironmentRecipe(9.81, (0.0, 20.0, -44.0), latitude_deg=48.0, longitude_deg=11.0, turning=True)
    found = surroundings(recipe)
    np.testing.assert_array_equal(found.g_N, [0.0, 0.0, -9.81])
    np.testing.assert_array_equal(found.field_N_uT, [0.0, 20.0, -44.0])
    assert found.omega_IN_N.any()


def test_one_imu_may_be_a_single_table():
    assert read(SOUND + CIRCLE + '[imu]\nname = "wrist"\n').imus == (ImuRecipe("wrist"),)


NUMBERS = st.floats(-1e6, 1e6)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
NAMES = st.from_regex(r"[a-z][a-z0-9 _-]{0,8}", fullmatch=True)
TRAJECTORIES = st.one_of(
    st.builds(
        TrajectoryRecipe,
        st.just("circle"),
        st.fixed_dictionaries({"radius": NUMBERS}, optional={"period": st.floats(0.1, 1e3)}),
    ),
    st.builds(
        TrajectoryRecipe,
        st.just("expressions"),
        st.fixed_dictionaries(
            {
                "position": st.just(("r*cos(t)", "sin(t)", 0.0)),
                "parameters": st.fixed_dictionaries({"r": NUMBERS}),
            }
        ),
    ),
    st.builds(TrajectoryRecipe, st.just("line"), st.fixed_dictionaries({"velocity": VECTORS})),
)
# Disturbances that act within any run: they are always there, or begin before it and stay.
DISTURBANCES = st.lists(
    st.builds(
        DisturbanceRecipe,
        st.just("dipole"),
        st.fixed_dictionaries({"p_ND": st.just((0, 1e7, 0)), "moment_N": VECTORS}),
    )
    | st.builds(
        DisturbanceRecipe,
        st.sampled_from(["step", "drift"]),
        st.fixed_dictionaries({"field_N_uT": VECTORS, "start": st.just(-1e7), "end": st.just(1e7)}),
    ),
    max_size=3,
).map(tuple)
GRAVITIES = st.floats(0.0, 1e3)
# 31 to 69 uT: not the Earth's in any other unit.
FIELDS = st.tuples(*[st.floats(18.0, 40.0)] * 3)
PLACES = st.builds(
    EnvironmentRecipe,
    st.none() | GRAVITIES,
    declination_deg=st.none() | NUMBERS,
    latitude_deg=st.floats(-90.0, 90.0),
    longitude_deg=st.floats(-180.0, 360.0),
    height_m=st.none() | st.floats(-1000.0, 1e5),
    date=st.dates(datetime.date(2010, 1, 1), datetime.date(2029, 12, 31)),
    turning=st.booleans(),
    disturbances=DISTURBANCES,
)
# What suits any run: no latency, no jitter, temperatures that always were.
IMUS = st.builds(
    ImuRecipe,
    NAMES,
    VECTORS,
    VECTORS,
    datasheet=st.dictionaries(
        st.sampled_from(["gyro_fixed_bias_dps", "accel_fixed_temperature_bias_mg_per_K"]), NUMBERS | VECTORS
    ),
    clock=st.fixed_dictionaries(
        {}, optional={"offset": NUMBERS, "loss": st.floats(0.0, 1.0), "mag": st.just({"rate": 20.0})}
    ),
    temperature=st.none() | st.floats(-273.0, 2000.0) | st.just(((-1e7, 20.0), (1e7, 30.0))),
    effects=st.lists(
        st.builds(
            EffectRecipe,
            st.sampled_from(["gyro", "accel"]),
            st.just("scale_factor"),
            st.fixed_dictionaries({"sigma": st.floats(0.0, 1.0)}),
        ),
        max_size=2,
        unique_by=lambda e: e.sensor,
    ).map(tuple),
)
SCENARIOS = st.builds(
    Scenario,
    TRAJECTORIES,
    st.floats(1e-3, 10.0),
    st.floats(1.0, 1e3),
    st.none() | NUMBERS,
    st.text(max_size=10),
    st.integers(0, 2**70),
    st.lists(IMUS, unique_by=lambda i: i.name, max_size=3).map(tuple),
    st.builds(EnvironmentRecipe, GRAVITIES, st.none() | FIELDS, st.none() | NUMBERS) | PLACES,
)


@given(SCENARIOS)
def test_scenarios_survive_their_file(scenario):
    again = Scenario.from_toml(scenario.to_toml())
    assert again == scenario
    assert again.to_toml() == scenario.to_toml()
    assert pickle.loads(pickle.dumps(scenario)) == scenario


def test_recipes_are_values_of_their_own():
    velocity, parameters = np.array([1.0, 2.0, 3.0]), {}
    parameters["velocity"] = velocity
    recipe = TrajectoryRecipe("line", parameters)
    velocity[:] = 0.0
    parameters["start"] = 1
    assert recipe.parameters == {"velocity": (1.0, 2.0, 3.0)}
    scenario = Scenario(recipe, np.float64(1.0), np.int64(100))
    assert Scenario.from_toml(scenario.to_toml()) == scenario


def test_functions_stay_in_python():
    scenario = Scenario(FunctionTrajectory((np.cos, np.sin, 0.0)), 1.0, 100.0)
    with pytest.raises(
        ValueError, match=r"FunctionTrajectory cannot be written.*TrajectoryRecipe\(\"expressions\""
    ):
        scenario.to_toml()
    with pytest.raises(ValueError, match=r"parameters.position\[0\] must hold plain values.*expressions"):
        TrajectoryRecipe("expressions", {"position": [np.cos, "0", "0"]})


EXPRESSIONS = SOUND + '[trajectory]\nkind = "expressions"\n'

MUNICH = "[environment]\nlatitude_deg = 48.14\nlongitude_deg = 11.58\n"
FIELD = "[environment]\nfield_N_uT = [0, 20, -44]\n"
STEP = '[[environment.disturbance]]\nkind = "step"\nfield_N_uT = [3, 0, 0]\nstart = 0.5\n'

MISTAKES = [
    ("", "s.toml: trajectory is missing"),
    (CIRCLE, "s.toml: duration is missing; this trajectory has no end"),
    ("duration = 1\n" + CIRCLE, "s.toml: rate_hz is missing; only a file"),
    (SOUND + "sed = 1\n" + CIRCLE, "s.toml: sed is unknown; did you mean 'seed'?"),
    (SOUND + "imus = 1\n" + CIRCLE, "s.toml: imus is unknown; did you mean 'imu'?"),
    (SOUND + "folder = '/'\n" + CIRCLE, "s.toml: folder is unknown"),
    (SOUND + CIRCLE + "radios = 2", "s.toml: trajectory.radios is unknown; did you mean 'radius'?"),
    (
        SOUND + '[trajectory]\nkind = "circel"',
        "s.toml: trajectory.kind 'circel' is unknown; did you mean 'circle'?",
    ),
    (SOUND + '[trajectory]\nkind = "sampled"', "s.toml: trajectory.kind 'sampled' is unknown"),
    (SOUND + '[trajectory]\nkind = "../shapes"', "s.toml: trajectory.kind '../shapes' is unknown"),
    (SOUND + "[trajectory]\nradius = 1", "s.toml: trajectory.kind is missing."),
    (SOUND + "[trajectory]\nkind = 3", "s.toml: trajectory.kind must be text in quotes; got 3."),
    (SOUND + "trajectory = 3", "s.toml: trajectory must be a table; got 3."),
    (SOUND + CIRCLE + 'radius = "2"', "s.toml: trajectory.radius must be a number; got '2'."),
    (SOUND + CIRCLE + "radius = true", "s.toml: trajectory.radius must be a number; got True."),
    (SOUND + CIRCLE + "radius = inf", "s.toml: trajectory.radius must be a finite number; got inf."),
    (SOUND + CIRCLE + "radius = 2024-01-01", "s.toml: trajectory: parameters.radius must hold plain values"),
    (SOUND + CIRCLE + "period = 0", "s.toml: trajectory: period must not be 0."),
    (SOUND + '[trajectory]\nkind = "line"\nvelocity = [1, 2]', "s.toml: trajectory: velocity must be (3,)"),
    (
        SOUND + '[trajectory]\nkind = "line"\nvelocity = [1, "x", 3]',
        "s.toml: trajectory.velocity[1] must be a number",
    ),
    (
        SOUND + '[trajectory]\nkind = "line"\nvelocity = 3',
        "s.toml: trajectory.velocity must be a list; got 3.",
    ),
    (EXPRESSIONS, "s.toml: trajectory.position is missing."),
    (
        EXPRESSIONS + 'position = ["t", "cos(q*t)", "0"]',
        's.toml: trajectory: position[1], column 5, at "q*t)"',
    ),
    (EXPRESSIONS + "position = [\"__import__('os')\", 0, 0]", "s.toml: trajectory: position[0], column 12"),
    (EXPRESSIONS + 'position = [0, 0, "9**9**9**9"]', "s.toml: trajectory: position[2], column 4"),
    (
        EXPRESSIONS + 'position = ["t", true, 0]',
        "s.toml: trajectory.position[1] must be text in quotes or a number",
    ),
    (
        EXPRESSIONS + 'position = ["t", 0, 0]\norientation = 3',
        "s.toml: trajectory.orientation must be text in quotes or",
    ),
    (
        EXPRESSIONS + 'position = ["f*t", 0, 0]\nparameters = {f = "1"}',
        "s.toml: trajectory.parameters.f must be a number; got '1'.",
    ),
    (EXPRESSIONS + 'position = ["t", 0, 0]\nspan = [2, 2.5]', "s.toml: start and duration ask for 2 to 3 s"),
    (SOUND + CIRCLE + "[[imu]]\np_Bs = [0, 0, 0]", "s.toml: imu[0].p_Bs is unknown; did you mean 'p_BS'?"),
    (SOUND + CIRCLE + "[[imu]]\np_BS = [0, 0]", "s.toml: imu[0].p_BS[2] is missing."),
    (
        SOUND + CIRCLE + '[[imu]]\n[[imu]]\np_BS = [0, 0, "a"]',
        "s.toml: imu[1].p_BS[2] must be a number; got 'a'.",
    ),
    (SOUND + CIRCLE + "[[imu]]\n[[imu]]", "s.toml: two imus are called 'imu'"),
    (SOUND + CIRCLE + '[[imu]]\nname = "../x"', "s.toml: imu[0]: name must start with"),
    (SOUND + "imu = 3\n" + CIRCLE, "s.toml: imu must be tables [[imu]]; got 3."),
    (SOUND + "imu = [3]\n" + CIRCLE, "s.toml: imu[0] must be a table; got 3."),
    (
        SOUND + CIRCLE + "[environment]\ngravty = 9",
        "s.toml: environment.gravty is unknown; did you mean 'gravity'?",
    ),
    (
        SOUND + CIRCLE + "[environment]\nfield_N_uT = 3",
        "s.toml: environment.field_N_uT must be a list; got 3.",
    ),
    (
        SOUND + CIRCLE + "[environment]\nlatitude_deg = 48",
        "s.toml: environment: a place needs both latitude_deg and longitude_deg",
    ),
    (
        SOUND + CIRCLE + "[environment]\nlatitude_deg = 91\nlongitude_deg = 0",
        "s.toml: environment: latitude_deg must be one number, from -90 to 90, deg; got 91.0.",
    ),
    (
        SOUND + CIRCLE + "[environment]\nlatitud_deg = 48",
        "s.toml: environment.latitud_deg is unknown; did you mean 'latitude_deg'?",
    ),
    (
        SOUND + CIRCLE + "[environment]\ndate = 2026-05-01",
        "s.toml: environment: date says nothing without a place; give latitude_deg and longitude_deg.",
    ),
    (
        SOUND + CIRCLE + "[environment]\nturning = true",
        "s.toml: environment: turning says nothing without a place",
    ),
    (
        SOUND + CIRCLE + "[environment]\nturning = 1",
        "s.toml: environment.turning must be true or false; got 1.",
    ),
    (
        SOUND + CIRCLE + MUNICH + "date = 1999-01-01",
        "s.toml: environment.date: no magnetic model covers 1999-01-01: the World Magnetic Models",
    ),
    (
        SOUND + CIRCLE + MUNICH + 'date = "1.5.2026"',
        "s.toml: environment: date must be a date, such as 2026-05-01; got '1.5.2026'.",
    ),
    (
        SOUND + CIRCLE + MUNICH + "date = 2026-05-01T12:00:00",
        "s.toml: environment: date must be a date, such as 2026-05-01; got '2026-05-01 12:00:00'.",
    ),
    (
        SOUND + CIRCLE + MUNICH + "date = 2026-05-01\nfield_N_uT = [0, 20, -44]",
        "s.toml: environment: date and field_N_uT both say what the magnetic field is",
    ),
    (
        SOUND + CIRCLE + MUNICH + STEP,
        "s.toml: environment: there is no magnetic field to disturb; give field_N_uT",
    ),
    (
        SOUND + CIRCLE + FIELD + "disturbances = []",
        "s.toml: environment.disturbances is unknown; did you mean",
    ),
    (SOUND + CIRCLE + FIELD + "disturbance = 3", "s.toml: environment.disturbance must be tables [["),
    (
        SOUND + CIRCLE + FIELD + '[[environment.disturbance]]\nkind = "dipol"',
        "s.toml: environment.disturbance[0].kind 'dipol' is unknown; did you mean 'dipole'?",
    ),
    (
        SOUND + CIRCLE + FIELD + STEP + '[[environment.disturbance]]\nkind = "dipole"\np_nd = [1, 2, 3]',
        "s.toml: environment.disturbance[1].p_nd is unknown; did you mean 'p_ND'?",
    ),
    (
        SOUND
        + CIRCLE
        + FIELD
        + '[[environment.disturbance]]\nkind = "dipole"\np_ND = [1, 2]\nmoment_N = [0, 0, 1]',
        "s.toml: environment.disturbance[0]: p_ND must be three finite numbers, m in N; got [1.0, 2.0].",
    ),
    (
        SOUND + CIRCLE + FIELD + STEP + "end = 0.1",
        "s.toml: environment.disturbance[0]: end must be after start, 0.5 s; got 0.1 s.",
    ),
    (
        SOUND + CIRCLE + FIELD + STEP.replace("0.5", "5"),
        "s.toml: environment.disturbance[0] acts from 5 to inf s, and the run lasts from 0 to 1 s.",
    ),
    (SOUND + CIRCLE + '[[filter]]\nkind = "nope"', "s.toml: filter[0].kind 'nope' is unknown"),
    (SOUND + CIRCLE + "[[filter]]\nmode = 6", "s.toml: filter[0].kind is missing."),
    (
        SOUND + CIRCLE + '[[filter]]\nkind = "dcm"\nalign = "north"',
        "s.toml: filter[0].align must be 'heading'",
    ),
    (
        SOUND + CIRCLE + '[[filter]]\nkind = "dcm"\nclock_offset = "x"',
        "s.toml: filter[0].clock_offset must be",
    ),
    ("duration = -1\nrate_hz = 1\n" + CIRCLE, "s.toml: duration must be above 0; got -1.0."),
    ("duration = 1\nrate_hz = 0\n" + CIRCLE, "s.toml: rate_hz must be above 0; got 0.0."),
    ("duration = 1e9\nrate_hz = 1000\n" + CIRCLE, "s.toml: 1e+09 s at 1000 Hz are 1e+12 samples"),
    (SOUND + "seed = 1.5\n" + CIRCLE, "s.toml: seed must be a whole number; got 1.5."),
    (SOUND + "seed = -1\n" + CIRCLE, "s.toml: seed must be a whole number, 0 or more; got -1."),
    (SOUND + "name = 3\n" + CIRCLE, "s.toml: name must be text in quotes; got 3."),
    (SOUND + "start = nan\n" + CIRCLE, "s.toml: start must be a finite number"),
    (SOUND + "name = 2024-01-01\n" + CIRCLE, "s.toml: name must be text in quotes"),
    ("duration = 1\nduration = 2\n", "s.toml is not TOML"),
    ("kind: circle", "s.toml is not TOML"),
    ("a = " + "[" * 5000, "s.toml"),
    (".".join(["a"] * 3000) + " = 1", "s.toml is no scenario: its values are nested more than 10 deep."),
    ("seed = " + "9" * 5000, "s.toml is not TOML"),
]


@pytest.mark.parametrize(("text", "message"), MISTAKES, ids=[message[:60] for _, message in MISTAKES])
def test_a_mistake_is_one_sentence_that_names_the_key(text, message):
    with pytest.raises(ValueError) as caught:
        read(text)
    told = str(caught.value)
    assert told.startswith(message)
    assert "\n" not in told
    assert "pydantic" not in told
    assert len(told) < 300


def test_recipes_made_in_python_are_checked_too():
    with pytest.raises(ValueError, match="rate_hz must be above 0"):
        Scenario(TrajectoryRecipe("circle"), 1.0, -100.0)
    with pytest.raises(ValueError, match="duration must be a finite number"):
        Scenario(TrajectoryRecipe("circle"), "1")
    with pytest.raises(ValueError, match=r"p_BS\[1\] must be a finite number"):
        ImuRecipe(p_BS=(0, float("nan"), 0))
    with pytest.raises(ValueError, match="two filters are called 'dcm'"):
        Scenario(TrajectoryRecipe("circle"), filters=[FilterRecipe("dcm"), FilterRecipe("dcm")])


def test_paths_begin_at_the_folder_of_the_scenario(tmp_path, monkeypatch):
    t = np.arange(50) / 50.0
    (tmp_path / "data").mkdir()
    write(tmp_path / "data" / "p.csv", Poses(t, np.stack([t, t**2, 0 * t], axis=1)))
    path = tmp_path / "s.toml"
    path.write_text('[trajectory]\nkind = "file"\npath = "data/p.csv"\norientation = "tangent"\n')
    monkeypatch.chdir("/")
    scenario = Scenario.load(path)
    assert scenario.folder == tmp_path
    path.write_text(path.read_text() + 'frame = "ned"\n')
    with pytest.raises(
        ValueError, match=r"s.toml: trajectory: frame must be one of .*Did you mean 'ned-frd'"
    ):
        Scenario.load(path)
    path.write_text('[trajectory]\nkind = "file"\npath = "data/q.csv"\n')
    with pytest.raises(OSError, match=r"no such file\. Did you mean 'p.csv'"):
        Scenario.load(path)


def test_files_that_are_no_scenario(tmp_path):
    path = tmp_path / "s.toml"
    with pytest.raises(OSError, match=r"cannot read .*s\.toml"):
        Scenario.load(path)
    with pytest.raises(OSError, match="cannot read"):
        Scenario.load(tmp_path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"s\.toml is no scenario: it is not text"):
        Scenario.load(path)
    path.write_bytes(b"#" * 1_000_001)
    with pytest.raises(ValueError, match=r"s\.toml is no scenario: it is larger"):
        Scenario.load(path)
    path.write_bytes(b"\xef\xbb\xbf" + (SOUND + CIRCLE).replace("\n", "\r\n").encode())
    assert Scenario.load(path) == read(SOUND + CIRCLE)


def test_importing_study_waits_with_pydantic():
    program = "import sys, kreisel.study.scenario, kreisel.study.run, kreisel.study.document; "
    program += "print(sorted({'pydantic', 'tomli_w', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONPATH": str(ROOT / "src")}, capture_output=True, text=True
    )
    assert done.stdout == "[]\n", done.stderr


def test_a_file_takes_the_noise_and_gaps_of_its_poses(tmp_path: Path) -> None:
    rng, t = np.random.default_rng(3), np.arange(200) / 100.0
    p = np.stack([np.sin(t), np.cos(t), 0.1 * t], axis=1) + 1e-3 * rng.normal(size=(200, 3))
    kept = (t < 0.8) | (t > 1.2)
    write(tmp_path / "p.csv", Poses(t[kept], p[kept]))
    text = '[trajectory]\nkind = "file"\npath = "p.csv"\nposition_noise = [1e-3, 1e-3, 2e-3]\n'
    with pytest.raises(ValueError, match=r"no positions from t = .*max_gap=0.4"):
        Scenario.from_toml(text, folder=tmp_path)
    scenario = Scenario.from_toml(text + "max_gap = 0.5\n", folder=tmp_path)
    trajectory = build(scenario).trajectory
    np.testing.assert_array_equal(trajectory.position_smoothing.sigma, [1e-3, 1e-3, 2e-3])
