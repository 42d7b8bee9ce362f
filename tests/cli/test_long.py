"""Files larger than memory: the same output as in memory, under a limit that the system sets."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.cli import inputs, long_simulation, memory
from kreisel.cli.commands import allan
from kreisel.cli.main import main
from kreisel.data import median
from kreisel.files import members, text_blocks
from kreisel.maths import noise_likelihood
from tests.estimate.test_run import recorded

SOURCE = Path(__file__).resolve().parents[2] / "src"


@pytest.fixture
def imu(rng: np.random.Generator, tmp_path: Path) -> kreisel.ImuRecording:
    found = recorded(rng, 600)
    return kreisel.ImuRecording(
        found.t, found.gyro, found.accel, found.mag_uT, 1_700_000_000_123_456_789, "imu"
    )


def in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inputs, "is_long", lambda path: True)
    monkeypatch.setattr(text_blocks, "PIECE", 9000)
    monkeypatch.setattr(members, "ROWS", 100)
    monkeypatch.setattr(median, "KEPT", 64)


def outputs(folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[dict[str, bytes], str, str]:
    told = capsys.readouterr()
    # A MAT file begins with the time of day.
    found = {
        path.name: path.read_bytes()[116 if path.suffix == ".mat" else 0 :]
        for path in sorted(folder.iterdir())
        if path.is_file()
    }
    return found, told.out, told.err


COMMANDS = {
    "estimate": ("{imu}", "-o", "att.{to}", "--json"),
    "convert": ("{imu}", "att.{to}", "--to-frame", "ned-frd"),
}


def poses(path: Path) -> None:
    motion = kreisel.figure_eight(period=8.0).sample(np.arange(0.0, 3.0, 0.01))
    kreisel.write(path, kreisel.Poses(motion.t, motion.p_NB, motion.R_NB, t0_ns=1_700_000_000_123_456_789))


SIMULATIONS = {
    "poses": ("poses.npz", "--imu", "bmi088", "--imu", "plain:0,0,1", "--imu-format", "npz"),
    "rate": ("poses.npz", "--imu", "bmi088", "--rate", "333", "--to-frame", "ned-frd", "--seed", "5"),
    "field": ("poses.npz", "--imu", "mpu9250", "--place", "48,11,500", "--date", "2026-05-01", "--turning"),
    "along": ("poses.npz", "--orientation", "tangent", "--rate", "250"),
}


@pytest.mark.parametrize("simulation", SIMULATIONS)
def test_simulations_in_blocks_leave_no_trace(
    simulation: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    poses(tmp_path / "poses.npz")
    given = [
        str(tmp_path / part) if part.endswith((".npz", ".csv")) else part for part in SIMULATIONS[simulation]
    ]
    made = []
    for way in ("whole", "blocks"):
        (tmp_path / way).mkdir()
        monkeypatch.chdir(tmp_path / way)
        assert main(["simulate", *given, "-o", ".", "--no-pictures"]) == 0
        files, told, notes = outputs(tmp_path / way, capsys)
        made.append((files, told.splitlines()[: -len(files) - 1], notes))
        in_blocks(monkeypatch)
        monkeypatch.setattr(long_simulation, "available", lambda: 0.0)
        monkeypatch.setattr(long_simulation, "ROWS", 64)
    assert made[0] == made[1]


def test_pictures_are_left_out_with_a_note(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    poses(tmp_path / "poses.npz")
    monkeypatch.setattr(long_simulation, "available", lambda: 0.0)
    assert main(["simulate", str(tmp_path / "poses.npz"), "-o", str(tmp_path / "out")]) == 0
    assert "pictures, which need all at once, are left out" in capsys.readouterr().err
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".csv", ".tum", ".npz"}
    assert main(["simulate", str(tmp_path / "poses.npz"), "-o", str(tmp_path / "out"), "--check"]) == 1
    assert "--check needs the whole motion in memory" in capsys.readouterr().err


def test_a_unit_that_was_mistaken_is_no_reason_to_fill_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "poses.npz"
    motion = kreisel.figure_eight(period=8.0).sample(np.arange(0.0, 3.0, 0.01))
    kreisel.write(path, kreisel.Poses(motion.t * 1e9, motion.p_NB, motion.R_NB))
    command = ["simulate", str(path), "-o", str(tmp_path / "out"), "--rate", "400", "--max-gap", "1e9"]
    assert main(command) == 1
    assert "GB of disk" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", ["csv", "npz"])
@pytest.mark.parametrize("to", ["csv", "npz", "mat"])
@pytest.mark.parametrize("command", COMMANDS)
def test_blocks_leave_no_trace(
    command: str,
    to: str,
    suffix: str,
    imu: kreisel.ImuRecording,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    source = tmp_path / f"imu.{suffix}"
    kreisel.write(source, imu)
    made = []
    for way in ("whole", "blocks"):
        (tmp_path / way).mkdir()
        monkeypatch.chdir(tmp_path / way)
        assert main([command, *(part.format(imu=source, to=to) for part in COMMANDS[command])]) == 0
        made.append(outputs(tmp_path / way, capsys))
        in_blocks(monkeypatch)
    assert made[0] == made[1]


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_allan_in_blocks_leaves_no_trace(
    suffix: str,
    rng: np.random.Generator,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    n, source = 3000, tmp_path / f"rest.{suffix}"
    gyro, accel = np.cumsum(rng.normal(0.0, 1e-5, (2, n, 3)), axis=1) + rng.normal(0.0, 1e-3, (2, n, 3))
    kreisel.write(source, kreisel.ImuRecording(np.arange(n) / 100.0, gyro, np.add(accel, [0.0, 0.0, 9.8])))
    made = []
    for _ in range(2):
        assert main(["allan", str(source), "--json"]) == 0
        assert main(["allan", str(source), "--start", "3", "--end", "20"]) == 0
        made.append(capsys.readouterr().out)
        in_blocks(monkeypatch)
        monkeypatch.setattr(allan, "is_long", lambda path: True)
        monkeypatch.setattr(noise_likelihood, "_AT_ONCE", 100)
        noise_likelihood._bins.cache_clear()
    assert made[0] == made[1]


def test_a_bad_end_leaves_no_file(
    imu: kreisel.ImuRecording,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    source, target = tmp_path / "imu.csv", tmp_path / "att.csv"
    kreisel.write(source, imu)
    lines = source.read_text().splitlines()
    source.write_text("\n".join([*lines, lines[-1]]) + "\n")
    in_blocks(monkeypatch)
    assert main(["estimate", str(source), "-o", str(target)]) == 1
    assert f"line {len(lines) + 1}" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["imu.csv"]


def test_units_are_judged_by_the_whole_recording(
    imu: kreisel.ImuRecording,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    source = tmp_path / "imu.npz"
    kreisel.write(source, kreisel.ImuRecording(imu.t, imu.gyro, imu.accel / 9.81, imu.mag_uT))
    in_blocks(monkeypatch)
    assert main(["estimate", str(source), "-o", str(tmp_path / "att.npz")]) == 1
    assert "it looks like g" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["imu.npz"]


def test_a_limit_of_the_system_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "some"
    path.write_bytes(bytes(1000))
    monkeypatch.setattr(memory, "available", lambda: 16_000)
    assert not memory.is_long(path)
    monkeypatch.setattr(memory, "available", lambda: 15_999)
    assert memory.is_long(path)
    assert not memory.is_long(Path("/dev/stdin"))


# What is loaded and compiled takes its room first; the limit is on what comes on top.
LIMITED = """
import resource, sys
import numpy as np
import kreisel
from kreisel.cli.main import main

