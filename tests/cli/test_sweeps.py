"""Many files at once: the same bytes and words in the same order, wherever and however many at a time."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli import memory
from kreisel.cli.batch import SHOWN
from kreisel.cli.main import main
from tests.study.engine import by_hand
from tests.trials import turning_trial

pytestmark = pytest.mark.filterwarnings("always:.*may have been cut off")

RECORDING = turning_trial(2.0).recording

GAUSS = replace(RECORDING, mag_uT=RECORDING.mag_uT / 100.0)  # a doubt, told in a note

RUNS = ("run1", "run2", "run3", "run4", "run5")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Recordings of one name in folders of their own; the second is none, two are doubtful, the last is cut off."""
    for k, run in enumerate(RUNS):
        (tmp_path / "rec" / run).mkdir(parents=True)
        made = GAUSS if run in ("run3", "run4") else RECORDING
        kreisel.write(tmp_path / "rec" / run / "imu.csv", made.rows(slice(0, 200 - 10 * k)))
    (tmp_path / "rec" / "run2" / "imu.csv").write_text("t,gyro_x\n0,1\n")
    last = tmp_path / "rec" / "run5" / "imu.csv"
    last.write_text(last.read_text().rstrip()[:-12])
    return tmp_path


def swept(capsys: pytest.CaptureFixture[str], *options: str) -> tuple[int, dict, list[str], dict[str, bytes]]:
    """Exit code, JSON, stderr and files of a sweep over rec/."""
    capsys.readouterr()
    code = main(["estimate", "rec/**/*.csv", "-o", "out/", "--to", "npz", "--json", *options])
    streams = capsys.readouterr()
    files = {p.parent.name: p.read_bytes() for p in sorted(Path("out").rglob("*")) if p.is_file()}
    return code, json.loads(streams.out), streams.err.splitlines(), files


