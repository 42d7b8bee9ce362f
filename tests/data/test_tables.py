"""Nouns as the tables of pandas and xarray: every number, its unit and its frame."""

import json
import sys

import numpy as np
import pytest

import kreisel
from kreisel.data.tables import CONSTANTS, QUANTITIES, arrays_of

EPOCH_NS = 1_700_000_000_123_456_789
N = 12

MOTION = kreisel.lissajous().sample(np.arange(N) * 0.01)


def recording(t0_ns=EPOCH_NS):
    mag = np.full((N, 3), np.nan)
    mag[::2] = 20.0
    ones = np.ones((N, 3))
    return kreisel.ImuRecording(
        MOTION.t, ones, 9.8 * ones, mag, t0_ns, "wrist", gyro_noise=[1e-3, 2e-3, 3e-3]
    )


def attitude():
    flags = np.arange(N) % 2 == 0
    return kreisel.AttitudeHistory(MOTION.t, MOTION.R_NB, np.ones((N, 3)), rest=flags, t0_ns=EPOCH_NS)


def reference():
    R, counts = MOTION.R_NB.copy(), np.ones(N, dtype=bool)
    R[3], counts[3] = np.nan, False
    return kreisel.Reference(MOTION.t, R, counts)


NOUNS = [MOTION, kreisel.Poses(MOTION.t, MOTION.p_NB), recording(), attitude(), reference()]


@pytest.mark.parametrize("data", NOUNS, ids=lambda data: type(data).__name__)
def test_a_dataset_has_every_bit_and_says_what_it_is(data):
    pytest.importorskip("xarray", reason="xarray is not installed: pip install kreisel[data]")
    dataset = data.to_xarray()
    for name, array in arrays_of(data):
        variable = dataset[name]
        assert variable.values.tobytes() == array.tobytes(), name
        assert variable.attrs["units"] == QUANTITIES[name].unit
        assert variable.attrs.get("frame", "") == QUANTITIES[name].frame
    assert dataset.attrs["noun"] == type(data).__name__
    assert dataset.attrs["t0_ns"] == data.t0_ns


def test_a_dataset_is_asked_by_axis_and_time():
    pytest.importorskip("xarray", reason="xarray is not installed: pip install kreisel[data]")
    dataset = recording().to_xarray()
    assert float(dataset.gyro_noise.sel(axis="y")) == 2e-3
    assert float(dataset.accel.sel(t=0.05, method="nearest").sel(axis="z")) == 9.8
    assert dataset.time.values.astype("int64").tolist() == [EPOCH_NS + k * 10_000_000 for k in range(N)]
    assert "time" not in recording(t0_ns=0).to_xarray().coords
    # The third column of R_NB is the body's z axis in N.
    up = MOTION.to_xarray().R_NB.sel(column="z")
    np.testing.assert_array_equal(up.values, MOTION.R_NB[:, :, 2])


@pytest.mark.parametrize("data", NOUNS, ids=lambda data: type(data).__name__)
def test_a_frame_has_a_column_for_each_component(data):
    pytest.importorskip("pandas", reason="pandas is not installed: pip install kreisel[data]")
    table = data.to_pandas()
    np.testing.assert_array_equal(table.index.to_numpy(), data.t)
    assert set(table.attrs["units"]) == {"t", *table.columns}
    for name, array in arrays_of(data):
        if array.ndim == 2:
            columns = [f"{QUANTITIES[name].column}_{axis}" for axis in "xyz"]
            np.testing.assert_array_equal(table[columns].to_numpy(), array)
            assert {table.attrs["frames"][column] for column in columns} == {QUANTITIES[name].frame}
        elif name in CONSTANTS:
            assert table.attrs[name] == array.tolist()
    json.dumps(table.attrs)  # as pandas itself does where it writes Parquet


def test_a_frame_has_attitude_as_a_quaternion():
    pytest.importorskip("pandas", reason="pandas is not installed: pip install kreisel[data]")
    parts = ["q_w", "q_x", "q_y", "q_z"]
    np.testing.assert_array_equal(MOTION.to_pandas()[parts].to_numpy(), MOTION.quat_wxyz)
    assert reference().to_pandas()[parts].isna().all(axis=1).tolist() == [k == 3 for k in range(N)]


@pytest.mark.parametrize(("module", "method"), [("pandas", "to_pandas"), ("xarray", "to_xarray")])
def test_the_command_that_installs_what_is_missing_is_named(module, method, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"{method} needs {module}: pip install 'kreisel\[data\]'"):
        getattr(MOTION, method)()


def test_every_field_of_every_noun_is_described():
    found = {name for data in NOUNS for name, _ in arrays_of(data)}
    assert found <= set(QUANTITIES)
