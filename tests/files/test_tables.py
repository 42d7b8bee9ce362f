"""HDF5, netCDF and Parquet as others write and read them."""

import sys

import numpy as np
import pytest

import kreisel

T = np.arange(20) * 0.01
IMU = kreisel.ImuRecording(
    T, np.ones((20, 3)), np.full((20, 3), 9.8), t0_ns=1_700_000_000_000_000_001, name="wrist"
)


def test_units_and_frames_are_beside_the_numbers(tmp_path):
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: pip install kreisel[data]")
    parquet = pytest.importorskip("pyarrow.parquet", reason="no pyarrow: pip install kreisel[data]")
    kreisel.write(tmp_path / "a.h5", IMU)
    kreisel.write(tmp_path / "a.parquet", IMU)
    with h5py.File(tmp_path / "a.h5") as file:
        assert (file["gyro"].attrs["units"], file["gyro"].attrs["frame"]) == ("rad/s", "S")
    schema = parquet.read_schema(tmp_path / "a.parquet")
    assert schema.field("accel_z").metadata == {b"unit": b"m/s^2", b"frame": b"S"}
    assert schema.metadata[b"t0_ns"] == b"1700000000000000001"


def test_xarray_opens_what_to_xarray_gives(tmp_path):
    xarray = pytest.importorskip("xarray", reason="xarray is not installed: pip install kreisel[data]")
    pytest.importorskip("h5netcdf", reason="h5netcdf is not installed: pip install kreisel[data]")
    kreisel.write(tmp_path / "a.nc", IMU)
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as dataset:
        assert dataset.attrs.pop("kreisel_schema").startswith("ImuRecording")
        assert dataset.load().identical(IMU.to_xarray())


def test_a_strangers_hdf5_is_read_by_its_names(tmp_path):
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: pip install kreisel[data]")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["time"], file["acc"], file["gyr"] = T, IMU.accel, IMU.gyro
        file["comment"] = "a text"
        file.create_group("more")["acc"] = 0
    data = kreisel.read(tmp_path / "a.h5")
    np.testing.assert_array_equal(data.accel, IMU.accel)
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["comment"] = "a text"
    with pytest.raises(ValueError, match=r"b\.h5: needs positions"):
        kreisel.read(tmp_path / "b.h5")


def test_a_strangers_netcdf_of_version_3_is_read_by_its_names(tmp_path):
    from scipy.io import netcdf_file

    with netcdf_file(tmp_path / "a.nc", "w") as file:
        file.createDimension("t", 20)
        file.createDimension("axis", 3)
        for name, dimensions, values in (("t", ("t",), T), ("position", ("t", "axis"), IMU.gyro)):
            file.createVariable(name, "d", dimensions)[:] = values
    np.testing.assert_array_equal(kreisel.read(tmp_path / "a.nc").p_NB, IMU.gyro)


def test_a_strangers_parquet_is_read_as_a_csv_would_be(tmp_path):
    pandas = pytest.importorskip("pandas", reason="pandas is not installed: pip install kreisel[data]")
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: pip install kreisel[data]")
    names = ["time [ms]", *(f"gyr_{a} [deg/s]" for a in "xyz"), *(f"acc_{a} [g]" for a in "xyz")]
    table = pandas.DataFrame(
        np.column_stack([T * 1e3, np.full((20, 3), 180.0), np.ones((20, 3))]), columns=names
    )
    table.to_parquet(tmp_path / "a.parquet")
    data = kreisel.read(tmp_path / "a.parquet")
    np.testing.assert_allclose(data.t, T, rtol=1e-15)
    np.testing.assert_allclose(data.gyro, np.pi, rtol=1e-15)
    np.testing.assert_allclose(data.accel, 9.80665, rtol=1e-15)


@pytest.mark.parametrize("data", [IMU, kreisel.lissajous().sample(T)], ids=["imu", "motion"])
def test_parquet_that_pandas_wrote_of_our_frame_reads_back(tmp_path, data):
    pytest.importorskip("pandas", reason="pandas is not installed: pip install kreisel[data]")
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: pip install kreisel[data]")
    data.to_pandas().reset_index().to_parquet(tmp_path / "a.parquet")
    back = kreisel.read(tmp_path / "a.parquet")
    np.testing.assert_array_equal(back.t, data.t)
    for name in ("gyro", "accel") if data is IMU else ("p_NB", "v_NB"):
        np.testing.assert_array_equal(getattr(back, name), getattr(data, name))


def test_a_number_that_damage_made_huge_is_not_believed(tmp_path):
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: pip install kreisel[data]")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("gyro", shape=(10**9, 3), dtype="f8", chunks=(1000, 3))
    with pytest.raises(ValueError, match=r"its arrays would take 2\.4e\+10 bytes"):
        kreisel.read(tmp_path / "a.h5")


@pytest.mark.parametrize(
    ("name", "module"), [("a.h5", "h5py"), ("a.nc", "xarray"), ("a.nc", "h5netcdf"), ("a.parquet", "pyarrow")]
)
def test_without_its_library_the_command_that_installs_it_is_named(tmp_path, monkeypatch, name, module):
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setitem(sys.modules, f"{module}.parquet", None)
    with pytest.raises(ValueError, match=rf"needs {module}: pip install 'kreisel\[data\]'"):
        kreisel.write(tmp_path / name, IMU)
    assert list(tmp_path.iterdir()) == []
