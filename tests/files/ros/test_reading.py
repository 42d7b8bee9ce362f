"""Bags of others: the stamps of headers, what a covariance of -1 means, velocities in body axes, and clear refusals."""

import shutil
import sys

import numpy as np
import pytest

import kreisel
from kreisel.files.doors import listing
from tests.files.ros.bag_maker import EPOCH_NS, NO_READING, STEP_NS, Maker, imu_messages, save, stamps

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install kreisel[ros]")

# Nose north: a quarter turn about up, x y z w.
NORTH = (0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5))


@pytest.fixture(params=[1, 2])
def maker(request):
    return Maker(request.param)


@pytest.fixture
def ros2():
    return Maker(2)


def test_the_stamps_of_headers_count_and_not_those_of_logging(tmp_path, maker, rng):
    late = rng.integers(1, 4_000_000, size=20)
    messages = [
        ("/imu", "sensor_msgs/Imu", ns + int(dt), maker.imu(ns, gyro=(k, 0, 0)))
        for k, (ns, dt) in enumerate(zip(stamps(), late, strict=True))
    ]
    data = kreisel.read(save(tmp_path / "a.bag", maker, messages))
    assert data.t0_ns == EPOCH_NS
    np.testing.assert_array_equal(np.rint(data.t * 1e9).astype(int), np.arange(20) * STEP_NS)
    np.testing.assert_array_equal(data.gyro[:, 0], np.arange(20))


@pytest.mark.filterwarnings("ignore:.*never set")
def test_headers_without_stamps_leave_those_of_logging(tmp_path, maker):
    messages = [("/imu", "sensor_msgs/Imu", ns, maker.imu(0)) for ns in stamps()]
    path = save(tmp_path / "a.bag", maker, messages)
    assert kreisel.read(path).t0_ns == EPOCH_NS
    with pytest.warns(UserWarning, match="topic /imu: the stamps in the headers were never set"):
        kreisel.read(path)


@pytest.mark.parametrize(
    ("back", "message"),
    [(2 * STEP_NS, "time runs back from message 7 to 8"), (STEP_NS, "time stands still from message 7 to 8")],
)
def test_time_that_does_not_go_on_is_refused_with_its_message(tmp_path, maker, back, message):
    messages = [
        ("/imu", "sensor_msgs/Imu", ns, maker.imu(ns - (back if k == 7 else 0)))
        for k, ns in enumerate(stamps())
    ]
    with pytest.raises(ValueError, match=f"topic /imu: {message}"):
        kreisel.read(save(tmp_path / "a.bag", maker, messages))


def test_a_topic_of_mixed_types_is_refused(tmp_path, maker):
    messages = imu_messages(maker, "/mixed")
    messages += [("/mixed", "geometry_msgs/PoseStamped", ns, maker.stamped(ns)) for ns in stamps()]
    path = save(tmp_path / "a.bag", maker, messages)
    with pytest.raises(ValueError, match=r"no topic with an IMU or poses.*PoseStamped and sensor_msgs/Imu"):
        kreisel.read(path)
    with pytest.raises(ValueError, match="topic /mixed mixes messages of different types"):
        kreisel.read(path, topic="/mixed")


def test_a_bag_without_an_imu_lists_what_is_there(tmp_path, maker):
    messages = [("/chatter", "std_msgs/String", ns, maker.text(ns)) for ns in stamps()]
    messages += [("/pose", "geometry_msgs/PoseStamped", ns, maker.stamped(ns)) for ns in stamps()]
    path = save(tmp_path / "a.bag", maker, messages)
    there = r"There are /chatter \(std_msgs/String\), /pose \(geometry_msgs/PoseStamped\)"
    with pytest.raises(ValueError, match=f"has no topic with an IMU. {there}"):
        kreisel.read(path, kind="imu")
    with pytest.raises(ValueError, match=f"topic /chatter holds std_msgs/String, .*{there}"):
        kreisel.read(path, topic="/chatter")
    assert len(kreisel.read(path)) == 20


