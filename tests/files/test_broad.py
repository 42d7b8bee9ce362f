"""Trials of the BROAD benchmark: what is in them comes out, and no other file is taken for one."""

import sys

import numpy as np
import pytest
from scipy.io import savemat

import kreisel
from kreisel.data.trial import Trial
from kreisel.files.doors import detect
from kreisel.files.formats import broad

N = 50


@pytest.fixture
def variables(rng):
    quat = rng.normal(size=(N, 4))
    quat /= np.linalg.norm(quat, axis=1)[:, None]
    quat[10:15] = np.nan
    movement = np.arange(N) >= 8
    imu = {name: rng.normal(size=(N, 3)) for name in ("imu_gyr", "imu_acc", "imu_mag")}
    return imu | {"opt_quat": quat, "movement": movement, "sampling_rate": 250.0, "info": "made up"}


def save(path, variables, **options):
    savemat(path, variables, **options)
    return path


def save_hdf5(path, variables, rate_as_attribute=True):
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: pip install kreisel[data]")
    with h5py.File(path, "w") as file:
        for name, value in variables.items():
            if name == "sampling_rate" and rate_as_attribute:
                file.attrs[name] = value
            else:
                file[name] = value
    return path


def check(trial, variables):
    assert isinstance(trial, Trial) and trial.name == "trial"
    imu, reference = trial.recording, trial.reference
    np.testing.assert_array_equal(imu.gyro, variables["imu_gyr"])
    np.testing.assert_array_equal(imu.accel, variables["imu_acc"])
    np.testing.assert_array_equal(imu.mag_uT, variables["imu_mag"])
    np.testing.assert_allclose(imu.t, np.arange(N) * 0.004, rtol=1e-15)
    np.testing.assert_array_equal(reference.t, imu.t)
    # Eight before the movement, and two of the five that the cameras missed lie beyond them.
    assert reference.counts.sum() == N - 8 - 5
    assert np.isnan(reference.R_NS[12]).all()
    w, x, y, z = variables["opt_quat"][0]
    # The third column is z_S in N, from the quaternion product q (0, 0, 0, 1) q*.
    np.testing.assert_allclose(
        reference.R_NS[0, :, 2],
        [2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z],
        atol=1e-15,
    )


@pytest.mark.parametrize("options", [{}, {"do_compression": True}, {"oned_as": "column"}])
def test_a_mat_file_becomes_recording_and_reference(tmp_path, variables, options):
    check(kreisel.read(save(tmp_path / "trial.mat", variables, **options)), variables)


@pytest.mark.parametrize("write", [save, save_hdf5])
def test_poses_are_the_rows_that_the_cameras_saw_whole(tmp_path, variables, rng, write):
    path = tmp_path / ("trial.mat" if write is save else "trial.hdf5")
    assert kreisel.read(write(path, variables)).poses is None
    with pytest.raises(ValueError, match="not poses"):
        kreisel.read(path, kind="poses")
    position = rng.normal(size=(N, 3))
    position[20, 1] = np.nan
    path.unlink()
    poses = kreisel.read(write(path, variables | {"opt_pos": position}), kind="poses")
    seen = np.setdiff1d(np.arange(N), [10, 11, 12, 13, 14, 20])
    np.testing.assert_array_equal(poses.t, np.arange(N)[seen] / 250.0)
    np.testing.assert_array_equal(poses.p_NB, position[seen])
    assert poses.name == "trial" and poses.R_NB.shape == (N - 6, 3, 3)
    with pytest.raises(ValueError, match="'opt_pos' must be"):
        kreisel.read(write(tmp_path / ("short" + path.suffix), variables | {"opt_pos": position[:, :2]}))


@pytest.mark.parametrize("rate_as_attribute", [True, False])
def test_an_hdf5_file_holds_the_same(tmp_path, variables, rate_as_attribute):
    check(kreisel.read(save_hdf5(tmp_path / "trial.hdf5", variables, rate_as_attribute)), variables)


def test_the_mask_may_be_numbers_or_truth_values(tmp_path, variables):
    variables["movement"] = variables["movement"].astype(np.uint8)[:, None]
    check(kreisel.read(save(tmp_path / "trial.mat", variables)), variables)


