"""`kreisel run` as a user runs it: the examples, a dry run, and files that cannot be run."""

import json
from pathlib import Path

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.files.doors import read

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples" / "scenarios").glob("*.toml"))

CIRCLE = """
name = "a circle"
duration = 4.0
rate_hz = 50.0
[trajectory]
kind = "circle"
[[imu]]
name = "nose"
p_BS = [0.5, 0.0, 0.0]
[environment]
field_N_uT = [0.0, 20.0, -44.0]
"""


@pytest.fixture
def circle(tmp_path):
    path = tmp_path / "circle.toml"
    path.write_text(CIRCLE)
    return path


def test_a_scenario_becomes_a_folder(circle, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["run", str(circle), "-o", str(out)]) == 0
    text = capsys.readouterr().out
    names = {path.name for path in out.iterdir()}
    assert names == {
        *("nose.csv", "truth.tum", "truth.npz", "report.json"),
        *("path.png", "linear.png", "angular.png", "nose.png"),
    }
    assert all(name in text for name in names)
    assert "a circle: circle, 201 samples from 0 to 4 s" in text
    assert "dip 65.6 deg" in text  # atan(44 / 20)
    nose = read(out / "nose.csv", kind="imu")
    rate = np.pi / 2.0
    # rate^2 times radius to the left and the lever arm to the rear; the csv keeps every digit.
    expected = [-0.5 * rate**2, rate**2, 9.80665]
    np.testing.assert_allclose(nose.accel, np.tile(expected, (201, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(nose.mag_uT, axis=1), np.hypot(20.0, 44.0), rtol=1e-14)
    assert json.loads((out / "report.json").read_text())["schema"] == "kreisel.run/1"


def test_a_disturbed_place_is_told_and_its_truth_written(tmp_path, capsys):
    example = next(path for path in EXAMPLES if path.stem == "past_iron")
    assert main(["run", str(example), "-o", str(tmp_path), "--no-pictures"]) == 0
    told = capsys.readouterr().out
    assert "at 48.14 N, 11.58 E, 520 m on 2026-05-01: gravity 9.80743 m/s^2; N turns with the Earth" in told
    assert "filters are told a declination of 4.31 deg" in told
    assert "disturbed by: dipole, step, drift" in told
    errors = {
        e["filter"]: e["errors"] for e in json.loads((tmp_path / "report.json").read_text())["estimates"]
    }
    # Declination is 4.3 deg; who is not told it is that much off, whatever the disturbances do.
    assert errors["dcm"]["heading_rmse_deg"] < 2.0 < 4.0 < errors["compass north"]["heading_rmse_deg"]
    with np.load(tmp_path / "phone-errors.npz") as truth:
        added = np.linalg.norm(truth["disturbance_N_uT"], axis=1)
    # Past the loudspeaker the field is 7 uT off, and most of the time by a little of the drift.
    assert 5.0 < added.max() < 10.0 and np.median(added) < 2.0


def test_the_gyro_bias_is_drawn_over_the_true_one(tmp_path, monkeypatch, capsys):
    from kreisel import show

    path, drawn = tmp_path / "noisy.toml", []
    filter = '[[filter]]\nkind = "dcm"\nalign = "heading"\n'
    sensors = '[[imu]]\nname = "real"\nsensor = "bmi088"\n[[imu]]\nname = "perfect"\n'
    path.write_text(CIRCLE.partition("[[imu]]")[0] + sensors + filter)
    plot = show.plot_bias
    monkeypatch.setattr(show, "plot_bias", lambda e, truth: drawn.append((e, truth)) or plot(e, truth))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    for name in ("real", "perfect"):
        assert (tmp_path / "out" / f"attitude-{name}-dcm-bias.png").exists()
    (real, bias), (_, none) = drawn
    known = np.load(tmp_path / "out" / "real-errors.npz")
    assert bias.shape == real.gyro_bias.shape and np.abs(bias).max() > 0.0
    np.testing.assert_array_equal(bias, known["gyro_bias"])
    assert not none.any()
    assert "real, dcm, removed: heading offset of" in capsys.readouterr().out


def test_a_gyroscope_that_warms_up_loses_the_heading_and_its_twin_does_not(tmp_path, capsys):
    example = next(path for path in EXAMPLES if path.stem == "warm_up")
    assert main(["run", str(example), "-o", str(tmp_path), "--no-pictures"]) == 0
    assert "warming, temperature: 15 deg C at 0 s to 40 deg C at 120 s" in capsys.readouterr().out
    report = json.loads((tmp_path / "report.json").read_text())
    heading = {(e["imu"], e["filter"]): e["errors"]["heading_rmse_deg"] for e in report["estimates"]}
    for filter in ("dcm", "mekf"):
        assert heading["thermostat", filter] < 1.0 < 5.0 < heading["warming", filter]
    with np.load(tmp_path / "warming-errors.npz") as terms:
        bias, warmer = terms["gyro_bias"], terms["temperature_degC"] - 15.0
        expected = np.deg2rad([0.2, -0.1, 0.3] + warmer[:, None] * [0.01, -0.005, 0.02])
        # g-sensitivity counts as no bias: it changes with the attitude.
        np.testing.assert_allclose(bias, expected, atol=1e-12)
        assert np.ptp(terms["gyro_error_g_sensitivity"], axis=0).all()


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(path, tmp_path, capsys):
    assert main(["run", str(path), "-o", str(tmp_path), "--no-pictures"]) == 0
    text = capsys.readouterr().out
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["estimates"]
    for estimate in report["estimates"]:
        stem = f"attitude-{estimate['imu']}-{estimate['filter']}".replace(" ", "-")
        assert f"{stem}.tum" in text
        assert (tmp_path / f"{stem}.npz").exists()
        assert estimate["errors"]["samples"] == report["samples"]
        # Noise-free: once it has found down, no filter loses it by more than the swing of figure 1 explains.
        assert estimate["errors"]["inclination_median_deg"] < 10.0


def test_a_dry_run_writes_nothing(circle, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", str(circle), "--dry-run"]) == 0
    assert "201 samples from 0 to 4 s" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == [circle]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("rate_hz", "rate_Hz"), "rate_Hz is unknown; did you mean 'rate_hz'?"),
        (('kind = "circle"', 'kind = "circle"\nradius = "1"'), "trajectory.radius must be a number"),
        (
            ('kind = "circle"', 'kind = "expressions"\nposition = ["__import__(\'os\')", 0, 0]'),
            "position[0], column 12",
        ),
        (('"nose"', '"truth"'), "an IMU cannot be called 'truth'"),
        (('"nose"', '"report"\n[[imu]]\nname = "Report"'), "two files would be called 'Report.csv'"),
        (("duration", "[duration"), "is not TOML"),
    ],
)
@pytest.mark.parametrize("dry", [True, False])
def test_bad_scenarios_end_in_one_line_and_exit_code_1(change, message, dry, circle, tmp_path, capsys):
    circle.write_text(CIRCLE.replace(*change))
    out = tmp_path / "out"
    assert main(["run", str(circle), *(["--dry-run"] if dry else ["-o", str(out)])]) == 1
    err = capsys.readouterr().err
    assert err.startswith("kreisel: ")
    assert err.count("\n") == 1
    assert message in err
    assert not out.exists()


def test_somewhere_to_write_is_needed(circle, capsys):
    assert main(["run", str(circle)]) == 2
    assert "-o FOLDER" in capsys.readouterr().err


def test_a_scenario_that_is_not_there_is_named(capsys):
    assert main(["run", "nowhere.toml", "--dry-run"]) == 1
    assert "cannot read nowhere.toml" in capsys.readouterr().err