def test_of_several_topics_one_has_to_be_named(tmp_path, maker):
    messages = imu_messages(maker, "/left/imu", gyro=(1, 0, 0)) + imu_messages(maker, "/right/imu")
    path = save(tmp_path / "a.bag", maker, messages)
    with pytest.raises(ValueError, match=r"several topics to read. Say which, as in --topic /left/imu"):
        kreisel.read(path)
    for name in ("/left/imu", "left/imu"):
        assert kreisel.read(path, topic=name).gyro[0, 0] == 1.0
    with pytest.raises(ValueError, match=r"no topic '/lef/imu'. Did you mean '/left/imu'"):
        kreisel.read(path, topic="/lef/imu")
    with pytest.raises(ValueError, match="topic takes one with an IMU or poses"):
        kreisel.read(path, topic=["/left/imu", "/right/imu"])
    assert [(t.name, t.messages, t.holds) for t in listing(path)] == [
        ("/left/imu", 20, "imu"),
        ("/right/imu", 20, "imu"),
    ]


def test_a_topic_is_for_bags_alone(tmp_path):
    kreisel.write(tmp_path / "a.csv", kreisel.Poses([0.0, 1.0], np.zeros((2, 3))))
    with pytest.raises(ValueError, match="topic does not apply to the format 'csv'"):
        kreisel.read(tmp_path / "a.csv", topic="/imu")
    assert listing(tmp_path / "a.csv") is None


def test_a_covariance_of_minus_one_is_no_reading(tmp_path, maker):
    messages = [
        ("/imu", "sensor_msgs/Imu", ns, maker.imu(ns, covariances=[np.zeros(9), c, np.zeros(9)]))
        for ns, c in zip(stamps(4), [np.zeros(9), NO_READING, np.zeros(9), NO_READING], strict=True)
    ]
    data = kreisel.read(save(tmp_path / "a.bag", maker, messages))
    assert np.isnan(data.gyro).all(axis=1).tolist() == [False, True, False, True]
    assert np.isfinite(data.accel).all()


def test_sensors_of_which_a_topic_has_one_only_are_named(tmp_path, maker):
    """As depth cameras publish gyroscope and accelerometer, each on its own."""
    messages = imu_messages(maker, covariances=[NO_READING, np.zeros(9), NO_READING])
    path = save(tmp_path / "a.bag", maker, messages)
    with pytest.raises(ValueError, match=r"topic /imu: .*reports no linear acceleration"):
        kreisel.read(path)
    with pytest.raises(ValueError, match=r"topic /imu: .*reports no orientation"):
        kreisel.read(path, kind="attitude")


def test_an_imu_that_knows_its_attitude_gives_it_when_asked(tmp_path, maker):
    variance = np.diag([1e-4, 4e-4, 9e-4]).ravel()
    messages = imu_messages(maker, quat=NORTH, covariances=[variance, np.zeros(9), np.zeros(9)])
    path = save(tmp_path / "a.bag", maker, messages)
    assert isinstance(kreisel.read(path), kreisel.ImuRecording)
    attitude = kreisel.read(path, kind="attitude")
    np.testing.assert_allclose(attitude.R_NS[3, :, 0], [0.0, 1.0, 0.0], atol=1e-15)  # rounding of sqrt(0.5)
    np.testing.assert_allclose(attitude.sigma[0], [0.01, 0.02, 0.03], rtol=1e-15)


def test_covariances_that_stay_become_the_deviation_of_the_noise(tmp_path, maker):
    gyro, accel = np.diag([1e-6, 4e-6, 9e-6]).ravel(), np.full(9, 1e-4)
    steady = save(tmp_path / "a.bag", maker, imu_messages(maker, covariances=[gyro, gyro, accel]))
    np.testing.assert_allclose(kreisel.read(steady).gyro_noise, [1e-3, 2e-3, 3e-3], rtol=1e-15)
    np.testing.assert_allclose(kreisel.read(steady).accel_noise, 1e-2, rtol=1e-15)
    drifting = [
        ("/imu", "sensor_msgs/Imu", ns, maker.imu(ns, covariances=[gyro, gyro * k, accel]))
        for k, ns in enumerate(stamps(), start=1)
    ]
    data = kreisel.read(save(tmp_path / "b.bag", maker, drifting))
    assert data.gyro_noise is None
    np.testing.assert_allclose(data.gyro_sigma[3], [2e-3, 4e-3, 6e-3], rtol=1e-15)


