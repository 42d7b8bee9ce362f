"""ROS bags at the command line: topics listed, chosen by flag, and every mistake one line."""

import json

import numpy as np
import pytest

import kreisel
from kreisel.cli.main import main
from tests.files.ros.bag_maker import EPOCH_NS, Maker, imu_messages, save, stamps

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install kreisel[ros]")

NORTH = (0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5))


@pytest.fixture
def flight(tmp_path):
    """A recorded flight: an IMU, odometry of a body that goes round a bend, and something else."""
    maker = Maker(2)
    messages = imu_messages(maker, "/imu", 400)
    for k, ns in enumerate(stamps(400)):
        bend = k / 400.0
        path = (10 * np.sin(bend), 10 - 10 * np.cos(bend), 0)
        messages.append(("/odom", "nav_msgs/Odometry", ns, maker.odometry(ns, path, NORTH, (10, 0, 0))))
    messages.append(("/chatter", "std_msgs/String", EPOCH_NS, maker.text(EPOCH_NS)))
    folder = save(tmp_path / "bag", maker, sorted(messages, key=lambda message: message[2]))
    return (folder / "bag.mcap").rename(tmp_path / "flight.mcap")


def said(capsys):
    return capsys.readouterr().err


def test_info_lists_the_topics_and_tells_of_the_one_that_is_named(flight, capsys):
    assert main(["info", str(flight)]) == 0
    told = capsys.readouterr().out
    assert "/chatter  std_msgs/String          1 messages\n" in told
    assert "/imu      sensor_msgs/Imu        400 messages  IMU\n" in told
    assert "/odom     nav_msgs/Odometry      400 messages  poses\n" in told
    assert "rate" not in told
    assert "--topic NAME" in told
    assert main(["info", str(flight), "--topic", "/imu"]) == 0
    assert "200 Hz" in capsys.readouterr().out


def test_info_of_a_bag_with_nothing_to_read_says_so(tmp_path, capsys):
    maker = Maker(1)
    save(tmp_path / "a.bag", maker, [("/chatter", "std_msgs/String", EPOCH_NS, maker.text(EPOCH_NS))])
    assert main(["info", str(tmp_path / "a.bag")]) == 0
    told = capsys.readouterr().out
    assert "/chatter  std_msgs/String" in told and "None of its topics has an IMU or poses" in told


def test_info_for_machines_has_the_topics(flight, capsys):
    assert main(["info", "--json", str(flight)]) == 0
    (file,) = json.loads(capsys.readouterr().out)["files"]
    assert file["topics"][1] == {"name": "/imu", "type": "sensor_msgs/Imu", "messages": 400, "holds": "imu"}
    assert "clock" not in file
    assert main(["info", "--json", "--topic", "/odom", str(flight)]) == 0
    (file,) = json.loads(capsys.readouterr().out)["files"]
    assert file["clock"]["t0_ns"] == EPOCH_NS


def test_a_bag_goes_through_every_command(flight, tmp_path, capsys):
    attitude, out, bag = tmp_path / "attitude.tum", tmp_path / "out", tmp_path / "imu.bag"
    assert main(["estimate", str(flight), "--topic", "/imu", "-o", str(attitude)]) == 0
    options = ["-o", str(out), "--no-pictures", "--imu-format", "mcap"]
    assert main(["simulate", str(flight), "--topic", "/odom", *options]) == 0
    assert main(["convert", str(flight), str(bag), "--topic", "imu"]) == 0
    assert main(["evaluate", str(flight), str(attitude), "--truth-topic", "/odom"]) == 0
    assert kreisel.read(attitude).t0_ns == kreisel.read(out / "imu.mcap").t0_ns == EPOCH_NS
    assert kreisel.read(bag).accel.tobytes() == np.tile([0, 0, 9.81], (400, 1)).tobytes()


def test_a_folder_is_written_and_read_like_a_file(flight, tmp_path):
    folder = tmp_path / "recorded"
    assert main(["convert", str(flight), str(folder), "--to", "rosbag2", "--topic", "/imu"]) == 0
    assert main(["info", str(folder)]) == 0
    assert (
        main(
            [
                "simulate",
                str(flight),
                "--topic",
                "/odom",
                "-o",
                str(tmp_path),
                "--imu-format",
                "rosbag2",
                "--no-pictures",
            ]
        )
        == 0
    )
    assert (tmp_path / "imu" / "metadata.yaml").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["estimate", "flight.mcap"],
            "several topics to read. Say which, as in --topic /imu. There are /imu",
        ),
        (["estimate", "flight.mcap", "--topic", "/odom"], "holds Poses, not an IMU recording"),
        (["info", "flight.mcap", "--topic", "/imus"], "no topic '/imus'. Did you mean '/imu'?"),
        (["allan", "poses.bag"], "has no topic with an IMU. There are /pose"),
        (["info", "cut.mcap"], "is not a whole ROS bag: it was cut off"),
        (["convert", "flight.mcap", "bag", "--to", "rosbag2", "--topic", "/imu"], "exists already"),
    ],
)
def test_mistakes_are_one_line_and_exit_code_1(flight, tmp_path, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cut.mcap").write_bytes(flight.read_bytes()[:2000])
    kreisel.write("poses.bag", kreisel.Poses([0.0, 1.0], np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1))))
    assert main(arguments) == 1
    error = said(capsys)
    assert message in error
    assert error.count("\n") == 1
