"""`kreisel montecarlo`: files, exit codes and the one line of a mistake."""

from __future__ import annotations

import json

import pytest

from kreisel import Ensemble
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
