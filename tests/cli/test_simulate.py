"""`kreisel simulate` and `kreisel demo` as a user runs them, with good files and bad ones."""

import re
from importlib.util import find_spec

import numpy as np
import pytest

from kreisel.cli.commands.simulate import parse_mount
from kreisel.cli.main import main
from kreisel.data.trajectory import Poses
from kreisel.files.doors import read, write
from kreisel.maths.rotations import matrix_from_euler


def circle(n=200, rate=50.0):
    """Two metres of radius at one radian per second, nose along the path: 2 m/s^2 to the left."""
    t = np.arange(n) / rate
    p = np.stack([2.0 * np.cos(t), 2.0 * np.sin(t), np.zeros(n)], axis=1)
    return Poses(t, p, matrix_from_euler(np.stack([0 * t, 0 * t, t + np.pi / 2], axis=1)))


@pytest.fixture
def poses(tmp_path):
    path = tmp_path / "circle.csv"
    write(path, circle())
    return path


def test_a_pose_file_becomes_a_folder(poses, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["simulate", str(poses), "-o", str(out)]) == 0
    assert sorted(p.name for p in out.iterdir()) == [
        "angular.png", "imu.csv", "imu.png", "linear.png", "path.png", "truth.npz", "truth.tum",
    ]  # fmt: skip
    text = capsys.readouterr().out
    assert "200 poses" in text
    assert "interpolated" in text
    for path in out.iterdir():
        assert path.name in text
    recording = read(out / "imu.csv", kind="imu")
    # A spline of degree 9 on 50 samples a radian: round-off.
    np.testing.assert_allclose(recording.gyro, np.tile([0, 0, 1.0], (200, 1)), atol=1e-8)
    np.testing.assert_allclose(recording.accel, np.tile([0, 2.0, 9.80665], (200, 1)), atol=1e-6)


def test_rate_mounts_and_orientation(poses, tmp_path):
    out = tmp_path / "out"
    options = [
        "--rate",
        "400",
        "--imu",
        "nose:0.5,0,0",
        "--imu",
        "-0.5,0,0:0,0,180",
        "--orientation",
        "tangent",
    ]
    assert main(["simulate", str(poses), "-o", str(out), "--no-pictures", *options]) == 0
    nose, tail = read(out / "nose.csv", kind="imu"), read(out / "imu2.csv", kind="imu")
    np.testing.assert_allclose(np.diff(nose.t), 1.0 / 400.0, atol=1e-9)
    # At constant rate half a metre ahead adds omega^2 r = 0.5 m/s^2 towards the tail; turned by half a turn
    # the sensor in the tail reads the mirror image.
    np.testing.assert_allclose(nose.accel, np.tile([-0.5, 2.0, 9.80665], (len(nose), 1)), atol=1e-5)
    np.testing.assert_allclose(tail.accel, np.tile([-0.5, -2.0, 9.80665], (len(tail), 1)), atol=1e-5)


def test_check_integrates_the_data_back(poses, tmp_path, capsys):
    out = str(tmp_path / "out")
    imus = ["--imu", "nose:0.5,0,0", "--imu", "tail:-0.5,0,0"]
    assert main(["simulate", str(poses), "-o", out, "--no-pictures", "--check", *imus]) == 0
    text = capsys.readouterr().out
    found = re.findall(r"(\w+) ideal (rates|increments) +(\S+) m, (\S+) m/s, (\S+) deg", text)
    assert [(name, kind) for name, kind, *_ in found] == [
        (name, kind) for name in ("nose", "tail") for kind in ("rates", "increments")
    ]
    # A circle at constant rate, 50 samples a radian, back to what its spline knows of it over 4 s.
    assert all(float(p) < 1e-6 and float(v) < 1e-6 and float(turn) < 1e-6 for *_, p, v, turn in found)


def test_check_tells_what_a_sensor_drifts_from_what_the_method_loses(poses, tmp_path, capsys):
    command = ["simulate", str(poses), "-o", str(tmp_path / "out"), "--no-pictures", "--check"]
    assert main([*command, "--imu", "mpu6050", "--imu", "perfect:0,0,0"]) == 0
    text = capsys.readouterr().out
    found = {
        kind: float(p) for kind, p in re.findall(r"mpu6050 (ideal rates|with its errors) +(\S+) m,", text)
    }
    # Its accelerometers are off by 0.5 m/s^2, which makes a metre and more in 4 s.
    assert found["ideal rates"] < 1e-6 < 0.1 < found["with its errors"]
    assert "perfect with" not in text


