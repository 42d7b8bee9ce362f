"""`kreisel allan`: a file at rest in, a table, pictures and numbers out."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main

T = np.arange(5000) / 100.0
FIELD = kreisel.Environment(field_N_uT=[0.0, 20.0, -40.0])


@pytest.fixture
def rest(tmp_path: Path) -> str:
    white = np.random.default_rng(4).standard_normal((2, 5000, 3))
    accel = 9.80665e-3 * white[1] + [0.0, 0.0, 9.80665]
    kreisel.write(tmp_path / "rest.csv", kreisel.ImuRecording(T, np.deg2rad(0.1) * white[0], accel))
    return str(tmp_path / "rest.csv")


def test_the_table_speaks_the_units_of_datasheets(rest, capsys) -> None:
    assert main(["allan", rest]) == 0
    text = capsys.readouterr().out
    rows = {line[:20].strip() + line[20:].split()[0]: line for line in text.splitlines() if "sqrt" in line}
    # 0.1 deg/s and 1 mg at 100 Hz: 0.01 deg/s/sqrt(Hz) and 100 ug/sqrt(Hz).
    numbers = [float(rows[f"white noise N{unit}"].split()[4]) for unit in ("deg/s/sqrt(Hz)", "ug/sqrt(Hz)")]
    np.testing.assert_allclose(numbers, [0.01, 100.0], rtol=0.03)
    assert "5000 samples" in text and "<" in rows["random walk Kug/sqrt(s)"]


def test_json_is_si_and_the_folder_has_pictures(rest, tmp_path, capsys) -> None:
    out = tmp_path / "noise"
    assert main(["allan", rest, "--sensor", "gyro", "-o", str(out), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["schema"] == "kreisel.allan/1" and list(report["sensors"]) == ["gyro"]
    np.testing.assert_allclose(report["sensors"]["gyro"]["N"]["value"], np.deg2rad(0.01), rtol=0.03)
    assert report["sensors"]["gyro"]["K"]["value"] == [None] * 3
    assert json.loads((out / "allan.json").read_text()) == report
    assert {p.name for p in out.iterdir()} == {"allan.json", "allan_gyro.png", "preset.toml"}


def test_what_was_read_is_a_sensor_to_simulate(rest, tmp_path) -> None:
    assert main(["allan", rest, "-o", str(tmp_path / "noise")]) == 0
    imu = kreisel.Imu.from_preset(tmp_path / "noise" / "preset.toml")
    again = kreisel.allan(imu.record(kreisel.rest().sample(T), 5).measured)
    np.testing.assert_allclose(again.N.value, np.deg2rad(0.01), rtol=0.05)


def test_a_gap_is_one_line_and_exit_code_one(rest, tmp_path, capsys) -> None:
    lines = Path(rest).read_text().splitlines()
    (tmp_path / "gap.csv").write_text("\n".join(lines[:100] + lines[110:]))
    assert main(["allan", str(tmp_path / "gap.csv")]) == 1
    err = capsys.readouterr().err
    assert "even steps" in err and err.count("\n") == 1
    # What the message says to take is taken.
    first, last = err.split("runs from ")[1].split(" s after")[0].split(" to ")
    assert (first, last) == ("1.09", "49.99")
    assert main(["allan", str(tmp_path / "gap.csv"), "--start", first, "--end", last]) == 0
    assert "4891 samples" in capsys.readouterr().out
    assert main(["allan", str(tmp_path / "gap.csv"), "--start", "90"]) == 1
    assert "leave no sample; the recording lasts 49.99 s" in capsys.readouterr().err


def test_a_slow_magnetometer_has_its_own_rate_and_unit(tmp_path, capsys) -> None:
    rng = np.random.default_rng(8)
    mag = np.full((20000, 3), np.nan)
    mag[::4] = 0.5 * rng.standard_normal((5000, 3)) + [0.0, 20.0, -40.0]
    noise = 1e-3 * rng.standard_normal((2, 20000, 3))
    path = tmp_path / "rest.npz"
    kreisel.write(path, kreisel.ImuRecording(np.arange(20000) / 100.0, noise[0], noise[1] + 9.8, mag))
    assert main(["allan", str(path), "--sensor", "mag", "-o", str(tmp_path / "noise")]) == 0
    text = capsys.readouterr().out
    assert "5000 samples" in text and "25 Hz" in text
    row = next(line for line in text.splitlines() if "uT/sqrt(Hz)" in line)
    # 0.5 uT at 25 Hz.
    assert float(row.split()[4]) == pytest.approx(0.1, rel=0.05)
    assert (tmp_path / "noise" / "allan_mag.png").stat().st_size > 10_000
    effects = kreisel.Imu.from_preset(tmp_path / "noise" / "preset.toml", environment=FIELD).mag_effects
    assert any(type(effect).__name__ == "WhiteNoise" for effect in effects)
    assert main(["allan", str(path), "--sensor", "all", "--json", "--quiet"]) == 0
    assert list(json.loads(capsys.readouterr().out)["sensors"]) == ["gyro", "accel", "mag"]
    kreisel.write(path, kreisel.ImuRecording(np.arange(99) / 100.0, np.zeros((99, 3)), np.full((99, 3), 9.8)))
    assert main(["allan", str(path), "--sensor", "mag"]) == 1
    assert "has no magnetometer" in capsys.readouterr().err