def test_the_velocity_of_odometry_is_in_body_axes(tmp_path, maker):
    """Nose north at 2 m/s forward and 1 m/s to the left, which is west."""
    messages = [
        ("/odom", "nav_msgs/Odometry", ns, maker.odometry(ns, (k, 0, 0), NORTH, (2, 1, 0)))
        for k, ns in enumerate(stamps())
    ]
    data = kreisel.read(save(tmp_path / "a.bag", maker, messages))
    np.testing.assert_allclose(data.v_NB, np.tile([-1.0, 2.0, 0.0], (20, 1)), atol=1e-15)
    np.testing.assert_array_equal(data.p_NB[:, 0], np.arange(20))


def test_a_velocity_that_was_never_set_is_left_out(tmp_path, maker):
    messages = [
        ("/odom", "nav_msgs/Odometry", ns, maker.odometry(ns, (k, 0, 0), NORTH, (0, 0, 0)))
        for k, ns in enumerate(stamps())
    ]
    path = save(tmp_path / "a.bag", maker, messages)
    with pytest.warns(UserWarning, match="moves at a velocity of zero"):
        assert kreisel.read(path).v_NB is None


def test_transforms_are_read_by_their_pair_of_frames(tmp_path, maker):
    messages = [
        (
            "/tf",
            "tf2_msgs/TFMessage",
            ns,
            maker.transforms(ns, ("map", "odom", (0, 0, 0)), ("odom", "base", (k, 0, 0))),
        )
        for k, ns in enumerate(stamps())
    ]
    path = save(tmp_path / "a.bag", maker, messages)
    data = kreisel.read(path, topic="/tf:odom.base")
    np.testing.assert_array_equal(data.p_NB[:, 0], np.arange(20))
    assert data.t0_ns == EPOCH_NS
    assert {t.name for t in listing(path)} == {"/tf:map.odom", "/tf:odom.base"}
    with pytest.raises(ValueError, match=r"Say which.*/tf:map.odom .*/tf:odom.base"):
        kreisel.read(path)
    for name in ("/tf", "/tf:map.base"):
        with pytest.raises(ValueError, match=r"say which frames of /tf.*There are /tf:map.odom"):
            kreisel.read(path, topic=name)


def test_transforms_stand_back_where_a_topic_has_poses(tmp_path, maker):
    messages = [
        ("/tf", "tf2_msgs/TFMessage", ns, maker.transforms(ns, ("a", "b", (5, 0, 0)))) for ns in stamps()
    ]
    alone = save(tmp_path / "a.bag", maker, messages)
    assert kreisel.read(alone).p_NB[0, 0] == kreisel.read(alone, topic="/tf").p_NB[0, 0] == 5.0
    static = (
        "/tf_static",
        "tf2_msgs/TFMessage",
        EPOCH_NS,
        maker.transforms(EPOCH_NS, ("b", "imu", (0, 0, 0))),
    )
    poses = [("/pose", "geometry_msgs/PoseStamped", ns, maker.stamped(ns)) for ns in stamps()]
    both = save(tmp_path / "b.bag", maker, [static, *messages, *poses])
    assert kreisel.read(both).p_NB[0, 0] == 0.0


def test_tesla_become_microtesla_at_the_imus_stamps(tmp_path, maker):
    """A magnetometer at a quarter of the rate, each sample 1 ms after one of the IMU."""
    mag = [
        ("/mag", "sensor_msgs/MagneticField", ns, maker.field(ns, (2e-5, 0, k * 1e-6)))
        for k, ns in enumerate(ns + 1_000_000 for ns in stamps()[::4])
    ]
    path = save(tmp_path / "a.bag", maker, imu_messages(maker) + mag)
    with pytest.warns(UserWarning, match="topic /mag: samples are put at the IMU's stamps, up to 1 ms away"):
        data = kreisel.read(path)
    assert np.flatnonzero(np.isfinite(data.mag_uT).all(axis=1)).tolist() == [0, 4, 8, 12, 16]
    np.testing.assert_allclose(data.mag_uT[4], [20.0, 0.0, 1.0], rtol=1e-15)