def test_ned_in_and_out(poses, tmp_path):
    ned = tmp_path / "ned.csv"
    assert main(["convert", str(poses), str(ned), "--to-frame", "ned-frd"]) == 0
    out = tmp_path / "out"
    command = [
        "simulate",
        str(ned),
        "-o",
        str(out),
        "--frame",
        "ned-frd",
        "--to-frame",
        "ned-frd",
        "--no-pictures",
    ]
    assert main(command) == 0
    recording = read(out / "imu.csv", kind="imu")
    # The same left turn in forward-right-down: yaw rate and centripetal acceleration change their signs.
    np.testing.assert_allclose(recording.accel, np.tile([0, -2.0, -9.80665], (200, 1)), atol=1e-6)
    np.testing.assert_allclose(recording.gyro, np.tile([0, 0, -1.0], (200, 1)), atol=1e-8)


def test_a_lever_arm_is_in_the_axes_of_the_input(poses, tmp_path):
    ned = tmp_path / "ned.csv"
    assert main(["convert", str(poses), str(ned), "--to-frame", "ned-frd"]) == 0
    ours = ["simulate", str(poses), "-o", str(tmp_path / "ours"), "--imu", "0.3,-0.2,-0.1:10,-20,-30"]
    theirs = ["simulate", str(ned), "-o", str(tmp_path / "theirs"), "--imu", "0.3,0.2,0.1:10,20,30"]
    assert main([*ours, "--no-pictures"]) == 0
    assert main([*theirs, "--frame", "ned-frd", "--no-pictures"]) == 0
    left, right = (read(tmp_path / folder / "imu.csv", kind="imu") for folder in ("ours", "theirs"))
    # Right of and below the origin in either; what differs is round-off through the splines.
    np.testing.assert_allclose(left.accel, right.accel, atol=1e-8)
    np.testing.assert_allclose(left.gyro, right.gyro, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "name", "p_BS"),
    [
        ("1,2,3", "imu", [1, 2, 3]),
        ("wrist:-0.1,0,.5", "wrist", [-0.1, 0, 0.5]),
        ("-1e-3,0,0:0,0,90", "imu", [-1e-3, 0, 0]),
    ],
)
def test_mounts_are_read(text, name, p_BS):
    mount = parse_mount(text)
    assert mount.name == name
    np.testing.assert_array_equal(mount.p_BS, p_BS)


@pytest.mark.parametrize(
    "text",
    [
        *("", "1,2", "a:b", "1,2,3:4", ":1,2,3", "1,2,3:0,0,1:2", "x:1,2,nan", "nan,0,0"),
        *("../x:1,2,3", "..:1,2,3", "-x:1,2,3", "a\nb:1,2,3", ".x:1,2,3", "truth:1,2,3", "Path:1,2,3"),
    ],
)
def test_mounts_that_cannot_be_are_refused(text, poses, tmp_path, capsys):
    assert main(["simulate", str(poses), "-o", str(tmp_path / "out"), f"--imu={text}"]) == 2
    assert not (tmp_path / "out").exists()
    err = capsys.readouterr().err
    assert err.startswith("kreisel: ") and ("IMU" in err or "--imu" in err)


def test_imus_that_would_share_a_file_are_refused(poses, tmp_path, capsys):
    options = ["--imu", "a:0,0,0", "--imu", "A:1,0,0"]
    assert main(["simulate", str(poses), "-o", str(tmp_path / "out"), *options]) == 2
    assert not (tmp_path / "out").exists()
    assert "two files would be called 'A.csv'" in capsys.readouterr().err


def test_formats_that_hold_no_imu_are_refused_before_anything_is_written(poses, tmp_path, capsys):
    assert main(["simulate", str(poses), "-o", str(tmp_path / "out"), "--imu-format", "tum"]) == 2
    assert not (tmp_path / "out").exists()
    error = capsys.readouterr().err
    assert "one of 'csv', 'euroc-imu'," in error and "got 'tum'" in error


def test_a_write_protected_file_is_left_alone(poses, tmp_path, capsys):
    (tmp_path / "imu.csv").write_text("precious")
    (tmp_path / "imu.csv").chmod(0o444)
    assert main(["simulate", str(poses), "-o", str(tmp_path)]) == 1
    assert "imu.csv: the file is write-protected" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["circle.csv", "imu.csv"]


