"""Increments on disk: what a table of them looks like, strangers' tables, and mixes that make no sense."""

from dataclasses import replace

import numpy as np
import pytest

import kreisel
from kreisel.data.frames import from_enu_flu, to_enu_flu
from kreisel.simulate.trajectories.lissajous import lissajous

T = np.array([0.0, 0.01, 0.03])
ROWS = np.arange(6.0).reshape(2, 3)
SUMS = kreisel.ImuIncrements(T, 1e-3 * ROWS, 0.1 * ROWS, name="unit")


def csv(folder, text):
    (folder / "theirs.csv").write_text(text)
    return folder / "theirs.csv"


def test_a_row_of_the_table_ends_its_interval(tmp_path):
    kreisel.write(tmp_path / "unit.csv", SUMS)
    header, *rows = (tmp_path / "unit.csv").read_text().splitlines()
    assert header == "t [s],dtheta_x [rad],dtheta_y [rad],dtheta_z [rad],dv_x [m/s],dv_y [m/s],dv_z [m/s]"
    assert rows[0] == "0.0,nan,nan,nan,nan,nan,nan"
    assert rows[1] == "0.01,0.0,0.001,0.002,0.0,0.1,0.2"


W = 2.0 * np.pi
CASES = {
    "A": lissajous(),
    "B": kreisel.FunctionTrajectory(
        [lambda t: 0.8 * np.cos(W * t), lambda t: 0.8 * np.sin(W * t), lambda t: 0.3 * np.cos(3 * W * t)],
        [lambda t: 0.8 * np.cos(W * t), lambda t: 0.8 * np.sin(W * t), lambda t: 0.3 * np.cos(W * t)],
    ),
}


@pytest.mark.parametrize("case", "AB")
@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_the_trajectory_comes_back_from_a_file(case, suffix, tmp_path):
    """The goal: 1e-11 m and 1e-12 rad over 5 s at 200 Hz; measured 3e-13 and 6e-15."""
    t = np.arange(1001) / 200.0
    path, mount = CASES[case], kreisel.Mount([-0.075, -0.075, 0.025])
    body = replace(path.sample(t), t0_ns=1_700_000_000_000_000_000)
    kreisel.write(tmp_path / f"unit.{suffix}", kreisel.Imu(mount).increments(body))
    errors = kreisel.round_trip(kreisel.read(tmp_path / f"unit.{suffix}"), body.at(mount))
    assert errors.position.max() < 1e-11
    assert errors.attitude.max() < 1e-12


def test_an_epoch_is_kept_to_the_nanosecond(tmp_path):
    later = kreisel.ImuIncrements(T, SUMS.dtheta, SUMS.dv, t0_ns=1_700_000_000_123_456_789)
    kreisel.write(tmp_path / "unit.csv", later)
    assert "1700000000133456789," in (tmp_path / "unit.csv").read_text()
    back = kreisel.read(tmp_path / "unit.csv")
    assert back.t0_ns == later.t0_ns
    assert back.t.tobytes() == T.tobytes()


def test_others_units_and_names(tmp_path):
    text = "time [ms],delta_angle_x [arcsec],delta_angle_y [deg],delta_angle_z [urad],"
    text += "delta_velocity_x [mm/s],delta_velocity_y,delta_velocity_z\n0,,,,,,\n10,3600,1,1000,20,0,0.1\n20,,,,,,\n"
    read = kreisel.read(csv(tmp_path, text))
    np.testing.assert_allclose(read.dtheta[0], [np.pi / 180.0, np.pi / 180.0, 1e-3], rtol=1e-15)
    np.testing.assert_allclose(read.dv[0], [0.02, 0.0, 0.1], rtol=1e-15)
    # An interval that is lost.
    assert np.isnan(read.dtheta[1]).all() and np.isnan(read.dv[1]).all()
    assert read.dp is None