def test_a_sample_goes_to_one_row_and_the_nearer_takes_it(tmp_path, ros2):
    """Two between rows 3 and 4; two beside row 9, of which the second is nearer; one long after the end."""
    off = [(3, 2_000_000), (3, 3_000_000), (9, -2_000_000), (9, 1_000_000), (19, 40_000_000)]
    mag = [
        ("/mag", "sensor_msgs/MagneticField", ns, ros2.field(ns, (k, 0, 0)))
        for k, ns in enumerate(EPOCH_NS + row * STEP_NS + dt for row, dt in off)
    ]
    path = save(tmp_path / "a", ros2, imu_messages(ros2) + mag)
    with pytest.warns(UserWarning, match="2 samples have no IMU sample of their own"):
        field = kreisel.read(path).mag_uT
    found = {int(row): round(field[row, 0] / 1e6) for row in np.flatnonzero(np.isfinite(field[:, 0]))}
    assert found == {3: 0, 4: 1, 9: 3}


def test_a_magnetometer_belongs_to_the_imu_of_its_namespace(tmp_path, ros2):
    messages = imu_messages(ros2, "/left/imu") + imu_messages(ros2, "/right/imu")
    for topic, tesla in (("/left/mag", 1.0), ("/other/mag", 2.0)):
        messages += [
            (topic, "sensor_msgs/MagneticField", ns, ros2.field(ns, (tesla, 0, 0))) for ns in stamps()
        ]
    path = save(tmp_path / "a", ros2, messages)
    assert kreisel.read(path, topic="/left/imu").mag_uT[0, 0] == 1e6
    assert kreisel.read(path, topic="/right/imu").mag_uT is None
    assert kreisel.read(path, topic=["/right/imu", "/other/mag"]).mag_uT[0, 0] == 2e6


@pytest.mark.parametrize("storage", ["MCAP", "SQLITE3"])
def test_folder_and_file_within_hold_the_same(tmp_path, ros2, storage, rng):
    gyro = rng.normal(size=3)
    folder = save(tmp_path / "flight", ros2, imu_messages(ros2, gyro=gyro), storage)
    (file,) = (path for path in folder.iterdir() if path.name != "metadata.yaml")
    alone = shutil.copy(file, tmp_path)
    for path in (folder, file, alone):
        data = kreisel.read(path)
        assert data.t0_ns == EPOCH_NS
        assert data.gyro.tobytes() == np.tile(gyro, (20, 1)).tobytes()


def test_a_folder_of_anything_else_is_no_bag(tmp_path):
    with pytest.raises(IsADirectoryError, match="it is a folder"):
        kreisel.read(tmp_path)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information:\n  version: 8\n")
    with pytest.raises(IsADirectoryError, match="it is a folder"):
        kreisel.read(tmp_path, "csv")
    with pytest.raises(ValueError, match="is not a whole ROS bag"):
        kreisel.read(tmp_path)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap"])
def test_a_file_that_was_cut_off_is_one_sentence_with_a_cure(tmp_path, name):
    path = tmp_path / name
    kreisel.write(path, kreisel.ImuRecording(np.arange(3.0), np.ones((3, 3)), np.ones((3, 3))))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 2 // 3])
    with pytest.raises(ValueError, match=r"not a whole ROS bag: it was cut off.*mcap recover") as caught:
        kreisel.read(path)
    assert "\n" not in str(caught.value)


def test_without_rosbags_the_command_that_installs_it_is_named(tmp_path, monkeypatch):
    data = kreisel.ImuRecording(np.arange(3.0), np.ones((3, 3)), np.ones((3, 3)))
    kreisel.write(tmp_path / "a.bag", data)
    monkeypatch.setitem(sys.modules, "rosbags", None)
    for work in (lambda: kreisel.read(tmp_path / "a.bag"), lambda: kreisel.write(tmp_path / "b.bag", data)):
        with pytest.raises(ValueError, match=r"pip install 'kreisel\[ros\]'"):
            work()
    assert not (tmp_path / "b.bag").exists()