def test_kind_takes_the_recording_alone(tmp_path, variables):
    path = save(tmp_path / "trial.mat", variables)
    assert isinstance(kreisel.read(path, kind="imu"), kreisel.ImuRecording)
    assert isinstance(kreisel.read(path, kind="trial"), Trial)
    with pytest.raises(ValueError, match=r"holds a trial.*, not poses"):
        kreisel.read(path, kind="poses")


def test_content_tells_a_trial_from_other_mat_files(tmp_path, variables):
    ours = tmp_path / "ours.mat"
    kreisel.write(ours, kreisel.ImuRecording(np.arange(3.0), np.ones((3, 3)), np.ones((3, 3))))
    stranger = save(tmp_path / "stranger.mat", {"t": np.arange(3.0), "s": np.ones((3, 3))})
    trial = save(tmp_path / "trial", variables, appendmat=False)
    last = {name: variables[name] for name in reversed(variables)}
    reversed_order = save(tmp_path / "reversed.mat", last, do_compression=True)
    names = [detect(p, p.read_bytes()[:65536]).__name__ for p in (ours, stranger, trial, reversed_order)]
    assert [name.rpartition(".")[2] for name in names] == ["mat", "mat", "broad", "broad"]


def test_a_trial_of_any_byte_order_is_recognised(variables, tmp_path):
    head = save(tmp_path / "trial.mat", variables).read_bytes()[:1024]
    assert broad.sniff(head)
    swapped = head[:126] + b"MI" + b"".join(head[k : k + 4][::-1] for k in (128, 132)) + head[136:]
    assert broad.sniff(swapped)
    assert not broad.sniff(b"MATLAB 5.0" + bytes(300)) and not broad.sniff(b"\x89HDF\r\n\x1a\n" + bytes(300))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"movement": None}, "variable 'movement' is missing"),
        ({"imu_gyr": np.zeros((3, N))}, r"variable 'imu_gyr' must be \(n, 3\); got \(3, 50\)"),
        ({"imu_acc": np.zeros((N - 1, 3))}, "imu_acc must have one row per time stamp; got 49 rows for 50"),
        ({"movement": np.arange(N)}, "movement must be .* booleans"),
        ({"sampling_rate": 0.0}, "'sampling_rate' must be one positive number"),
        ({"opt_quat": np.full((N, 4), 1.0)}, "opt_quat must be unit quaternions"),
        ({"imu_mag": "none"}, "imu_mag"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_variable(tmp_path, variables, change, message):
    changed = {name: value for name, value in (variables | change).items() if value is not None}
    path = save(tmp_path / "trial.mat", changed)
    with pytest.raises(ValueError, match=message) as caught:
        kreisel.read(path)
    assert str(path) in str(caught.value)


def test_a_cut_file_is_refused(tmp_path, variables):
    path = save(tmp_path / "trial.mat", variables, do_compression=True)
    whole = path.read_bytes()
    for end in range(200, len(whole), 331):
        path.write_bytes(whole[:end])
        with pytest.raises(ValueError, match=r"trial\.mat") as caught:
            kreisel.read(path, "broad")
        assert "\n" not in str(caught.value)


def test_a_cut_hdf5_file_is_refused(tmp_path, variables):
    path = save_hdf5(tmp_path / "trial.hdf5", variables)
    whole = path.read_bytes()
    for end in range(100, len(whole), 997):
        path.write_bytes(whole[:end])
        with pytest.raises(ValueError, match=r"trial\.hdf5") as caught:
            kreisel.read(path, "broad")
        assert "\n" not in str(caught.value)


def test_without_h5py_the_cure_is_named(tmp_path, monkeypatch):
    path = tmp_path / "trial.hdf5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + b"imu_gyr opt_quat")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ValueError, match=r"needs h5py: pip install 'kreisel\[data\]'"):
        kreisel.read(path)


def test_a_trial_is_not_written(tmp_path, variables):
    trial = kreisel.read(save(tmp_path / "trial.mat", variables))
    with pytest.raises(TypeError, match="got Trial"):
        kreisel.write(tmp_path / "copy.mat", trial)
    with pytest.raises(ValueError, match="for reading the benchmark"):
        kreisel.write(tmp_path / "copy.mat", trial.recording, "broad")
