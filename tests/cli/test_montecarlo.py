"""`kreisel montecarlo`: files, exit codes and the one line of a mistake."""

from __future__ import annotations

import json

import pytest

from kreisel import Ensemble, Scenario, monte_carlo
from kreisel.cli.main import main

TEXT = """
duration = 1.0
rate_hz = 50.0
trajectory = { kind = "lying_eight", period = 4.0 }
imu = { sensor = "bmi088" }
filter = { kind = "dcm" }
"""


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(TEXT)
    return path


def test_it_writes_what_can_be_loaded_again(scenario, tmp_path, capsys):
    out = tmp_path / "out"
    vary = ["--vary", "trajectory.period=uniform(3, 5)"]
    assert main(["montecarlo", str(scenario), "--runs", "20", *vary, "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "20 runs" in said and "rank correlation" in said
    assert {p.name for p in out.iterdir()} == {
        "scenario.toml",
        "report.json",
        "ensemble.npz",
        "imu-dcm-fans.png",
        "imu-dcm-runs.png",
        "imu-dcm-drivers.png",
    }
    assert Ensemble.load(out).runs == 20


def test_names_that_vary_have_no_correlation(scenario, tmp_path, capsys):
    out = tmp_path / "out"
    vary = ["--vary", 'imu.imu.sensor=choice("bmi088", "mpu6050")']
    assert main(["montecarlo", str(scenario), "--runs", "1", *vary, "-o", str(out)]) == 0
    assert capsys.readouterr().out.startswith("1 run of ")
    assert not list(out.glob("*-drivers.png"))


def test_what_chance_makes_is_no_driver(scenario, tmp_path, capsys):
    vary = ["--vary", "imu.imu.p_BS[0]=uniform(0, 1)"]
    options = ["--runs", "4", *vary, "--no-pictures", "-o", str(tmp_path / "out")]
    assert main(["montecarlo", str(scenario), *options]) == 0
    # 2 / sqrt(4) is 1, which no correlation exceeds.
    assert "no rank correlation above 1, which 4 runs show by chance" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("added", "told"),
    [
        ("", True),
        ("environment = { field_N_uT = [0, 20, -44] }", False),
        ("filter = { kind = 'dcm', align = 'heading' }", False),
    ],
)
@pytest.mark.parametrize("command", [["run"], ["montecarlo", "--runs", "2"]])
def test_a_heading_that_nothing_tells_is_named(command, added, told, tmp_path, capsys):
    text = TEXT.replace('filter = { kind = "dcm" }', added) if "filter" in added else TEXT + added
    (tmp_path / "s.toml").write_text(text)
    assert main([*command, str(tmp_path / "s.toml"), "--no-pictures", "-o", str(tmp_path / "out")]) == 0
    assert ("nothing tells dcm where north is" in capsys.readouterr().out) == told


def test_json_is_the_report_alone(scenario, tmp_path, capsys):
    out = tmp_path / "out"
    options = ["--runs", "4", "--seed", "9", "--threads", "1", "--no-pictures", "--json", "-o", str(out)]
    assert main(["montecarlo", str(scenario), *options]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["schema"] == "kreisel.ensemble/1" and report["scenario"]["seed"] == 9


def test_a_dry_run_writes_nothing(scenario, tmp_path):
    out = tmp_path / "out"
    assert main(["montecarlo", str(scenario), "--dry-run", "-o", str(out)]) == 0
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (["--runs", "0"], 2, "1 or more"),
        (["--vary", "trajectory.perod=uniform(3, 5)"], 2, "did you mean 'period'"),
        (["--vary", "trajectory.period=uniform(3)"], 2, "takes two numbers"),
        (["--vary", "trajectory.period"], 2, "PATH=DISTRIBUTION"),
        (["--vary", "filter.accel_time=normal(1, 1)", "--runs", "50"], 1, "of normal(1, 1)"),
    ],
)
def test_mistakes_are_told_in_one_line(scenario, tmp_path, capsys, options, code, said):
    try:
        got = main(["montecarlo", str(scenario), "-o", str(tmp_path / "out"), *options])
    except SystemExit as stop:
        got = stop.code
    assert got == code
    assert said in capsys.readouterr().err


