"""`kreisel evaluate` as a person and as a program meet it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main
from kreisel.maths.rotations import exp_so3, matrix_from_euler

N = 400
T = np.arange(N) / 100.0
R = matrix_from_euler(np.column_stack([0.4 * np.sin(3 * T), 0.3 * np.cos(2 * T), 0.5 * np.sin(T)]))


@pytest.fixture
def truth(tmp_path: Path) -> str:
    path = tmp_path / "truth.tum"
    kreisel.write(path, kreisel.Poses(T, np.ones((N, 3)), R))
    return str(path)


def estimate(tmp_path: Path, dtheta_deg, name: str = "attitude.npz", late: float = 0.0, **fields) -> str:
    """A file with the truth turned by `dtheta_deg` about the axes of N, stamps ahead by `late`."""
    turned = exp_so3(np.radians(np.broadcast_to(dtheta_deg, (N, 3)))) @ R
    kreisel.write(tmp_path / name, kreisel.AttitudeHistory(T + late, turned, **fields))
    return str(tmp_path / name)


def report(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    assert main(["evaluate", *arguments, "--json"]) == 0
    streams = capsys.readouterr()
    assert streams.err == ""
    return json.loads(streams.out)


def test_the_table_has_the_three_errors(truth, tmp_path, capsys) -> None:
    assert main(["evaluate", truth, estimate(tmp_path, [0.0, 0.0, 2.0])]) == 0
    text = capsys.readouterr().out
    lines = {line.split()[0]: line.split()[1:] for line in text.splitlines() if line}
    assert lines["total"] == lines["heading"] == ["2"] * 5
    # A quaternion in the file holds an angle to 1e-15 rad.
    assert all(float(value) < 1e-6 for value in lines["inclination"])
    assert "400 samples that count, over 3.99 s" in text
    assert "below 5 deg for good: from the start" in text


@pytest.mark.parametrize("name", ["attitude.npz", "attitude.csv", "attitude.tum", "attitude.mat"])
def test_the_estimate_may_be_any_file_of_attitude(name, truth, tmp_path, capsys) -> None:
    found = report(capsys, truth, estimate(tmp_path, [3.0, 0.0, 0.0], name))
    assert found["schema"] == "kreisel.evaluate/1"
    assert found["summary"]["total_rmse_deg"] == pytest.approx(3.0, rel=1e-9)


@pytest.mark.parametrize("kind", ["motion", "attitude", "reference", "trial"])
def test_the_truth_may_be_any_noun_with_attitude(kind, tmp_path, capsys) -> None:
    counts = T >= 1.0
    zeros = np.zeros((N, 3))
    path = tmp_path / "truth.npz"
    if kind == "motion":
        kreisel.write(path, kreisel.Motion(T, zeros, zeros, zeros, R, zeros, zeros))
    elif kind == "attitude":
        kreisel.write(path, kreisel.AttitudeHistory(T, R))
    elif kind == "reference":
        kreisel.write(path, kreisel.Reference(T, R, counts))
    else:
        path = broad_trial(tmp_path, counts)
    found = report(capsys, str(path), estimate(tmp_path, [0.0, 4.0, 0.0]))
    assert found["summary"]["inclination_rmse_deg"] == pytest.approx(4.0, rel=1e-9)
    assert found["summary"]["samples"] == (N if kind in ("motion", "attitude") else counts.sum())


def broad_trial(tmp_path: Path, counts) -> Path:
    from scipy.io import savemat

    from kreisel.maths.rotations import quat_wxyz_from_matrix

    imu = dict.fromkeys(("imu_gyr", "imu_acc", "imu_mag"), np.ones((N, 3)))
    truth = {"opt_quat": quat_wxyz_from_matrix(R), "movement": counts, "sampling_rate": 100.0}
    savemat(tmp_path / "trial.mat", imu | truth)
    return tmp_path / "trial.mat"


def test_offsets_are_removed_when_asked_and_named(truth, tmp_path, capsys) -> None:
    turned = estimate(tmp_path, [0.0, 0.0, 30.0], late=0.05)
    assert main(["evaluate", truth, turned, "--align", "heading", "--clock-offset", "estimate"]) == 0
    text = capsys.readouterr().out
    assert "removed: heading offset of 30 deg" in text
    assert "removed: clock offset of 0.05 s" in text
    found = report(capsys, truth, turned, "--align", "heading", "--clock-offset", "0.05")["summary"]
    assert found["clock_offset_s"] == 0.05
    assert found["total_max_deg"] < 1e-6


def test_a_turned_sensor_is_compared_with_its_body(truth, tmp_path, capsys) -> None:
    R_BS = matrix_from_euler(np.radians([0.0, 0.0, 90.0]))
    path = tmp_path / "sensor.npz"
    kreisel.write(path, kreisel.AttitudeHistory(T, R @ R_BS))
    assert report(capsys, truth, str(path))["summary"]["total_rmse_deg"] == pytest.approx(90.0)
    found = report(capsys, truth, str(path), "--imu", "wrist:0,0,0.1:0,0,90")
    assert found["summary"]["total_rmse_deg"] < 1e-6


def test_pictures_and_summary_are_written(truth, tmp_path, capsys) -> None:
    bias = np.zeros((N, 3))
    path = estimate(tmp_path, [1.0, 0.0, 0.0], gyro_bias=bias)
    out = tmp_path / "deep" / "out"
    assert main(["evaluate", truth, path, "-o", str(out)]) == 0
    names = ["attitude.png", "bias.png", "errors.png", "summary.json"]
    assert sorted(p.name for p in out.iterdir()) == names
    text = capsys.readouterr().out
    assert all(name in text for name in names)
    assert json.loads((out / "summary.json").read_text())["summary"]["total_rmse_deg"] == pytest.approx(1.0)


def test_a_true_bias_is_drawn_where_the_truth_has_one(tmp_path, monkeypatch) -> None:
    from kreisel import show

    drawn = []
    monkeypatch.setattr(
        show, "plot_bias", lambda *given: drawn.append(given) or show.attitude.plot_bias(*given)
    )
    truth = kreisel.AttitudeHistory(T, R, np.full((N, 3), 0.01), t0_ns=10**9)
    kreisel.write(tmp_path / "truth.npz", truth)
    path = estimate(tmp_path, [1.0, 0, 0], gyro_bias=np.zeros((N, 3)), t0_ns=10**9 - 500_000_000)
    assert main(["evaluate", str(tmp_path / "truth.npz"), path, "-o", str(tmp_path / "out")]) == 0
    ((_, bias, t),) = drawn
    np.testing.assert_array_equal(bias, 0.01)
    np.testing.assert_allclose(t, T + 0.5)


@pytest.mark.parametrize(
    ("limit", "code", "said"),
    [
        (["--max-total-rmse-deg", "2.1"], 0, ""),
        (["--max-total-rmse-deg", "1.9"], 3, "total RMSE in deg: 2, allowed 1.9"),
        (["--max-heading-rmse-deg", "1.9"], 3, "heading RMSE in deg: 2, allowed 1.9"),
        (["--max-inclination-rmse-deg", "0.1"], 0, ""),
        (["--max-convergence-time-s", "1"], 0, ""),
        (["--max-convergence-time-s", "1", "--limit-deg", "1"], 3, "convergence in s: never, allowed 1"),
    ],
)
def test_a_missed_limit_is_exit_code_3(limit, code, said, truth, tmp_path, capsys) -> None:
    path = estimate(tmp_path, [0.0, 0.0, 2.0])
    assert main(["evaluate", truth, path, "--json", *limit]) == code
    streams = capsys.readouterr()
    assert said in streams.err
    assert [entry["held"] for entry in json.loads(streams.out)["limits"]] == [code == 0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--align", "headng"], "Did you mean 'heading'"),
        (["--clock-offset", "100"], "do not overlap"),
        (["--imu", "1,2"], "--imu takes"),
    ],
)
def test_mistakes_are_one_line(arguments, message, truth, tmp_path, capsys) -> None:
    assert main(["evaluate", truth, estimate(tmp_path, [0.0, 0.0, 2.0]), *arguments]) == (
        1 if "100" in arguments else 2
    )
    err = capsys.readouterr().err
    assert message in err and err.count("\n") == 1


@pytest.mark.parametrize("offset", ["soon", "nan", "inf"])
def test_a_clock_offset_is_a_number_or_a_wish(offset, truth, capsys) -> None:
    assert main(["evaluate", truth, truth, "--clock-offset", offset]) == 2
    assert "takes a number of seconds or the word estimate" in capsys.readouterr().err


def test_files_without_attitude_are_refused(truth, tmp_path, capsys) -> None:
    kreisel.write(tmp_path / "imu.csv", kreisel.ImuRecording(T, np.zeros((N, 3)), np.ones((N, 3))))
    assert main(["evaluate", str(tmp_path / "imu.csv"), truth]) == 1
    assert "is an IMU recording and has no attitude" in capsys.readouterr().err
    assert main(["evaluate", truth, str(tmp_path / "imu.csv")]) == 1
    assert "holds an IMU recording, not attitude" in capsys.readouterr().err


def test_a_person_at_a_terminal_gets_the_same_numbers(truth, tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert main(["evaluate", truth, estimate(tmp_path, [0.0, 0.0, 2.0])]) == 0
    text = capsys.readouterr().out
    total = next(line for line in text.splitlines() if line.lstrip().startswith("total"))
    assert total.split()[1:] == ["2"] * 5


@pytest.fixture
def pairs(tmp_path: Path) -> Path:
    """Truths a, b, c in one folder; estimates a (1 deg off), b (3 deg), x in another."""
    for folder in ("truths", "found"):
        (tmp_path / folder).mkdir()
    for name in "abc":
        kreisel.write(tmp_path / "truths" / f"{name}.tum", kreisel.Poses(T, np.ones((N, 3)), R))
    for name, error in (("a", 1.0), ("b", 3.0), ("x", 0.0)):
        estimate(tmp_path / "found", [0.0, 0.0, error], f"{name}.npz")
    (tmp_path / "truths" / "notes.md").write_text("taken on a Tuesday")
    return tmp_path


@pytest.mark.parametrize("truths", ["truths", "truths/*.tum"])
def test_many_estimates_are_paired_with_truths_by_name(truths, pairs, capsys) -> None:
    arguments = ["evaluate", str(pairs / truths), str(pairs / "found" / "*.npz")]
    # Of x nobody knows the truth, which is bad data; c is a note.
    assert main([*arguments, "--json"]) == 1
    streams = capsys.readouterr()
    found = json.loads(streams.out)
    assert found["schema"] == "kreisel.evaluate-many/1"
    names = [(Path(each["truth"]).name, Path(each["estimate"]).name) for each in found["files"]]
    assert names == [("a.tum", "a.npz"), ("b.tum", "b.npz")]
    assert found["mean"]["heading_rmse_deg"] == pytest.approx(2.0, rel=1e-9)
    assert [Path(each["file"]).name for each in found["failed"]] == ["x.npz"]
    assert [Path(name).name for name in found["truths_without_estimate"]] == ["c.tum"]
    assert "none of" in streams.err and "is called 'x'" in streams.err
    assert "truths without an estimate:" in streams.err and "notes.md" not in streams.err
    assert main(arguments) == 1
    rows = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines()}
    assert rows[str(pairs / "found" / "b.npz")][2:4] == ["3", "3"]
    assert rows["mean"][3:5] == ["2", "2"]


def test_several_estimates_against_one_truth(pairs, capsys) -> None:
    truth = str(pairs / "truths" / "a.tum")
    both = [str(pairs / "found" / f"{name}.npz") for name in "ab"]
    found = report(capsys, truth, *both)
    assert [each["truth"] for each in found["files"]] == [truth] * 2
    assert main(["evaluate", truth, *both, "--max-total-rmse-deg", "2"]) == 3
    assert f"{both[1]}: total RMSE in deg: 3, allowed 2" in capsys.readouterr().err


def test_folders_tell_estimates_of_one_name_apart(tmp_path, capsys) -> None:
    for run, error in (("one", 1.0), ("two", 2.0)):
        for folder in ("truths", "found"):
            (tmp_path / folder / run).mkdir(parents=True)
        turned = exp_so3(np.radians([0.0, 0.0, error])) @ R
        kreisel.write(tmp_path / "truths" / run / "imu.tum", kreisel.Poses(T, np.ones((N, 3)), turned))
        estimate(tmp_path / "found" / run, [0.0, 0.0, error], "imu.npz")
    patterns = [str(tmp_path / folder / "**" / "imu.*") for folder in ("truths", "found")]
    found = report(capsys, *patterns, "-o", str(tmp_path / "out"))
    assert found["mean"]["total_rmse_deg"] < 1e-6
    assert (tmp_path / "out" / "one" / "imu" / "errors.png").is_file()
    assert json.loads((tmp_path / "out" / "summary.json").read_text()) == found
    assert main(["evaluate", patterns[0], str(tmp_path / "found" / "one" / "imu.npz"), "--dry-run"]) == 0
    kreisel.write(tmp_path / "truths" / "one" / "imu.csv", kreisel.AttitudeHistory(T, R))
    assert main(["evaluate", *patterns]) == 1
    assert "imu.npz has several truths" in capsys.readouterr().err


def test_a_dry_run_of_many_writes_nothing(pairs, capsys) -> None:
    out = pairs / "out"
    truths, found = str(pairs / "truths"), str(pairs / "found" / "[ab].npz")
    assert main(["evaluate", truths, found, "-o", str(out), "--dry-run"]) == 0
    text = capsys.readouterr().out
    assert f"would write: {out / 'summary.json'}" in text and str(out / "a" / "errors.png") in text
    assert not out.exists()
    assert main(["evaluate", truths, str(pairs / "none" / "*.npz")]) == 2
    assert "no file fits" in capsys.readouterr().err
