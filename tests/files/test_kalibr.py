"""kalibr's imu.yaml: read, written, and refused with the key where it is not sound."""

import numpy as np
import pytest

from kreisel.data.noise import NoiseModel
from kreisel.files.kalibr import KalibrImu, read_kalibr, write_kalibr

# The values and layout of the example on kalibr's wiki.
WIKI = """\
#Accelerometers
accelerometer_noise_density: 1.86e-03   #Noise density (continuous-time)
accelerometer_random_walk:   4.33e-04   #Bias random walk

#Gyroscopes
gyroscope_noise_density:     1.87e-04   #Noise density (continuous-time)
gyroscope_random_walk:       2.66e-05   #Bias random walk

rostopic:                    /imu0      #the IMU ROS topic
update_rate:                 200.0      #Hz (for discretization of the values above)
"""


def test_the_example_of_the_wiki(tmp_path):
    path = tmp_path / "imu.yaml"
    path.write_text(WIKI)
    imu = read_kalibr(path)
    assert imu.gyro.white_noise.tolist() == [1.87e-4] * 3
    assert imu.gyro.bias_random_walk.tolist() == [2.66e-5] * 3
    assert imu.accel.white_noise.tolist() == [1.86e-3] * 3
    assert imu.accel.bias_random_walk.tolist() == [4.33e-4] * 3
    assert (imu.rate_hz, imu.topic) == (200.0, "/imu0")


def test_results_of_kalibr_and_numbers_without_a_point(tmp_path):
    path = tmp_path / "results.yaml"
    path.write_text(
        "imu0:\n" + "".join(f"  {line}\n" for line in WIKI.replace("1.87e-04", "2e-4").splitlines())
    )
    assert read_kalibr(path).gyro.white_noise[0] == 2e-4


def test_round_trip_to_the_bit(tmp_path):
    path = tmp_path / "imu.yaml"
    gyro = NoiseModel(white_noise=np.pi * 1e-5, bias_random_walk=1e-7)
    accel = NoiseModel(white_noise=1 / 3, bias_random_walk=1e-300)
    write_kalibr(path, KalibrImu(gyro, accel, 1000.0 / 3.0, "/camera/imu"))
    back = read_kalibr(path)
    for model, again in ((gyro, back.gyro), (accel, back.accel)):
        assert (model.white_noise == again.white_noise).all()
        assert (model.bias_random_walk == again.bias_random_walk).all()
    assert (back.rate_hz, back.topic) == (1000.0 / 3.0, "/camera/imu")
    assert "rad/s/sqrt(Hz): N, angle random walk" in path.read_text()


def test_the_noisiest_axis_counts(tmp_path):
    path = tmp_path / "imu.yaml"
    model = NoiseModel(white_noise=(1.0, 3.0, 2.0), bias_random_walk=1.0)
    write_kalibr(path, KalibrImu(model, model, 100.0))
    assert read_kalibr(path).gyro.white_noise[0] == 3.0


def test_no_random_walk_is_refused_and_nothing_written(tmp_path):
    path = tmp_path / "imu.yaml"
    with pytest.raises(ValueError, match="gyroscope_random_walk above 0"):
        write_kalibr(path, KalibrImu(NoiseModel(1.0), NoiseModel(1.0), 100.0))
    assert not path.exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not YAML"),
        ("just text", "holds no keys"),
        ("- 1", "holds no keys"),
        (WIKI.replace("gyroscope_random_walk", "gyro_walk"), "gyroscope_random_walk is missing"),
        (WIKI.replace("1.86e-03", "fast"), "accelerometer_noise_density must be a number"),
        (
            WIKI.replace("1.86e-03", "-1.0"),
            r"accelerometer_noise_density must be one number, 0 or more, m/s\^2",
        ),
        (WIKI.replace("200.0", "0"), "update_rate must be"),
        ("a: !!python/object/apply:os.getcwd []", "not YAML"),
    ],
)
def test_what_is_not_sound_is_refused(tmp_path, text, message):
    path = tmp_path / "imu.yaml"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        read_kalibr(path)


def test_no_file(tmp_path):
    with pytest.raises(OSError, match="cannot read"):
        read_kalibr(tmp_path / "imu.yaml")