def test_a_path_that_the_file_has_wrong_is_the_files_mistake(scenario, tmp_path, capsys):
    scenario.write_text(TEXT + "[vary]\n'trajectory.perod' = { uniform = [3, 5] }\n")
    assert main(["montecarlo", str(scenario), "-o", str(tmp_path / "out")]) == 1
    assert "did you mean 'period'" in capsys.readouterr().err


def interrupted(scenario, folder, runs):
    """The finished blocks of a study that somebody stopped after the first."""

    def stop(done):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        monte_carlo(Scenario.load(scenario), runs, threads=1, folder=folder, on_done=stop)


def test_an_interrupted_study_goes_on_with_the_same_bits(scenario, tmp_path, capsys):
    whole, halves = tmp_path / "whole", tmp_path / "halves"
    command = ["montecarlo", str(scenario), "--runs", "200", "--no-pictures", "-o"]
    assert main([*command, str(whole)]) == 0
    interrupted(scenario, halves / "blocks", 200)
    assert main([*command, str(halves)]) == 1
    assert "--resume" in capsys.readouterr().err
    assert main([*command, str(halves), "--resume"]) == 0
    assert (halves / "ensemble.npz").read_bytes() == (whole / "ensemble.npz").read_bytes()
    assert not (halves / "blocks").exists()


def test_blocks_of_another_study_are_refused_with_the_difference(scenario, tmp_path, capsys):
    out = tmp_path / "out"
    interrupted(scenario, out / "blocks", 200)
    command = ["montecarlo", str(scenario), "-o", str(out), "--resume", "--runs"]
    assert main([*command, "100"]) == 1
    told = capsys.readouterr().err
    assert "runs is 200 there and 100 here" in told
    scenario.write_text(TEXT.replace("4.0", "5.0"))
    assert main([*command, "200"]) == 1
    told = capsys.readouterr().err
    assert "period is 4.0 there and 5.0 here" in told


def test_a_file_that_changed_is_another_study(tmp_path, capsys):
    rows = [f"{0.02 * k},{0.1 * k},0,0" for k in range(101)]
    (tmp_path / "p.csv").write_text("\n".join(["t,x,y,z", *rows]))
    scenario = tmp_path / "s.toml"
    scenario.write_text(
        'trajectory = { kind = "file", path = "p.csv", orientation = "tangent" }\n'
        'imu = { sensor = "bmi088" }\nfilter = { kind = "dcm" }\n'
    )
    interrupted(scenario, tmp_path / "out/blocks", 100)
    (tmp_path / "p.csv").write_text("\n".join(["t,x,y,z", *rows[:-1]]))
    assert main(["montecarlo", str(scenario), "--runs", "100", "-o", str(tmp_path / "out"), "--resume"]) == 1
    assert "p.csv" in capsys.readouterr().err


@pytest.mark.parametrize("backend", ["dusk", "127.0.0.1:8786"])
def test_a_backend_that_is_none_is_a_mistake_of_the_command(scenario, tmp_path, backend, capsys):
    assert main(["montecarlo", str(scenario), "-o", str(tmp_path / "out"), "--backend", backend]) == 2
    assert "--backend" in capsys.readouterr().err


def test_dask_workers_give_the_same_bits(scenario, tmp_path):
    pytest.importorskip("distributed", reason="clusters need dask: pip install 'kreisel[cluster]'")
    command = ["montecarlo", str(scenario), "--runs", "64", "--no-pictures", "-o"]
    assert main([*command, str(tmp_path / "here")]) == 0
    assert main([*command, str(tmp_path / "there"), "--backend", "dask"]) == 0
    here, there = (tmp_path / name / "ensemble.npz" for name in ("here", "there"))
    assert here.read_bytes() == there.read_bytes()