@pytest.mark.parametrize("command", ["simulate x.csv -o", "demo -o", "run x.toml -o", "evaluate a b -o"])
def test_an_empty_folder_name_is_refused(command, capsys):
    assert main([*command.split(), ""]) == 2
    assert "takes the name of a folder" in capsys.readouterr().err


def bad_file(tmp_path, text):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    return path


HEADER = "t [s],p_x [m],p_y [m],p_z [m]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        (HEADER, "no rows"),
        (HEADER + "0,0,0,0\n1,nan,0,0\n", "line 3"),
        (HEADER + "0,0,0,0\n0,1,0,0\n", "stands still"),
        (HEADER + "0,0,0,0\n1,1,0\n", "line 3"),
        (HEADER + "0,0,0,0\n1,1,0,0\n", "at least 6 samples of positions; got 2"),
        ("time,x,y\n1,2,3\n", "bad.csv"),
    ],
)
def test_bad_files_end_in_one_line_and_exit_code_1(tmp_path, capsys, text, message):
    code = main(["simulate", str(bad_file(tmp_path, text)), "-o", str(tmp_path / "out")])
    err = capsys.readouterr().err
    assert code == 1
    assert message in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_file_where_the_folder_would_be_is_named(poses, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["simulate", str(poses), "-o", str(tmp_path / "file" / "out"), "--no-pictures"]) == 2
    assert f"--output must be a folder; {tmp_path / 'file'} is a file." in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["simulte"], "did you mean 'simulate'"),
        (["simulate", "x.csv", "-o", "y", "--methd", "auto"], "did you mean '--method'"),
        (["simulate", "x.csv"], "-o/--output"),
    ],
)
def test_mistyped_commands_get_a_suggestion_and_exit_code_2(arguments, message, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert message in capsys.readouterr().err


def test_method_and_frame_names_are_checked(poses, tmp_path, capsys):
    out = str(tmp_path / "out")
    assert main(["simulate", str(poses), "-o", out, "--method", "smoth"]) == 2
    assert "Did you mean 'smooth'" in capsys.readouterr().err
    assert main(["simulate", str(poses), "-o", out, "--frame", "ned"]) == 2
    assert "ned-frd" in capsys.readouterr().err
    assert main(["simulate", str(poses), "-o", out, "--rate", "-5"]) == 2
    assert "--rate must be a number of hertz above 0" in capsys.readouterr().err


def test_the_demo_makes_what_it_says(tmp_path, capsys):
    assert main(["demo", "-o", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    names = {
        "imu.csv",
        "imu-errors.npz",
        "truth.tum",
        "truth.npz",
        "path.png",
        "linear.png",
        "angular.png",
        "imu.png",
        "motion.gif",
        "eight_imu.csv",
        "eight_attitude.tum",
        "eight_attitude.png",
        "eight_errors.png",
        *(["eight_report.html"] if find_spec("bokeh") else []),
    }
    assert {p.name for p in tmp_path.iterdir()} == names
    assert all(name in text for name in names)
    recording = read(tmp_path / "imu.csv", kind="imu")
    assert len(recording) == 1001
    assert np.isfinite(recording.accel).all()


def simulate(poses, out, *options):
    return main(["simulate", str(poses), "-o", str(out), "--no-pictures", *options])


def test_a_bare_sensor_sits_at_the_origin_and_leaves_its_error_terms(poses, tmp_path, capsys):
    out = tmp_path / "out"
    assert simulate(poses, out, "--imu", "bmi088", "--seed", "7") == 0
    assert "bmi088, seed 7" in capsys.readouterr().out
    measured = read(out / "bmi088.csv", kind="imu")
    terms = np.load(out / "bmi088-errors.npz")
    for sensor in ("gyro", "accel"):
        added = [terms[name] for name in terms.files if name.startswith(f"{sensor}_error_")]
        # Nine digits in the file.
        np.testing.assert_allclose(
            getattr(measured, sensor), terms[f"ideal_{sensor}"] + sum(added), atol=1e-6
        )
    np.testing.assert_array_equal(terms["gyro_bias"], terms["gyro_error_turn_on_bias"])
    assert {"gyro_error_white_noise", "accel_error_quantisation"} <= set(terms.files)
    assert terms["seed"] == 7


def test_sensors_are_placed_and_the_seed_decides(poses, tmp_path):
    placed = ["--sensor", "stim300", "--imu", "bmi088@0.5,0,0:0,0,180", "--imu", "tail:-0.5,0,0"]
    for folder, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        assert simulate(poses, tmp_path / folder, "--seed", seed, *placed) == 0
    a, b, c = ((tmp_path / folder / "tail.csv").read_text() for folder in "abc")
    assert a == b != c
    terms = np.load(tmp_path / "a" / "bmi088-errors.npz")
    # Half a metre ahead at 1 rad/s, turned by half a turn.
    np.testing.assert_allclose(terms["ideal_accel"], np.tile([0.5, -2.0, 9.80665], (200, 1)), atol=1e-5)
    assert "gyro_error_bias_instability" in np.load(tmp_path / "a" / "tail-errors.npz").files


def test_error_terms_turn_with_the_world(poses, tmp_path):
    for world in ("enu-flu", "matlab"):
        assert simulate(poses, tmp_path / world, "--imu", "bmi088", "--to-frame", world) == 0
    ours, theirs = (np.load(tmp_path / world / "bmi088-errors.npz") for world in ("enu-flu", "matlab"))
    # FRD: y and z change sign; MATLAB's accelerometer is the negative of ours on top of that.
    np.testing.assert_array_equal(
        theirs["gyro_error_white_noise"], ours["gyro_error_white_noise"] * [1, -1, -1]
    )
    np.testing.assert_array_equal(
        theirs["accel_error_white_noise"], ours["accel_error_white_noise"] * [-1, 1, 1]
    )


def test_kalibr_and_preset_files_are_sensors_too(poses, tmp_path):
    kalibr = tmp_path / "imu.yaml"
    kalibr.write_text(
        "gyroscope_noise_density: 1.0e-4\ngyroscope_random_walk: 1.0e-6\naccelerometer_noise_density: 1.0e-3\n"
        "accelerometer_random_walk: 1.0e-5\nupdate_rate: 200.0\n"
    )
    out = tmp_path / "out"
    assert simulate(poses, out, "--sensor", str(kalibr)) == 0
    assert "gyro_error_bias_random_walk" in np.load(out / "imu-errors.npz").files


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--imu", "bmi08"], "Did you mean 'bmi088'"),
        (["--sensor", "bmi08"], "Did you mean 'bmi088'"),
        (["--imu", "bmi088", "--imu", "bmi088"], "two files would be called 'bmi088.csv'"),
        (["--imu", "bmi088@here"], "--imu takes"),
        (["--imu", "bmi088", "--seed", "-1"], "--seed must be a whole number, 0 or more"),
        (["--sensor", "none.yaml"], "cannot read none.yaml"),
        (
            ["--imu", "a:0,0,0", "--imu", "a-errors:0,0,0", "--sensor", "bmi088", "--imu-format", "npz"],
            "two files would be called 'a-errors.npz'",
        ),
    ],
)
def test_sensors_that_cannot_be(poses, tmp_path, capsys, options, message):
    assert simulate(poses, tmp_path / "out", *options) == (1 if "none.yaml" in options else 2)
    assert message in capsys.readouterr().err


# --- on the Earth ---


@pytest.fixture
def standing(tmp_path):
    """A body at rest, its nose to the north."""
    path = tmp_path / "standing.csv"
    t = np.arange(100) / 50.0
    north = matrix_from_euler(np.array([0.0, 0.0, np.pi / 2.0]))
    write(path, Poses(t, np.zeros((100, 3)), np.tile(north, (100, 1, 1))))
    return path


def test_a_place_a_date_and_the_turning_earth(standing, tmp_path, capsys):
    out = tmp_path / "out"
    place = ["--place", "48.14,11.58,520", "--date", "2026-05-01", "--turning"]
    assert main(["simulate", str(standing), "-o", str(out), "--no-pictures", "--check", *place]) == 0
    told = capsys.readouterr().out
    assert "gravity 9.80743 m/s^2; N turns with the Earth, 15.04 deg/h" in told
    assert "magnetic field 48.8 uT, dip 64.4 deg" in told
    assert "declination 4.31 deg east of true north (tell filters by --declination-deg 4.31)" in told
    assert "magnetometer (uT) of imu" in told
    recording = read(out / "imu.csv", kind="imu")
    latitude = np.deg2rad(48.14)
    rate = 7.292115e-5 * np.array([np.cos(latitude), 0.0, np.sin(latitude)])
    # Forward is north, left is west: the field lies 4.31 deg to the right. Splines through equal poses: round-off.
    np.testing.assert_allclose(recording.gyro, np.tile(rate, (100, 1)), atol=1e-12)
    assert np.rad2deg(np.arctan2(-recording.mag_uT[:, 1], recording.mag_uT[:, 0])) == pytest.approx(
        4.31, abs=0.01
    )
    # --check knows that it turned: else rest would seem to turn by 8e-3 deg in 2 s.
    assert all(float(turn) < 1e-10 for turn in re.findall(r"m/s, (\S+) deg", told))


def test_west_and_south_are_written_so_that_they_can_be_copied(standing, tmp_path, capsys):
    place = ["--place=-33.93,18.42", "--date", "2026-05-01", "--no-pictures"]
    assert main(["simulate", str(standing), "-o", str(tmp_path / "out"), *place]) == 0
    assert re.search(
        r"deg west of true north \(tell filters by --declination-deg=-\d", capsys.readouterr().out
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--date", "2026-05-01"], "--date says nothing without a place; give --place LAT,LON too."),
        (["--turning"], "--turning says nothing without a place"),
        (["--place", "48"], "--place takes LAT,LON or LAT,LON,HEIGHT, such as 48.14,11.58,520; got '48'."),
        (["--place", "91,0"], "--place: latitude_deg must be one number, from -90 to 90, deg; got 91.0."),
        (["--place", "nan,0"], "latitude_deg must be a finite number; got nan."),
        (["--place", "48,11", "--date", "1999-01-01"], "--place: date: no magnetic model covers 1999-01-01"),
        (["--place", "48,11", "--date", "May"], "date must be a date, such as 2026-05-01; got 'May'."),
    ],
)
def test_places_and_dates_that_are_none_end_in_one_line(options, message, standing, tmp_path, capsys):
    assert main(["simulate", str(standing), "-o", str(tmp_path / "out"), *options]) == 2
    err = capsys.readouterr().err
    assert err.startswith("kreisel: ") and err.count("\n") == 1
    assert message in err
    assert not (tmp_path / "out").exists()


