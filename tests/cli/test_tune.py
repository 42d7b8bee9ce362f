"""`kreisel tune` reads recordings as `kreisel estimate` does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main

T = np.arange(0.0, 2.0, 0.01)


@pytest.fixture
def pair(tmp_path) -> str:
    """A recording and its truth, as the command takes them."""
    motion = kreisel.figure_eight(period=8.0).sample(T)
    kreisel.write(tmp_path / "imu.csv", kreisel.Imu().ideal(motion))
    kreisel.write(tmp_path / "truth.tum", kreisel.Poses(motion.t, motion.p_NB, motion.R_NB))
    return f"{tmp_path / 'imu.csv'}={tmp_path / 'truth.tum'}"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda imu: {"accel": imu.accel / 9.80665}, "looks like g"),
        (lambda imu: {"gyro": np.full_like(imu.gyro, np.nan)}, "no reading of the gyroscope"),
    ],
)
def test_what_no_filter_can_use_is_refused(change, said, pair, tmp_path, capsys) -> None:
    imu = kreisel.read(tmp_path / "imu.csv")
    kreisel.write(tmp_path / "imu.csv", replace(imu, **change(imu)))
    assert main(["tune", pair, "--vary", "accel_time"]) == 1
    err = capsys.readouterr().err
    assert said in err and err.count("\n") == 1


def test_a_place_that_cannot_be_written_is_told_before_the_search(pair, tmp_path, capsys) -> None:
    assert main(["tune", pair, "-o", str(tmp_path / "nowhere" / "f.toml")]) == 1
    assert "does not exist. Create it first." in capsys.readouterr().err
