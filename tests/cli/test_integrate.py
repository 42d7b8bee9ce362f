"""`kreisel simulate --increments` and `kreisel integrate` as a user runs them, with good files and bad ones."""

import json

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.trajectory import Poses
from kreisel.files.doors import read, write
from kreisel.maths.rotations import matrix_from_euler

ARM = ["--imu", "arm:0.5,0,0:0,0,30"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with poses of a level circle, and what an ideal and a real unit half a metre ahead make of it."""
    folder = tmp_path_factory.mktemp("made")
    t = np.arange(200) / 50.0
    p = np.stack([2.0 * np.cos(t), 2.0 * np.sin(t), 0 * t], axis=1)
    R = matrix_from_euler(np.stack([0 * t, 0 * t, t + 0.5 * np.pi], axis=1))
    write(folder / "poses.csv", Poses(t, p, R))
    command = ["simulate", str(folder / "poses.csv"), "--no-pictures", "--rate", "100"]
    assert main([*command, "-o", str(folder / "ideal"), *ARM, "--increments"]) == 0
    assert main([*command, "-o", str(folder / "rates"), *ARM]) == 0
    real = ["--imu", "hg9900@arm:0.5,0,0:0,0,30", "--seed", "7"]
    assert main([*command, "-o", str(folder / "real"), *real, "--increments"]) == 0
    return folder


def test_simulated_increments_are_those_of_the_circle(made):
    unit = read(made / "ideal" / "arm.csv")
    assert isinstance(unit, ImuIncrements)
    assert unit.dp is not None
    np.testing.assert_allclose(unit.dtheta, np.tile([0.0, 0.0, 0.01], (len(unit), 1)), atol=1e-12)
    # Gravity upwards, whatever the rest.
    np.testing.assert_allclose(unit.dv[:, 2], 9.80665 * 0.01, atol=1e-9)


def test_a_real_unit_has_errors_and_no_dp(made):
    unit = read(made / "real" / "arm.csv")
    assert unit.dp is None
    with np.load(made / "real" / "arm-errors.npz") as terms:
        # The white noise of the ring laser gyro: 0.002 deg/sqrt(h), over 10 ms.
        noise = terms["dtheta_error_white_noise"]
        expected = np.deg2rad(0.002) / 60.0 * 0.1
        # 1200 normals: 2 % standard deviation.
        np.testing.assert_allclose(noise.std(), expected, rtol=0.1)
        total = terms["ideal_dtheta"] + sum(
            terms[name] for name in terms.files if name.startswith("dtheta_error")
        )
        np.testing.assert_allclose(unit.dtheta, total, rtol=0.0, atol=1e-16)
        assert terms["gyro_bias"].shape == unit.dtheta.shape


def test_check_speaks_of_increments(made, tmp_path, capsys):
    command = [
        "simulate",
        str(made / "poses.csv"),
        "-o",
        str(tmp_path),
        "--no-pictures",
        "--increments",
        "--check",
    ]
    assert main([*command, "--imu", "hg9900", "--imu", "perfect:0,0,0"]) == 0
    text = capsys.readouterr().out
    assert "IMU increments" in text
    assert "hg9900 with its errors" in text
    assert "perfect increments as written" in text


def test_pictures_of_increments_are_those_of_mean_rates(made, tmp_path):
    pytest.importorskip("matplotlib")
    assert main(["simulate", str(made / "poses.csv"), "-o", str(tmp_path), "--increments"]) == 0
    assert (tmp_path / "imu.png").stat().st_size > 10_000


def test_info_says_what_they_are(made, capsys):
    assert main(["info", str(made / "ideal" / "arm.csv")]) == 0
    text = capsys.readouterr().out
    assert "IMU increments: turn, velocity, position" in text
    assert "100 Hz" in text


def drift_of(capsys, *command):
    capsys.readouterr()
    assert main(["integrate", *map(str, command), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(("kind", "position"), [("ideal", 1e-11), ("rates", 1e-8)])
def test_the_motion_comes_back(made, kind, position, tmp_path, capsys):
    truth = made / kind / "truth.npz"
    report = drift_of(
        capsys, made / kind / "arm.csv", "--truth", truth, "--imu", ARM[1], "-o", tmp_path / "motion.npz"
    )
    assert report["schema"] == "kreisel.integrate/1"
    assert report["drift"]["largest"]["position_m"] < position
    assert report["drift"]["stamps"] == 399
    assert [moment["s"] for moment in report["drift"]["after"]] == pytest.approx([1.0, 3.98])
    motion = read(tmp_path / "motion.npz")
    assert isinstance(motion, Motion)
    # The sensor is half a metre ahead of a body on a circle of 2 m.
    np.testing.assert_allclose(np.hypot(*motion.p_NB[:, :2].T), np.hypot(2.0, 0.5), atol=1e-7)


def test_a_real_unit_drifts(made, capsys):
    report = drift_of(
        capsys, made / "real" / "arm.csv", "--truth", made / "real" / "truth.npz", "--imu", ARM[1]
    )
    largest = report["drift"]["largest"]
    # A ten thousandth of a degree in a root of an hour, 4 s of it, and accelerometers that err by 1e-4 m/s^2.
    assert 1e-6 < largest["position_m"] < 0.1
    assert 1e-7 < largest["attitude_deg"] < 1e-2


def test_the_start_may_be_told_in_numbers(made, tmp_path, capsys):
    """Position, attitude and velocity of the sensor, in two worlds."""
    # Nose along +y at (2, 0), the sensor half a metre ahead of it and turned by 30 deg.
    assert main(["integrate", str(made / "ideal" / "arm.csv"), "--initial", "2,0.5,0:0,0,120:-0.5,2,0",
                 "-o", str(tmp_path / "m.npz")]) == 0  # fmt: skip
    np.testing.assert_allclose(
        np.hypot(*read(tmp_path / "m.npz").p_NB[:, :2].T), np.hypot(2.0, 0.5), atol=1e-6
    )
    assert (
        main(["convert", str(made / "ideal" / "arm.csv"), str(tmp_path / "ned.csv"), "--to-frame", "ned-frd"])
        == 0
    )
    assert main(["integrate", str(tmp_path / "ned.csv"), "--frame", "ned-frd", "--to-frame", "enu-flu",
                 "--initial", "0.5,2,0:0,0,-30:2,-0.5,0", "-o", str(tmp_path / "n.npz")]) == 0  # fmt: skip
    np.testing.assert_allclose(read(tmp_path / "n.npz").p_NB, read(tmp_path / "m.npz").p_NB, atol=1e-12)


def test_truth_of_another_rate_is_compared_where_stamps_meet(made, tmp_path, capsys):
    truth = read(made / "ideal" / "truth.npz")
    write(tmp_path / "some.npz", truth.rows(np.arange(0, 399, 5)))
    report = drift_of(capsys, made / "ideal" / "arm.csv", "--truth", tmp_path / "some.npz", "--imu", ARM[1])
    assert report["drift"]["stamps"] == 80


def test_the_screen(made, tmp_path, capsys):
    real = made / "real"
    command = ["integrate", str(real / "arm.csv"), "--truth", str(real / "truth.npz"), *ARM]
    assert main([*command, "-o", str(tmp_path / "m.csv")]) == 0
    text = capsys.readouterr().out
    assert "398 increments over 3.98 s" in text
    assert "position, m  velocity, m/s  attitude, deg" in text
    assert "after 3.98 s" in text
    assert f"written: {tmp_path / 'm.csv'}, the motion of the sensor" in text


@pytest.mark.parametrize(
    ("command", "code", "message"),
    [
        ([], 2, "integration has to begin somewhere: give --initial"),
        (["--initial", "0,0"], 2, r"--initial takes a file or X,Y,Z"),
        (["--initial", "0,0,0:0,0,90:nan,0,0"], 2, r"--initial takes a file or X,Y,Z"),
        (["--initial", "truth.np"], 1, "no such file"),
        (["--initial", "{folder}/poses.csv"], 1, "holds Poses, where a whole motion is needed"),
        (["--truth", "{folder}/ideal/arm.csv"], 1, "holds ImuIncrements, where a whole motion is needed"),
        (
            ["--truth", "{folder}/ideal/truth.npz", "-o", "{folder}/ideal/truth.npz"],
            2,
            "is one of the inputs",
        ),
        (["--truth", "{folder}/ideal/truth.npz", "-o", "m.euroc"], 2, "cannot tell the format"),
        (["--initial", "0,0,0", "--to", "euroc-imu"], 2, "--to must be one of"),
        (["--initial", "0,0,0", "--to-frame", "ned"], 2, "ned-frd"),
        (["--initial", "0,0,0", "--turning"], 2, "--turning says nothing without a place"),
    ],
)
def test_what_cannot_be_integrated_is_one_sentence(made, command, code, message, capsys):
    given = [word.format(folder=made) for word in command]
    assert main(["integrate", str(made / "ideal" / "arm.csv"), *given]) == code
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_what_is_no_imu_is_refused(made, capsys):
    assert main(["integrate", str(made / "poses.csv"), "--initial", "0,0,0"]) == 1
    assert "holds Poses, not an IMU's rates or increments" in capsys.readouterr().err


def test_units_that_cannot_be_are_refused_until_trusted(made, tmp_path, capsys):
    unit = read(made / "ideal" / "arm.csv")
    write(tmp_path / "g.csv", ImuIncrements(unit.t, unit.dtheta, unit.dv / 9.80665))
    assert main(["integrate", str(tmp_path / "g.csv"), "--initial", "0,0,0"]) == 1
    assert "it looks like g" in capsys.readouterr().err
    assert main(["integrate", str(tmp_path / "g.csv"), "--initial", "0,0,0", "--trust-units"]) == 0


def test_truth_elsewhere_in_time_is_refused(made, tmp_path, capsys):
    truth = read(made / "ideal" / "truth.npz")
    columns = (truth.p_NB, truth.v_NB, truth.a_NB, truth.R_NB, truth.omega_NB_B, truth.alpha_NB_B)
    write(tmp_path / "late.npz", Motion(truth.t + 100.0, *columns))
    command = ["integrate", str(made / "ideal" / "arm.csv"), "--initial", "0,0,0"]
    assert main([*command, "--truth", str(tmp_path / "late.npz")]) == 1
    assert "has no row at any stamp" in capsys.readouterr().err


def test_a_lost_interval_is_named(made, tmp_path, capsys):
    unit = read(made / "ideal" / "arm.csv")
    holed = np.array(unit.dtheta)
    holed[7] = np.nan
    write(tmp_path / "holed.csv", ImuIncrements(unit.t, holed, unit.dv))
    assert main(["integrate", str(tmp_path / "holed.csv"), "--initial", "0,0,0"]) == 1
    assert "dtheta must be finite to be integrated; row 7" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--place", "48,11", "--date", "2026-05-01"], "magnetometers, which have no increments"),
        (["--imu-format", "euroc-imu"], "--imu-format must be one of"),
    ],
)
def test_what_no_increments_can_have(made, options, message, tmp_path, capsys):
    command = ["simulate", str(made / "poses.csv"), "-o", str(tmp_path / "no"), "--increments", *options]
    assert main(command) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "no").exists()


def test_filters_take_their_mean_rates(made, tmp_path, capsys):
    assert main(["estimate", str(made / "ideal" / "arm.csv")]) == 1
    assert "Say --kind imu to take their mean rates" in capsys.readouterr().err
    out = tmp_path / "attitude.npz"
    assert main(["estimate", str(made / "ideal" / "arm.csv"), "--kind", "imu", "-o", str(out)]) == 0
    assert len(read(out)) == 398