def test_noise_and_gaps_can_be_told_on_the_command_line(tmp_path, capsys):
    t = np.arange(200) / 100.0
    rng = np.random.default_rng(1)
    p = np.stack([np.sin(t), np.cos(t), 0.1 * t], axis=1) + 1e-3 * rng.normal(size=(200, 3))
    kept = (t < 0.8) | (t > 1.2)
    file = tmp_path / "poses.csv"
    write(file, Poses(t[kept], p[kept]))
    arguments = ["simulate", str(file), "-o", str(tmp_path / "out"), "--no-pictures"]
    assert main(arguments) == 1
    # 0.8 is within half a rounding of the last stamp that is kept.
    assert re.search(r"no positions from t = 0\.(79|8) to 1\.21 s.*--max-gap", capsys.readouterr().err)
    assert main([*arguments, "--max-gap", "0.5", "--noise", "1/1/2mm"]) == 0
    out = capsys.readouterr().out
    assert "positions smoothed for noise of 1 / 1 / 2 mm; they show" in out and "bridged" in out
    recording = read(tmp_path / "out" / "imu.csv", kind="imu")
    assert recording.accel_sigma is not None and recording.gyro_sigma is not None


@pytest.mark.parametrize(
    ("noise", "message"),
    [
        ("0.1", "numbers with their unit"),
        ("0.1mm,1deg,3s", "LENGTH[,ANGLE]"),
        ("0.1/0.2mm", "one number or three"),
        ("0.1deg", "'deg' is no unit of length"),
        ("0mm", "--noise must be above 0"),
        ("-1mm", "--noise must be above 0"),
    ],
)
def test_noise_that_cannot_be_is_refused(tmp_path, capsys, noise, message):
    t = np.arange(50) / 100.0
    write(tmp_path / "poses.csv", Poses(t, np.stack([t, t, t], axis=1)))
    source, out = str(tmp_path / "poses.csv"), str(tmp_path / "out")
    assert main(["simulate", source, "-o", out, f"--noise={noise}", "--no-pictures"]) == 2
    assert message in capsys.readouterr().err
