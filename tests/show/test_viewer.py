"""The recording for the Rerun viewer, read back with Rerun's own reader."""

import sys

import numpy as np
import pytest

import kreisel
from kreisel import show
from kreisel.cli.main import main

EPOCH_NS = 1_700_000_000_123_456_789
T = np.arange(40) * 0.01


def rest(t0_ns=EPOCH_NS):
    still = kreisel.rest(position=[1, 2, 3]).sample(T)
    return kreisel.Poses(still.t, still.p_NB, still.R_NB, t0_ns=t0_ns)


def test_the_file_holds_body_and_readings_at_their_times(tmp_path):
    pytest.importorskip("rerun", reason="rerun-sdk is not installed: pip install kreisel[rerun]")
    from rerun.chunk import RrdReader

    mount = kreisel.Mount(p_BS=[0.1, 0.0, 0.0], name="left wrist")
    motion = kreisel.lissajous().sample(T)
    recording = kreisel.Imu(mount).ideal(motion)
    estimate = kreisel.AttitudeHistory(T, motion.R_NB)
    show.save_rerun(tmp_path / "a.rrd", motion, [mount], [recording], estimate)
    chunks = list(RrdReader(tmp_path / "a.rrd").stream())
    moving = {chunk.entity_path: chunk.to_record_batch() for chunk in chunks if not chunk.is_static}
    assert set(moving) == {"/world/body", "/world/estimate", r"/left\ wrist/gyro", r"/left\ wrist/accel"}
    body, accel = moving["/world/body"], moving[r"/left\ wrist/accel"]
    seconds = body["t"].cast("int64").to_numpy() / 1e9
    np.testing.assert_allclose(seconds, T, rtol=0.0, atol=1e-9)  # nanoseconds
    p = np.array(body["Transform3D:translation"].to_pylist()).reshape(-1, 3)
    np.testing.assert_allclose(p, motion.p_NB, rtol=1e-6, atol=1e-7)  # float32
    np.testing.assert_array_equal(accel["Scalars:scalars"].to_pylist(), recording.accel)
    assert any(chunk.entity_path == r"/world/body/left\ wrist" for chunk in chunks)


def test_the_command_line_writes_it(tmp_path, capsys):
    rerun = pytest.importorskip("rerun", reason="rerun-sdk is not installed: pip install kreisel[rerun]")
    assert rerun
    kreisel.write(tmp_path / "poses.csv", rest())
    options = ["-o", str(tmp_path), "--no-pictures", "--rerun"]
    assert main(["simulate", str(tmp_path / "poses.csv"), *options]) == 0
    assert (tmp_path / "motion.rrd").read_bytes().startswith(b"RRF")


def test_without_rerun_the_command_that_installs_it_is_named_before_anything_is_written(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ValueError, match=r"pip install 'kreisel\[rerun\]'"):
        show.save_rerun(tmp_path / "a.rrd", kreisel.lissajous().sample(T))
    kreisel.write(tmp_path / "poses.csv", rest())
    assert main(["simulate", str(tmp_path / "poses.csv"), "-o", str(tmp_path / "out"), "--rerun"]) == 1
    assert "pip install 'kreisel[rerun]'" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["poses.csv"]