HEAD = "t,dtheta_x,dtheta_y,dtheta_z,dv_x,dv_y,dv_z"
RATES = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{HEAD}\n0.01,0,0,0,0,0,0.1\n0.02,0,0,0,0,0,0.1\n", "line 2, .*first row is where the first interval begins"),
        ("t,dtheta_x,dtheta_y,dtheta_z\n0,,,\n1,0,0,0\n", "no column dv_x"),
        ("t,dv_x,dv_y,dv_z\n0,,,\n1,0,0,0\n", "no column dtheta_x"),
        ("t,gyro_x,gyro_y,gyro_z,dv_x,dv_y,dv_z\n0,0,0,0,,,\n1,0,0,0,0,0,0\n", "no column accel_x.* or increments"),
        ("t,dtheta_x,dtheta_y,dv_x,dv_y,dv_z\n0,,,,,\n1,0,0,0,0,0\n", "no column dtheta_z"),
        (f"{HEAD},{RATES}\n0{',' * 6}{',0' * 6}\n", "both IMU data and increments. .* kind='imu' or"),
        (f"{HEAD},p_x,p_y,p_z\n0{',' * 6}{',0' * 3}\n", "both positions and increments. .* kind='poses' or"),
        (f"{HEAD}\n0,,,,,,\n0,0,0,0,0,0,0\n", "stands still"),
        (f"{HEAD}\n0,,,,,,\n1,0,0,inf,0,0,0\n", "inf"),
        ("t,dtheta_x [m],dtheta_y,dtheta_z,dv_x,dv_y,dv_z\n0,,,,,,\n1,0,0,0,0,0,0\n", "'m' is no unit of angle"),
    ],
)  # fmt: skip
def test_a_table_that_makes_no_sense_is_refused(text, message, tmp_path):
    path = csv(tmp_path, text)
    with pytest.raises(ValueError, match=message) as caught:
        kreisel.read(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_of_rates_and_increments_the_kind_decides(tmp_path):
    text = f"{HEAD},{RATES}\n0{',' * 6}{',1' * 6}\n1{',2' * 6}{',1' * 6}\n"
    path = csv(tmp_path, text)
    np.testing.assert_array_equal(kreisel.read(path, kind="imu").gyro, np.ones((2, 3)))
    np.testing.assert_array_equal(kreisel.read(path, kind="increments").dtheta, [[2.0, 2.0, 2.0]])


def test_asked_for_as_an_imu_they_are_mean_rates(tmp_path):
    kreisel.write(tmp_path / "unit.npz", SUMS)
    rates = kreisel.read(tmp_path / "unit.npz", kind="imu")
    np.testing.assert_array_equal(rates.t, T[1:])
    np.testing.assert_array_equal(rates.gyro, SUMS.dtheta / np.diff(T)[:, None])
    np.testing.assert_array_equal(rates.accel, SUMS.dv / np.diff(T)[:, None])
    with pytest.raises(ValueError, match="holds IMU increments, not poses"):
        kreisel.read(tmp_path / "unit.npz", kind="poses")
    kreisel.write(tmp_path / "rates.npz", rates)
    with pytest.raises(ValueError, match="holds an IMU recording, not IMU increments"):
        kreisel.read(tmp_path / "rates.npz", kind="increments")


def test_a_strangers_box_of_arrays(tmp_path):
    np.savez(tmp_path / "x.npz", time=T, delta_theta=ROWS, delta_v=ROWS)
    np.testing.assert_array_equal(kreisel.read(tmp_path / "x.npz").dv, ROWS)
    np.savez(tmp_path / "x.npz", fs=100.0, dtheta=ROWS, dv=ROWS)
    np.testing.assert_array_equal(kreisel.read(tmp_path / "x.npz").t, [0.0, 0.01, 0.02])
    np.savez(tmp_path / "x.npz", t=T[1:], dtheta=ROWS, dv=ROWS)
    with pytest.raises(
        ValueError, match=r"x\.npz: dtheta must have one row fewer than t.*2 rows for 2 stamps"
    ):
        kreisel.read(tmp_path / "x.npz")


def test_tables_of_pandas_and_xarray():
    pandas = pytest.importorskip("pandas", reason="pandas is not installed: pip install kreisel[data]")
    pytest.importorskip("xarray", reason="xarray is not installed: pip install kreisel[data]")
    frame = SUMS.to_pandas()
    assert frame.attrs["units"]["dv_x"] == "m/s"
    assert frame.loc[0.0].isna().all()
    assert frame.loc[0.03, "dtheta_z"] == SUMS.dtheta[1, 2]
    assert isinstance(frame, pandas.DataFrame)
    dataset = SUMS.to_xarray()
    assert dataset["dtheta"].dims == ("interval", "axis")
    np.testing.assert_array_equal(dataset["dv"].values, SUMS.dv)


def test_a_parquet_table_of_pandas_is_read(tmp_path):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: pip install kreisel[data]")
    pytest.importorskip("pandas", reason="pandas is not installed: pip install kreisel[data]")
    frame = SUMS.to_pandas().reset_index()
    frame.attrs = {}
    frame.to_parquet(tmp_path / "unit.parquet")
    np.testing.assert_array_equal(kreisel.read(tmp_path / "unit.parquet").dtheta, SUMS.dtheta)


@pytest.mark.parametrize("world", ["ned-frd", "matlab", "nwu"])
def test_another_world_integrates_to_the_same_motion(world):
    motion = lissajous().sample(np.arange(50) / 200.0)
    sums = kreisel.Imu().increments(motion)
    theirs = from_enu_flu(sums, world)
    sign = -1.0 if world == "matlab" else 1.0
    np.testing.assert_array_equal(from_enu_flu(sums.mean_rates(), world).accel, theirs.mean_rates().accel)
    np.testing.assert_array_equal(theirs.dp[:, 0], sign * sums.dp[:, 0])
    back = to_enu_flu(theirs, world)
    for name in ("dtheta", "dv", "dp"):
        assert getattr(back, name).tobytes() == getattr(sums, name).tobytes()