def blocks(count, n=100_000):
    rng = np.random.default_rng(1)
    gyro, accel = rng.normal(0.0, 0.01, (2, n, 3)) + np.array([[[0.0, 0.1, 0.0]], [[0.0, 0.0, 9.8]]])
    for k in range(count):
        yield kreisel.ImuRecording(np.arange(k * n, (k + 1) * n) / 200.0, gyro, accel)

def limit(megabytes):
    size = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (size + (megabytes << 20),) * 2)

def warm(folder):
    kreisel.write_blocks(folder + "/small.npz", blocks(2))
    assert main(["estimate", folder + "/small.npz", "-o", folder + "/small_out.npz"]) == 0
"""

COMPILE = """
warm(sys.argv[1])
print(sum(len(block) for block in kreisel.run_long(kreisel.DcmFilter(), blocks(2))))
kreisel.run(kreisel.DcmFilter(), kreisel.read(sys.argv[1] + "/small.npz"))
"""

FLY = """
warm(sys.argv[1])
limit(200)
samples = sum(len(block) for block in kreisel.run_long(kreisel.DcmFilter(), blocks(100)))
print(samples)
try:
    np.ones((samples, 3))
except MemoryError:
    print("and no column of them would fit")
"""

DISK = """
warm(sys.argv[1])
kreisel.write_blocks(sys.argv[1] + "/imu.npz", blocks(10))
limit(150)
assert main(["estimate", sys.argv[1] + "/imu.npz", "-o", sys.argv[1] + "/att.npz"]) == 0
try:
    kreisel.run(kreisel.DcmFilter(), kreisel.read(sys.argv[1] + "/imu.npz"))
except MemoryError:
    print("and not as a whole")
"""


def limited(program: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", LIMITED + program, str(folder)],
        env={**os.environ, "PYTHONPATH": str(SOURCE), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


on_linux = pytest.mark.skipif(sys.platform != "linux", reason="reads its own size from /proc")


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Every kernel is in the cache: what a compiler leaves of its memory would be room that no limit counts."""
    limited(COMPILE, tmp_path_factory.mktemp("compiled"))


@on_linux
@pytest.mark.usefixtures("compiled")
def test_ten_million_samples_in_two_hundred_megabytes(tmp_path: Path) -> None:
    assert limited(FLY, tmp_path).endswith("10000000\nand no column of them would fit\n")


@on_linux
@pytest.mark.usefixtures("compiled")
def test_a_file_in_less_memory_than_it_takes(tmp_path: Path) -> None:
    assert limited(DISK, tmp_path).endswith("and not as a whole\n")
    found = np.load(tmp_path / "att.npz", mmap_mode="r")
    assert len(found["t"]) == 1_000_000
