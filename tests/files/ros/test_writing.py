"""What we write, as tools that share no code with us read it: mcap's reader for ROS 2, and evo run as a program."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kreisel

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install kreisel[ros]")

EPOCH_NS = 1_700_000_000_123_456_789
N = 30
EVO = shutil.which("evo_traj", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))


def motion(t0_ns=EPOCH_NS):
    moving = kreisel.figure_eight(period=8.0).sample(np.arange(N) * 0.005)
    return kreisel.Motion(
        moving.t,
        moving.p_NB,
        moving.v_NB,
        moving.a_NB,
        moving.R_NB,
        moving.omega_NB_B,
        moving.alpha_NB_B,
        t0_ns,
    )


def recording(rng):
    gyro, accel, mag = rng.normal(size=(3, N, 3))
    accel[7], mag[::2] = np.nan, np.nan
    noise = {"gyro_noise": [1e-3, 2e-3, 3e-3], "accel_noise": 0.01, "mag_noise_uT": 0.5}
    return kreisel.ImuRecording(np.arange(N) * 0.005, gyro, accel, mag, EPOCH_NS, "imu", **noise)


def by_mcap(path):
    """{topic: [(logged at ns, message)]} by the readers of mcap and mcap-ros2-support."""
    reader = pytest.importorskip(
        "mcap_ros2.reader", reason="no mcap-ros2-support: pip install kreisel[oracle]"
    )
    found = {}
    for each in reader.read_ros2_messages(str(path)):
        found.setdefault(each.channel.topic, []).append((each.log_time_ns, each.ros_msg))
    return found


def nanoseconds(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def xyz(vector):
    return [vector.x, vector.y, vector.z]


def test_a_second_library_reads_a_recording_bit_by_bit(tmp_path, rng):
    data = recording(rng)
    kreisel.write(tmp_path / "a.mcap", data)
    topics = by_mcap(tmp_path / "a.mcap")
    assert set(topics) == {"/imu/data_raw", "/imu/mag"}
    imu, mag = topics["/imu/data_raw"], topics["/imu/mag"]
    assert [nanoseconds(m) for _, m in imu] == [EPOCH_NS + 5_000_000 * k for k in range(N)]
    assert all(logged == nanoseconds(m) for logged, m in imu + mag)
    assert np.array([xyz(m.angular_velocity) for _, m in imu]).tobytes() == data.gyro.tobytes()
    np.testing.assert_array_equal([xyz(m.linear_acceleration) for _, m in imu], data.accel)
    assert [nanoseconds(m) for _, m in mag] == [EPOCH_NS + 5_000_000 * k for k in range(1, N, 2)]
    np.testing.assert_array_equal([xyz(m.magnetic_field) for _, m in mag], data.mag_uT[1::2] / 1e6)


def test_covariances_are_those_of_the_sensor_model_and_minus_one_is_no_reading(tmp_path, rng):
    kreisel.write(tmp_path / "a.mcap", recording(rng))
    topics = by_mcap(tmp_path / "a.mcap")
    for k, (_, message) in enumerate(topics["/imu/data_raw"]):
        assert message.orientation_covariance[0] == -1.0
        gyro = np.reshape(message.angular_velocity_covariance, (3, 3))
        np.testing.assert_allclose(gyro, np.diag([1e-6, 4e-6, 9e-6]), rtol=1e-15)
        expected = -1.0 if k == 7 else 1e-4
        assert message.linear_acceleration_covariance[0] == pytest.approx(expected, rel=1e-15)
        assert message.header.frame_id == "imu_link"
    _, field = topics["/imu/mag"][0]
    # 0.5 uT, in tesla and squared.
    np.testing.assert_allclose(field.magnetic_field_covariance[::4], 0.25e-12, rtol=1e-15)


def test_standard_errors_of_readings_survive_row_by_row(tmp_path, rng):
    gyro, accel, sigma = rng.normal(size=(3, N, 3))
    data = kreisel.ImuRecording(np.arange(N) * 0.005, gyro, accel, gyro_sigma=np.abs(sigma))
    kreisel.write(tmp_path / "a.bag", data)
    back = kreisel.read(tmp_path / "a.bag")
    assert back.gyro_sigma.tobytes() == data.gyro_sigma.tobytes()
    assert back.gyro_noise is back.accel_sigma is back.accel_noise is None


def test_a_simulated_sensor_brings_its_own_covariance(tmp_path):
    """BMI088: noise density of the gyroscope 0.014 deg/s/sqrt(Hz), one-sided, so over 100 Hz at a rate of 200 Hz."""
    still = kreisel.rest(position=[0, 0, 0]).sample(np.arange(N) * 0.005)
    kreisel.write(tmp_path / "a.mcap", kreisel.Imu.from_preset("bmi088").record(still, 1).measured)
    _, message = by_mcap(tmp_path / "a.mcap")["/imu/data_raw"][0]
    sigma = np.radians(0.014) * np.sqrt(100.0)
    np.testing.assert_allclose(message.angular_velocity_covariance[::4], sigma**2, rtol=1e-12)
    kreisel.write(tmp_path / "b.mcap", kreisel.Imu().ideal(still))
    _, message = by_mcap(tmp_path / "b.mcap")["/imu/data_raw"][0]
    assert not np.any(message.angular_velocity_covariance)  # unknown, as REP-145 has it


def test_a_motion_becomes_odometry_in_body_axes_and_transforms(tmp_path):
    data = motion()
    kreisel.write(tmp_path / "a.mcap", data)
    topics = by_mcap(tmp_path / "a.mcap")
    odometry = [m for _, m in topics["/odom"]]
    assert (odometry[0].header.frame_id, odometry[0].child_frame_id) == ("odom", "base_link")
    v_B = np.einsum("nij,ni->nj", data.R_NB, data.v_NB)
    np.testing.assert_allclose([xyz(m.twist.twist.linear) for m in odometry], v_B, rtol=0.0, atol=1e-15)
    np.testing.assert_array_equal([xyz(m.twist.twist.angular) for m in odometry], data.omega_NB_B)
    transforms = [m.transforms[0] for _, m in topics["/tf"]]
    np.testing.assert_array_equal([xyz(m.transform.translation) for m in transforms], data.p_NB)
    assert [nanoseconds(m) for m in transforms] == [nanoseconds(m) for m in odometry]


def test_a_rate_that_is_not_known_has_a_large_variance(tmp_path):
    data = motion()
    kreisel.write(tmp_path / "a.mcap", kreisel.Poses(data.t, data.p_NB, data.R_NB, data.v_NB))
    _, message = by_mcap(tmp_path / "a.mcap")["/odom"][0]
    assert message.twist.covariance[::7] == [0.0, 0.0, 0.0, 1e6, 1e6, 1e6]


def test_attitude_is_the_orientation_of_an_imu_that_measures_nothing_else(tmp_path):
    data = motion()
    sigma = np.tile([0.01, 0.02, 0.03], (N, 1))
    kreisel.write(
        tmp_path / "a.mcap", kreisel.AttitudeHistory(data.t, data.R_NB, sigma=sigma, t0_ns=EPOCH_NS)
    )
    for _, message in by_mcap(tmp_path / "a.mcap")["/imu/data"]:
        np.testing.assert_allclose(message.orientation_covariance[::4], [1e-4, 4e-4, 9e-4], rtol=1e-15)
        assert message.angular_velocity_covariance[0] == message.linear_acceleration_covariance[0] == -1.0


@pytest.mark.skipif(EVO is None, reason="evo is not installed: pip install kreisel[oracle]")
@pytest.mark.parametrize(
    ("name", "format", "kind"),
    [("a.bag", None, "bag"), ("a.mcap", None, "bag2"), ("a", "rosbag2", "bag2")],
)
@pytest.mark.parametrize("topic", ["/odom", "/pose"])
def test_evo_opens_what_we_write(tmp_path, name, format, kind, topic):
    data = motion()
    v_NB = data.v_NB if topic == "/odom" else None
    kreisel.write(tmp_path / name, kreisel.Poses(data.t, data.p_NB, data.R_NB, v_NB, EPOCH_NS), format)
    environment = os.environ | {"HOME": str(tmp_path), "USERPROFILE": str(tmp_path), "MPLBACKEND": "Agg"}
    command = [EVO, kind, name, topic, "--save_as_tum"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    theirs = kreisel.read(tmp_path / f"{topic[1:]}.tum")
    np.testing.assert_array_equal(theirs.p_NB, data.p_NB)
    np.testing.assert_allclose(theirs.R_NB, data.R_NB, rtol=0.0, atol=4e-15)  # the roundings of a quaternion
    # evo has epoch seconds in a float64, which resolves 2.4e-7 s there.
    np.testing.assert_allclose(theirs.t + (theirs.t0_ns - EPOCH_NS) / 1e9, data.t, rtol=0.0, atol=3e-7)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap"])
@pytest.mark.parametrize(
    ("t", "message"),
    [
        ([-1.0, 0.0], "no stamps before 1970"),
        ([0.0, 2.0**33], "no stamps before 1970 nor after 2"),
        ([0.0, 1e-10], "two stamps are closer"),
    ],
)
def test_stamps_that_ros_does_not_have_are_refused(tmp_path, name, t, message):
    poses = kreisel.Poses(np.array(t), np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1)))
    with pytest.raises(ValueError, match=message):
        kreisel.write(tmp_path / name, poses)
    assert list(tmp_path.iterdir()) == []


def test_positions_alone_are_no_poses_of_ros(tmp_path):
    with pytest.raises(ValueError, match=r"positions alone\. Write csv"):
        kreisel.write(tmp_path / "a.bag", kreisel.Poses([0.0, 1.0], np.zeros((2, 3))))


def test_a_bag_that_is_a_folder_appears_whole_or_not_at_all(tmp_path, monkeypatch):
    data = motion()
    kreisel.write(tmp_path / "flight", data, "rosbag2")
    assert sorted(path.name for path in (tmp_path / "flight").iterdir()) == ["flight.mcap", "metadata.yaml"]
    with pytest.raises(FileExistsError, match=r"flight: it exists already. Choose another name or remove it"):
        kreisel.write(tmp_path / "flight", data, "rosbag2")
    with pytest.raises(FileNotFoundError, match="missing does not exist"):
        kreisel.write(tmp_path / "missing" / "flight", data, "rosbag2")

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        kreisel.write(tmp_path / "other", data, "rosbag2")
    assert [path.name for path in tmp_path.iterdir()] == ["flight"]


def test_the_same_data_makes_the_same_bytes(tmp_path):
    for name in ("a.bag", "b.bag", "a.mcap", "b.mcap"):
        kreisel.write(tmp_path / name, motion())
    for suffix in ("bag", "mcap"):
        assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()
