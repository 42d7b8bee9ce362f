"""`kreisel live`: lines in, attitude out while they come, whatever else a serial port says in between."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli.lines import Lines
from kreisel.cli.main import main
from tests.trials import turning_trial

SOURCE = Path(__file__).resolve().parents[2] / "src"
RECORDING = turning_trial(3.0).recording


def row(k: int, separator: str = " ") -> str:
    r = RECORDING
    assert r.mag_uT is not None
    numbers = (r.t[k], *r.gyro[k], *r.accel[k], *r.mag_uT[k])
    return separator.join(repr(float(x)) for x in numbers)


PLAIN = [row(k) for k in range(len(RECORDING))]


@pytest.fixture
def live(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]):
    """Runs the command on lines: (exit code, table of what it printed, what it told)."""

    def run(lines: list[str], *arguments: str) -> tuple[int, np.ndarray, str]:
        path = tmp_path / "lines.txt"
        path.write_text("\n".join(lines) + "\n")
        with path.open() as stdin:
            monkeypatch.setattr(sys, "stdin", stdin)
            code = main(["live", *arguments])
        out, err = capfd.readouterr()
        return code, np.array([line.split() for line in out.splitlines()], dtype=float).reshape(-1, 5), err

    return run


def test_every_sample_has_the_attitude_that_a_run_gives_it(live, tmp_path: Path) -> None:
    code, table, err = live(PLAIN, "-o", str(tmp_path / "kept.npz"))
    ours = kreisel.run(kreisel.DcmFilter(), RECORDING)
    assert code == 0 and err.startswith("kreisel: 300 samples over 2.99 s at 100 Hz\n")
    np.testing.assert_array_equal(table[:, 0], RECORDING.t)
    # Nine decimals are printed.
    np.testing.assert_allclose(table[:, 1:], ours.quat_wxyz, atol=0.6e-9)
    np.testing.assert_array_equal(kreisel.read(tmp_path / "kept.npz").R_NS, ours.R_NS)


def test_units_come_from_options_or_from_the_header(live) -> None:
    scales = np.array([1e3, *3 * [180 / np.pi], *3 * [1 / 9.80665], *3 * [0.01]])
    foreign = [" ".join(map(repr, (np.array(line.split(), float) * scales).tolist())) for line in PLAIN]
    _, plain, _ = live(PLAIN)
    units = ("--time-unit", "ms", "--gyro-unit", "dps", "--accel-unit", "g", "--mag-unit", "gauss")
    header = "t [ms],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g],mx [G],my [G],mz [G]"
    mixed = "t,gx,gy,gz,ax [g],ay [g],az [g],mx [G],my [G],mz [G]"
    commas = [line.replace(" ", ",") for line in foreign]
    for lines, options in (
        (foreign, units),
        ([header, *commas], ()),
        (["# " + header, *commas], ()),
        ([header.replace(",", " "), *foreign], ()),
        ([mixed, *commas], units[:4]),
    ):
        code, table, _ = live(lines, *options)
        # Units back and forth cost some ulps, which the filter's windows do not amplify.
        assert code == 0
        np.testing.assert_allclose(table, plain, atol=1e-8)


def test_lines_without_time_have_a_rate(live) -> None:
    _, plain, _ = live([line.split(" ", 1)[1] for line in PLAIN], "--rate", "100")
    np.testing.assert_allclose(plain[:, 0], RECORDING.t, atol=1e-12)
    code, table, err = live([line.split(" ", 1)[1] for line in PLAIN])
    assert code == 1 and not len(table)
    assert "no sample" in err and "300 of 300 lines skipped; the first: line 1, 9 numbers and no time" in err


def test_columns_of_other_lines(live) -> None:
    lines = [f"IMU;{line.replace(' ', ';')};ok" for line in PLAIN]
    names = ["t", *(f"{s}_{a}" for s in ("gyro", "accel", "mag") for a in "xyz")]
    _, table, _ = live(lines, *(f"--column={name}=#{k}" for k, name in enumerate(names, start=2)))
    np.testing.assert_array_equal(table, live(PLAIN)[1])


def test_what_is_no_sample_is_skipped_and_told(live) -> None:
    boot = [
        "ets Jul 29 2019 12:21:46",
        "clk_drv:0x00,q_drv:0x00,d_drv:0x00,cs0_drv:0x00,hd_drv:0x00,wp_drv:0x00",
        "",
        "# a remark",
    ]
    odd = [PLAIN[3][:20], PLAIN[4].replace(" ", " x", 1), PLAIN[2], "\x00\ufffd\ufffd"]
    code, table, err = live([*boot, *PLAIN[:5], *odd, *PLAIN[5:]])
    assert code == 0
    np.testing.assert_array_equal(table, live(PLAIN)[1])
    assert "6 of 306 lines skipped; the first: line 1, 5 fields where 7 or 10 are expected\n" in err


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        (row(8).replace(" ", " x", 1), "is not a number"),
        (row(5), "time stands still at '0.05'"),
        (row(4), "time runs back at '0.04'"),
        ("inf " + row(8).split(" ", 1)[1], "the time 'inf' cannot be"),
        ("1e30 " + row(8).split(" ", 1)[1], "say --time-unit"),
        ("0.055 1 2 inf 0 0 9.8", "gyro_z is inf"),
        ("0.055 1 2", "3 fields where 7 or 10"),
    ],
)
def test_each_complaint_names_the_line_and_the_cause(line: str, complaint: str) -> None:
    lines = Lines()
    found = list(lines.over([*PLAIN[:6], line, *PLAIN[6:9]]))
    assert [s.t for s in found if s] == list(RECORDING.t[:9])
    assert lines.told().startswith("1 of 10 lines skipped; the first: line 7, ") and complaint in lines.told()


def test_a_first_line_without_its_beginning_is_no_sample() -> None:
    lines = Lines()
    cut = " ".join(PLAIN[0].split()[3:])
    assert [s.t for s in lines.over([cut, *PLAIN[1:3]]) if s] == list(RECORDING.t[1:3])
    assert "line 1, whose beginning is missing" in lines.told()
    # One line alone is believed.
    assert len(list(Lines().over(PLAIN[:1]))) == 1


def test_a_magnetometer_may_be_slower_and_samples_may_lack() -> None:
    short = " ".join(PLAIN[2].split()[:7])
    a, b, c = (s for s in Lines().over([*PLAIN[:2], short]) if s)
    assert np.isfinite([*a.mag_uT, *b.mag_uT]).all() and np.isnan(c.mag_uT).all() and c.gyro
    header = "t,gx,gy,gz,ax,ay,az"
    (lacking,) = (s for s in Lines().over([header, "0,,,,1,2,9"]) if s)
    assert np.isnan(lacking.gyro).all() and lacking.accel == (1.0, 2.0, 9.0)


def test_a_clock_that_begins_anew_goes_on() -> None:
    # Ten stamps behind the clock are a board that was reset; the tenth follows the latest by a usual step.
    lines = Lines()
    t = np.array([s.t for s in lines.over([*PLAIN[100:150], *PLAIN[:50]]) if s])
    assert len(t) == 50 + 41 and lines.skipped == 9
    np.testing.assert_allclose(np.diff(t), 0.01, atol=1e-12)
    # A header says so at once.
    header = "t,gx,gy,gz,ax,ay,az,mx,my,mz"
    commas = [line.replace(" ", ",") for line in PLAIN]
    lines = Lines()
    t = np.array([s.t for s in lines.over([header, *commas[100:150], header, *commas[:50]]) if s])
    assert len(t) == 100 and not lines.skipped
    np.testing.assert_allclose(np.diff(t), 0.01, atol=1e-12)


def test_epoch_stamps_keep_their_nanoseconds(live) -> None:
    rest = " 0 0 0 0 0 9.8"
    lines = Lines({"t": "ns"})
    a, b = (s for s in lines.over([f"1700000000000000001{rest}", f"1700000000005000003{rest}"]) if s)
    assert lines.t0_ns == 1700000000000000001 and a.t == 0.0
    assert b.t == b.dt == 5000002 / 1e9


@pytest.mark.parametrize(
    ("lines", "arguments", "message"),
    [
        (["t,gx,gy,gz,ax,ay,az", *["0,0,0,0,0,0,1"] * 3], (), "it looks like g"),
        (["t,gx [furlong],gy,gz,ax,ay,az"], (), "'furlong' is no unit of rate"),
        (["t,gx,gy,gz,p,q,r"], (), "line 1: the header has no column accel_x"),
        (["gx,gy,gz,ax,ay,az"], (), "the header has no time"),
        (PLAIN, ("--gyro-unit", "rpm"), "'rpm' is no unit of rate"),
        (PLAIN, ("--rate", "0"), "--rate must be"),
        (PLAIN, ("-o", "no/such/folder.tum"), "does not exist"),
        (PLAIN, ("-o", "a.tum", "--to", "tumm"), "Did you mean 'tum'"),
    ],
)
def test_mistakes_are_one_line(live, lines, arguments, message) -> None:
    code, _, err = live(lines, *arguments)
    typed = {"--gyro-unit", "--rate", "--to"} & {*arguments}
    assert code == (2 if typed else 1) and message in err and err.count("\n") == 1, err


def test_units_that_cannot_be_may_be_insisted_on(live) -> None:
    line = ["0 0 0 0 0 0 1"]
    assert live(line)[0] == 1
    assert live(line, "--trust-units")[0] == 0


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT to another process")
def test_ctrl_c_ends_a_stream_that_goes_on_with_its_summary(tmp_path: Path) -> None:
    kept = tmp_path / "kept.tum"
    process = subprocess.Popen(
        [sys.executable, "-m", "kreisel", "live", "-o", str(kept)],
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write("\n".join(PLAIN[:21]) + "\n")
    process.stdin.flush()
    # A line is there as soon as its sample was: the pipe is still open.
    first = [process.stdout.readline() for _ in range(21)]
    assert first[-1].startswith("0.2 ")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0 and "21 samples over 0.2 s" in err and f"written: {kept}" in err
    assert len(kreisel.read(kept)) == 21


@pytest.mark.skipif(os.name != "posix", reason="needs a pseudo-terminal")
def test_a_terminal_shows_the_angles_of_a_pilot() -> None:
    import pty

    ours, theirs = pty.openpty()
    environment = {**os.environ, "PYTHONPATH": str(SOURCE), "TERM": "xterm", "COLUMNS": "100", "LINES": "30"}
    process = subprocess.Popen(
        [sys.executable, "-m", "kreisel", "live"],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=theirs,
        stderr=subprocess.PIPE,
    )
    os.close(theirs)
    assert process.stdin is not None
    # Nose north (the field lies along x), 30 deg up: gravity's reaction is (g sin 30, 0, g cos 30).
    rows = [f"{k / 100} 0 0 0 4.903 0 8.493 {20 * 0.866} 0 {-20 * 0.5}" for k in range(50)]
    process.stdin.write("".join(f"{r}\n" for r in rows).encode())
    process.stdin.close()
    shown = b""
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        shown += piece
    os.close(ours)
    assert process.wait(timeout=60) == 0
    text = shown.decode()
    assert "heading" in text and "nose up" in text and "+30.0" in text and "50 samples" in text
