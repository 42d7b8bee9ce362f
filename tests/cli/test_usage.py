"""Exit codes: 2 for what was typed, whatever the files hold; 1 for what the files hold; one sentence either way."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel import discovery
from kreisel.cli.main import COMMANDS, main
from kreisel.cli.values import UsageError, number, one_of, whole


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    """A folder with a recording, poses and a scenario."""
    monkeypatch.chdir(tmp_path)
    t = np.arange(50) / 50.0
    kreisel.write("imu.csv", kreisel.ImuRecording(t, np.zeros((50, 3)), np.tile([0.0, 0.0, 9.8], (50, 1))))
    kreisel.write("poses.csv", kreisel.Poses(t, np.zeros((50, 3)), np.tile(np.eye(3), (50, 1, 1))))
    Path("scene.toml").write_text("duration = 1\nrate_hz = 50\n[trajectory]\nkind = 'rest'\n")
    return tmp_path


MISTYPED = [
    ("info imu.csv --frame nde", "--frame must be one of", "Did you mean 'ned-frd'?"),
    ("info imu.csv --from cvs", "--from must be one of", "'csv'"),
    ("info imu.csv --kind pose", "--kind must be one of", "'poses'"),
    ("info imu.csv --column t", "--column takes NAME=HEADER", ""),
    ("info imu.csv --column gyrox=a", "NAME of --column must be one of", "gyro_x"),
    ("info imu.csv --column t=t[parsec]", "--column t: 'parsec' is no unit of time", ""),
    ("info imu.csv --input-rate abc", "--input-rate must be a number of hertz above 0; got 'abc'", ""),
    ("info imu.csv --input-rate -5", "--input-rate must be", ""),
    ("convert imu.csv out.xyz", "cannot tell the format of out.xyz from its suffix", ""),
    ("convert imu.csv out.csv --to ccsv", "--to must be one of", "'csv'"),
    ("convert imu.csv out.csv --to-frame rso", "--to-frame must be one of", "'ros'"),
    ("simulate poses.csv -o out --seed -7", "--seed must be a whole number, 0 or more; got '-7'", ""),
    ("simulate poses.csv -o out --seed 1.5", "--seed must be a whole number", ""),
    ("simulate poses.csv -o out --rate abc", "--rate must be a number of hertz above 0; got 'abc'", ""),
    ("simulate poses.csv -o out --rate nan", "--rate must be a number", ""),
    ("simulate poses.csv -o out --rate inf", "--rate must be a number", ""),
    ("simulate poses.csv -o out --sensor bmi08", "--sensor must be one of", "'bmi088'"),
    ("simulate poses.csv -o out --imu bmi08", "must be one of", "'bmi088'"),
    ("simulate poses.csv -o out --imu bmi08@0,0,0", "must be one of", "'bmi088'"),
    ("simulate poses.csv -o out --imu 1,2", "--imu takes", ""),
    ("simulate poses.csv -o out --as waypoint", "--as must be one of", "'waypoints'"),
    ("simulate poses.csv -o out --method smoth", "--method must be one of", "'smooth'"),
    ("simulate poses.csv -o out --orientation level", "--orientation must be one of 'tangent'", ""),
    ("simulate poses.csv -o out --noise 0.1", "--noise takes numbers with their unit", ""),
    ("simulate poses.csv -o out --max-gap -1", "--max-gap must be a number of seconds, 0 or more", ""),
    ("simulate poses.csv -o out --imu-format cvs", "--imu-format must be one of", "'csv'"),
    ("simulate poses.csv -o out --place 91,0", "--place: latitude_deg", ""),
    ("simulate poses.csv -o out --place x", "--place takes LAT,LON", ""),
    ("simulate poses.csv -o out --date 2026-05-01", "--date says nothing without a place", ""),
    ("simulate poses.csv -o out --as waypoints", "needs a sampling rate", ""),
    ("simulate poses.csv -o out --closed", "--closed does not apply to poses", ""),
    ("simulate w.csv -o out --as waypoints --rate 9 --max-speed 0", "--max-speed must be", ""),
    ("simulate w.csv -o out --as waypoints --rate 9 --minimum jrek", "--minimum must be one of", "'jerk'"),
    ("simulate w.csv -o out --as profile --rate 9 --ramp 0", "--ramp must be", ""),
    ("estimate imu.csv --filter mefk", "--filter must be one of", "'mekf'"),
    ("estimate imu.csv --mode 7", "--mode must be one of", ""),
    ("estimate imu.csv --set accel_tim=3", "accel_tim is unknown", "'accel_time'"),
    ("estimate imu.csv --set accel_time", "--set takes NAME=VALUE", ""),
    ("estimate imu.csv --declination-deg 400", "--declination-deg must be", ""),
    ("estimate imu.csv --to tmu", "--to must be one of", "'tum'"),
    ("estimate imu.csv -o a.tmu", "cannot tell the format of a.tmu", "'.tum'"),
    ("estimate imu.csv --smooth", "--smooth needs a filter that keeps a covariance", ""),
    ("estimate nothing*.csv", "no file fits 'nothing*.csv'", ""),
    ("evaluate poses.csv poses.csv --align headng", "--align must be one of", "'heading'"),
    ("evaluate poses.csv poses.csv --limit-deg 0", "--limit-deg must be", ""),
    ("evaluate poses.csv poses.csv --clock-offset soon", "--clock-offset takes a number of seconds", ""),
    ("evaluate poses.csv poses.csv --max-total-rmse-deg -1", "--max-total-rmse-deg must be", ""),
    ("evaluate poses.csv poses.csv --imu 1", "--imu takes", ""),
    ("compare imu.csv poses.csv --estimate lever", "--estimate must be one of", "'lever_arm'"),
    ("compare imu.csv poses.csv --search -1", "--search must be", ""),
    ("compare imu.csv poses.csv --pose-rate 0", "--pose-rate must be", ""),
    ("compare imu.csv poses.csv --method smoth", "--method must be one of", "'smooth'"),
    ("compare imu.csv poses.csv --imu 1", "--imu takes", ""),
    ("compare imu.csv poses.csv --max-gyro-rmse none", "--max-gyro-rmse must be", ""),
    ("calibrate imu.csv -o c.toml --gravity 981", "--gravity must be", ""),
    ("calibrate imu.csv -o c.toml --apply d.toml --mag", "belongs to a calibration", ""),
    ("allan imu.csv --start never", "--start must be", ""),
    ("tune a.csv=", "two files, IMU=TRUTH", ""),
    ("estimate imu.csv --picture a.xyz", "--picture must end in .png", ""),
    ("estimate imu.csv b.csv -o out/ --backend foo://here:1", "--backend must be 'dask'", ""),
    ("montecarlo s.toml -o out/ --backend foo://here:1", "--backend must be 'dask'", ""),
    ("tune a b c --score totl", "--score must be one of", "'total'"),
    ("tune a b c --draws 0", "--draws must be a whole number, 1 or more", ""),
    ("tune a b c --vary accel_tim", "--vary must be one of", "'accel_time'"),
    ("bench broad . --filter dmc", "--filter must be one of", "'dcm'"),
    ("sensors bmi08", "SENSOR must be one of", "'bmi088'"),
    ("sensors bmi088 --kalibr x.yaml --gyro-walk -1", "--gyro-walk must be", ""),
    ("sensors bmi088 --kalibr x.yaml --rate 0", "--rate must be", ""),
    ("live --rate 0", "--rate must be", ""),
    ("live --gyro-unit rpm", "--gyro-unit: 'rpm' is no unit of rate", ""),
    ("live --to tmu -o x", "--to must be one of", "'tum'"),
]


@pytest.mark.parametrize(("line", "said", "meant"), MISTYPED, ids=[line for line, _, _ in MISTYPED])
def test_what_was_typed_wrong_is_one_sentence_and_2(here, capsys, line, said, meant) -> None:
    assert main(line.split()) == 2
    streams = capsys.readouterr()
    assert streams.out == "" and streams.err.count("\n") == 1
    assert streams.err.startswith("kreisel: ") and said in streams.err and meant in streams.err
    assert sorted(path.name for path in here.iterdir()) == ["imu.csv", "poses.csv", "scene.toml"]


IN_FILES = [
    ("kind = 'rest'", "kind = 'rset'", "did you mean 'rest'"),
    ("duration = 1", "duration = -1", "duration"),
    ("rate_hz = 50", "rate_hz = 'abc'", "rate_hz"),
]


@pytest.mark.parametrize(("sound", "broken", "said"), IN_FILES)
def test_what_a_file_has_wrong_is_1(here, capsys, sound, broken, said) -> None:
    scene = Path("scene.toml")
    scene.write_text(scene.read_text().replace(sound, broken))
    assert main(["run", "scene.toml", "--dry-run"]) == 1
    assert said in capsys.readouterr().err


def test_every_option_with_a_value_has_its_reader() -> None:
    """A bare float or int would let nan and negative rates pass, and say "invalid float value" of the rest."""
    for command in discovery.names(COMMANDS):
        parser = ArgumentParser(prog=command)
        discovery.load(COMMANDS, command).configure(parser)
        bare = [action.option_strings for action in parser._actions if action.type in (int, float)]
        assert not bare, command


def test_the_readers_hold_their_bounds() -> None:
    assert number("s", above=0.0)("1e-9") == 1e-9 and whole(1)("1") == 1 and one_of(["a"])("a") == "a"
    for read, text in (
        (number("s", above=0.0), "0"),
        (number("s", lowest=0.0, highest=1.0), "1.1"),
        (number(), "inf"),
        (whole(1), "0"),
        (one_of(lambda: ["abc"]), "abd"),
    ):
        with pytest.raises(UsageError):
            read(text)
    # argparse shows the sentence of these, and calls every other ValueError an "invalid value".
    assert issubclass(UsageError, ArgumentTypeError)
