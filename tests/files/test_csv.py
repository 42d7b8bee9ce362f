"""Tables of strangers: names, units, delimiters and everything people do to them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.data.environment import STANDARD_GRAVITY


def file(folder: Path, text: str | bytes, name: str = "log.csv") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_units_in_brackets_are_converted(tmp_path: Path) -> None:
    path = file(
        tmp_path,
        "t [ms],gyro_x [deg/s],gyro_y [dps],gyro_z [rad/s],accel_x [g],accel_y [mg],accel_z [m/s²],"
        "mag_x [G],mag_y [mT],mag_z [uT]\n0,180,90,1,1,500,9,0.5,0.05,50\n10,0,0,0,0,0,0,0,0,0\n",
    )
    data = kreisel.read(path, kind="imu")
    np.testing.assert_array_equal(data.t, [0.0, 0.01])
    np.testing.assert_array_equal(data.gyro[0], [np.pi, np.pi / 2, 1.0])
    np.testing.assert_array_equal(data.accel[0], [STANDARD_GRAVITY, STANDARD_GRAVITY / 2, 9.0])
    # Half a gauss is the Earth's field: three spellings of 50 uT.
    np.testing.assert_allclose(data.mag_uT[0], [50.0, 50.0, 50.0], rtol=1e-15)


def test_a_foreign_table_is_mapped(tmp_path: Path) -> None:
    path = file(tmp_path, "Frame;Time (ms);X;Y;Z\n1;0;1000;0;-2.5\n2;10;1001;0;-2.5\n")
    data = kreisel.read(path, columns={"t": "Time (ms)", "p_x": "X [mm]", "p_y": "Y [mm]", "p_z": "#5 [mm]"})
    assert isinstance(data, kreisel.Poses)
    assert data.R_NB is None
    np.testing.assert_array_equal(data.t, [0.0, 0.01])
    np.testing.assert_array_equal(data.p_NB, [[1.0, 0.0, -0.0025], [1.001, 0.0, -0.0025]])


def test_euler_angles_in_degrees_are_intrinsic_z_y_x(tmp_path: Path) -> None:
    path = file(tmp_path, "t,x,y,z,roll [deg],pitch [deg],yaw [deg]\n0,0,0,0,0,0,90\n1,0,0,0,0,90,0\n")
    data = kreisel.read(path, kind="poses")
    # A left turn of 90 degrees points the nose north; +90 about y (left) points it down.
    np.testing.assert_allclose(data.R_NB[0] @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(data.R_NB[1] @ [1, 0, 0], [0, 0, -1], atol=1e-15)


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_delimiters_line_ends_and_marks(tmp_path: Path, delimiter: str, line_end: str, mark: bytes) -> None:
    rows = ["# made by hand", delimiter.join(["t [s]", "p_x [cm]", "p_y [m]", "p_z"]), "% noon", ""]
    rows += [delimiter.join([f"{0.1 * k!r}", f"{k}", "0", "1"]) for k in range(5)]
    data = kreisel.read(file(tmp_path, mark + (line_end.join(rows) + line_end).encode()), kind="poses")
    np.testing.assert_array_equal(data.p_NB[:, 0], np.arange(5) / 100.0)
    np.testing.assert_array_equal(data.t, [0.1 * k for k in range(5)])


def test_utf16_and_latin1_are_text_too(tmp_path: Path) -> None:
    text = "t,x,y,z,roll [°],pitch [°],yaw [°]\n0,0,0,0,0,0,90\n1,0,0,0,0,0,90\n"
    for encoding in ("utf-16", "latin-1", "utf-8-sig"):
        data = kreisel.read(file(tmp_path, text.encode(encoding)), kind="poses")
        np.testing.assert_allclose(data.R_NB[0, 1, 0], 1.0)


def test_empty_fields_of_a_recording_are_missing_samples(tmp_path: Path) -> None:
    header = "t,gx,gy,gz,ax,ay,az,mx,my,mz\n"
    path = file(
        tmp_path, header + "0,1,1,1,2,2,2,3,3,3\n1,1,1,1,2,2,2,,,\n2,,,,2,2,2, , ,\n3,1,1,1,2,2,2,3,3,3\n"
    )
    data = kreisel.read(path, kind="imu")
    assert np.isnan(data.gyro).all(axis=1).tolist() == [False, False, True, False]
    assert np.isnan(data.mag_uT).all(axis=1).tolist() == [False, True, True, False]


def test_a_commented_header_counts(tmp_path: Path) -> None:
    path = file(tmp_path, "# t, p_x [mm], p_y [mm], p_z [mm]\n0, 1000, 2000, 3000\n1, 1000, 2000, 3000\n")
    np.testing.assert_array_equal(kreisel.read(path, "csv").p_NB[0], [1.0, 2.0, 3.0])


def test_text_columns_in_between_are_passed_over(tmp_path: Path) -> None:
    path = file(tmp_path, 'state,t,"x",y,z\nok,0,1,2,3\n"flying, low",1,1,2,3\n')
    assert len(kreisel.read(path)) == 2


def test_both_poses_and_imu_need_a_word(tmp_path: Path) -> None:
    path = file(tmp_path, "t,x,y,z,gx,gy,gz,ax,ay,az\n0,1,2,3,4,5,6,7,8,9\n1,1,2,3,4,5,6,7,8,9\n")
    with pytest.raises(ValueError, match="Say which: kind"):
        kreisel.read(path)
    assert isinstance(kreisel.read(path, kind="imu"), kreisel.ImuRecording)
    assert isinstance(kreisel.read(path, kind="poses"), kreisel.Poses)


def test_rate_stands_in_for_time(tmp_path: Path) -> None:
    path = file(tmp_path, "x,y,z\n0,0,0\n1,0,0\n2,0,0\n")
    np.testing.assert_array_equal(kreisel.read(path, rate_hz=100.0).t, [0.0, 0.01, 0.02])


ROW = "0,1,2,3\n1,1,2,3\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,p_x,p_y,pz_\n" + ROW, r"no column p_z\. Did you mean 'pz_'"),
        ("t,p_x,p_y,p_z [furlong]\n" + ROW, r"column 'p_z': 'furlong' is no unit of length"),
        ("a,b,c,d\n" + ROW, r"no column by a name that is needed\..*The file has: a, b, c, d\."),
        ("x,y,z\n1,2,3\n", r"no time column"),
        ("t,x,y,z\n0,1,2,3\n1,1,2\n2,1,2,3\n", r"line 3: 3 fields where 4 are expected"),
        ("t,x,y,z\n0,1,2,3\n1,1,2\n", r"line 3: 3 fields where 4 .*cut off"),
        ("t,x,y,z\n0,1,2,3\n1,1,two,3\n", r"line 3, column 'y': 'two' is not a number"),
        ("# c\n\nt,x,y,z\n0,1,2,3\n1,1,nan,3\n", r"line 5, column 'y': the value is nan"),
        ("t,x,y,z\n0,1,2,3\n1,1,inf,3\n", r"line 3, column 'y': the value is inf"),
        ("t,x,y,z\n0,1,2,3\n0,1,2,3\n", r"line 3, column 't': time stands still, from 0 to 0"),
        ("t,x,y,z\n1,1,2,3\n0,1,2,3\n", r"line 3, column 't': time runs back, from 1 to 0"),
        ("t,x,y,z\n0,1,2,3\nnan,1,2,3\n", r"line 3, column 't': the time stamp is 'nan'"),
        ("t,x,y,z\nzero,1,2,3\n1,1,2,3\n", r"line 2, column 't': 'zero' is not a number"),
        ("t,x,y,z\n0,1,2,3\n٠.٥,1,2,3\n", r"line 3, column 't': '٠.٥' is not a number"),
        (
            f"t,x,y,z\n0,1,2,3\n0.{'1' * 60},1,2,3\n",
            r"line 3, column 't': the time stamp has 48 characters or more",
        ),
        ("t;x;y;z\n0,0;1,5;2;3\n", r"column 't': '0,0' is not a number.*decimal comma"),
        ("t,x,y,z\n0,0,1,5,2,0,3,1\n", r"line 2: 8 fields where 4 .*decimal commas"),
        ("timestamp,x,y,z\n1403715524907143168,1,2,3\n", r"looks like ns.*--column t='timestamp \[ns\]'"),
        ("t,x,y,z,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n1,1,2,3,1,1,0,0\n", r"line 3.*length 1\.414"),
        ("t,x,y,z,roll,pitch,yaw\n0,1,2,3,0,0,0\n", r"column 'roll' has no unit"),
        ("t,x,px,y,z\n0,1,2,3,4\n", r"both 'x' and 'px' could be p_x"),
        ("t,x,y,z\n", r"a header but no rows"),
    ],
)
def test_mistakes_are_named_with_their_place(tmp_path: Path, text: str, message: str) -> None:
    path = file(tmp_path, text)
    with pytest.raises(ValueError, match=message) as caught:
        kreisel.read(path)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"p_w": "x"}, "'p_w' is not one of our columns. Did you mean 'q_w'"),
        ({"p_x": "xx"}, r"no column 'xx' for p_x\. Did you mean 'x'"),
        ({"p_x": "#9"}, "no column '#9'"),
        ({"p_x": "x [deg]"}, "'deg' is no unit of length"),
    ],
)
def test_a_wrong_mapping_is_explained(tmp_path: Path, columns: dict[str, str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        kreisel.read(file(tmp_path, "t,x,y,z\n" + ROW), columns=columns)


def test_a_line_cut_in_its_last_number_is_pointed_out(tmp_path: Path) -> None:
    whole = "t,x,y,z\n" + "".join(f"{k},1.25,2.25,3.25\n" for k in range(5))
    with pytest.warns(UserWarning, match="line 6.*may have been cut off"):
        kreisel.read(file(tmp_path, whole[:-4]))


def test_a_whole_last_number_without_line_end_is_none_of_anybodys_business(tmp_path: Path) -> None:
    kreisel.read(file(tmp_path, "t,x,y,z\n" + "\n".join(f"{k},1.25,2.25,3.25" for k in range(5))))


def test_a_foreign_epoch_in_seconds_is_exact(tmp_path: Path) -> None:
    path = file(tmp_path, "time,x,y,z\n1403715524.907143168,1,2,3\n1403715524.912143104,1,2,3\n")
    data = kreisel.read(path)
    assert data.t0_ns == 1403715524907143168
    assert data.t[1] == 4999936 / 1e9