def test_threads_make_no_difference(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    one = swept(capsys, "--threads", "1")
    code, report, told, files = one
    assert code == 1
    good = [run for run in RUNS if run != "run2"]
    assert [file["file"] for file in report["files"]] == [f"rec/{run}/imu.csv" for run in good]
    assert [file["output"] for file in report["files"]] == [f"out/{run}/imu.npz" for run in good]
    assert [file["samples"] for file in report["files"]] == [200, 180, 170, 160]
    assert sorted(files) == good and not Path("out/run2").exists()
    alone = kreisel.run(kreisel.DcmFilter(), kreisel.read("rec/run4/imu.csv"))
    np.testing.assert_array_equal(kreisel.read("out/run4/imu.npz").R_NS, alone.R_NS)
    # Notes first, in the order of the files, then what is bad.
    assert [line.split(": ")[1] for line in told] == ["note"] * 3 + ["rec/run2/imu.csv"]
    assert [run for line in told for run in RUNS if run in line] == ["run3", "run4", "run5", "run2"]
    assert report["failed"] == [{"file": "rec/run2/imu.csv", "error": told[-1].removeprefix("kreisel: ")}]
    assert one == swept(capsys, "--threads", "2") == swept(capsys)
    quiet = swept(capsys, "--quiet")
    assert (quiet[0], quiet[1], quiet[3]) == (code, report, files) and quiet[2] == told[-1:]


def test_neither_do_workers_elsewhere(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Those of a scheduler have another working folder, and one thread for each core; twice, for they live on."""
    pytest.importorskip("distributed", reason="distributed is not installed: pip install kreisel[cluster]")
    with by_hand.started(workers=1) as (address, _):
        monkeypatch.chdir(folder)
        here = swept(capsys)
        for _ in range(2):
            assert swept(capsys, "--backend", address) == here
    assert swept(capsys, "--backend", "dask", "--threads", "1") == here


def test_convert_does_the_same(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    told = []
    for threads in ("1", "2"):
        assert (
            main(["convert", "rec/**/*.csv", "-o", f"out{threads}", "--to", "npz", "--threads", threads]) == 1
        )
        streams = capsys.readouterr()
        told.append((streams.out.replace(f"out{threads}", "out"), streams.err))
        assert streams.out.startswith(f"out{threads}/run1/imu.npz: 200 rows over 1.99 s")
    assert told[0] == told[1]
    for run in ("run1", "run5"):
        assert Path(f"out1/{run}/imu.npz").read_bytes() == Path(f"out2/{run}/imu.npz").read_bytes()


def test_resume_does_what_is_missing_or_older(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    first = swept(capsys, "--resume")
    assert first[1]["skipped"] == []
    Path("out/run3/imu.npz").unlink()
    os.utime("rec/run4/imu.csv")
    # Neither newer nor older: nobody knows.
    moment = Path("out/run5/imu.npz").stat().st_mtime_ns
    os.utime("rec/run5/imu.csv", ns=(moment, moment))
    kept = Path("out/run1/imu.npz").stat()
    code, report, _, files = swept(capsys, "--resume")
    assert code == 1 and files == first[3]
    assert report["skipped"] == ["rec/run1/imu.csv"]
    assert [file["file"].split("/")[1] for file in report["files"]] == ["run3", "run4", "run5"]
    after = Path("out/run1/imu.npz").stat()
    assert (kept.st_ino, kept.st_mtime_ns) == (after.st_ino, after.st_mtime_ns)
    code, report, told, _ = swept(capsys, "--resume")
    assert code == 1 and report["files"] == [] and len(report["failed"]) == len(told) == 1
    Path("rec/run2/imu.csv").unlink()
    assert main(["estimate", "rec/**/*.csv", "-o", "out/", "--to", "npz", "--resume"]) == 0
    assert capsys.readouterr().out == "left out: 4 whose output is newer (--resume)\n"


def test_thousands_are_told_in_a_few_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    count = SHOWN + 5
    for k in range(count):
        kreisel.write(f"{k:02d}.npz", RECORDING.rows(slice(0, 30 + k)))
        Path(f"{k:02d}.csv").write_text("t,gyro_x\n0,1\n")
    assert main(["estimate", "*.*"]) == 1
    streams = capsys.readouterr()
    lines = streams.out.splitlines()
    rows = [line.split() for line in lines if ".npz" in line]
    assert [row[0] for row in rows[:SHOWN]] == [f"{k:02d}.npz" for k in range(SHOWN)]
    total, worst = (
        next(line.split() for line in lines if line.startswith(word)) for word in ("all", "worst")
    )
    assert total[:3] == ["all", str(count), str(sum(range(30, 30 + count)))] and worst[1] == "30"
    assert any("the first 20 of 25" in line for line in lines)
    assert len(streams.err.splitlines()) == SHOWN + 1 and "and 5 more" in streams.err
    assert main(["estimate", "*.*", "--dry-run"]) == 1
    assert len(capsys.readouterr().out.splitlines()) < 2 * SHOWN


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("-o out/ --backend dusk", "--backend must be 'dask' or the address of a scheduler"),
        ("-o out/ --backend tcp://here", "--backend must be 'dask' or the address"),
        ("-o out/ --backend tcp://127.0.0.1:8786 --threads 2", "dask worker --nthreads"),
        ("-o out/ --threads 0", "--threads must be a whole number, 1 or more"),
        ("--resume", "--resume needs the outputs that are there"),
        ("-o out/ --column t", "--column takes NAME=HEADER"),
    ],
)
def test_what_was_mistyped_is_one_line(
    arguments: str,
    message: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(folder)
    assert main(["estimate", "rec/**/*.csv", *arguments.split()]) == 2
    told = capsys.readouterr().err
    assert message in told and told.count("\n") == 1
    assert not Path("out").exists()


def test_files_at_once_share_the_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "some"
    path.write_bytes(bytes(1000))
    monkeypatch.setattr(memory, "available", lambda: 16_000)
    with memory.share_of_memory(8_000):
        assert memory.is_long(path)
    assert not memory.is_long(path)
