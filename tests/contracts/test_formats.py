"""What every file format promises, asked of each one that discovery finds."""

from __future__ import annotations

import dataclasses
import io
import os
import warnings
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.data.motion import Note
from kreisel.files import doors
from kreisel.files.formats import Noun
from kreisel.maths.rotations import matrix_from_quat_wxyz

FORMATS = doors.format_names()
EPOCH_NS = 1_403_715_524_907_143_168
RATE_HZ = 200.0


def poses(rng: np.random.Generator, n: int = 40, t0_ns: int = EPOCH_NS) -> kreisel.Poses:
    """Uneven stamps on whole nanoseconds, awkward numbers in everything else."""
    q = rng.normal(size=(n, 4))
    return kreisel.Poses(
        t=stamps(rng, n),
        p_NB=rng.normal(size=(n, 3)) * 10.0 ** rng.integers(-9, 4, size=(n, 3)),
        R_NB=matrix_from_quat_wxyz(q / np.linalg.norm(q, axis=1)[:, None]),
        v_NB=rng.normal(size=(n, 3)),
        t0_ns=t0_ns,
        name="held",
    )


def stamps(rng: np.random.Generator, n: int) -> np.ndarray:
    ns = np.cumsum(rng.integers(1, 10_000_000, size=n))
    return (ns - ns[0]) / 1e9


def motion(rng: np.random.Generator) -> kreisel.Motion:
    p = poses(rng)
    a, omega, alpha = rng.normal(size=(3, len(p), 3))
    notes = (Note("method", "spline, degree 9"), Note("heading-jump", "turned by 180 deg", 1.5))
    return kreisel.Motion(p.t, p.p_NB, p.v_NB, a, p.R_NB, omega, alpha, p.t0_ns, "held", notes)


def recording(rng: np.random.Generator) -> kreisel.ImuRecording:
    n = 40
    gyro, accel, mag = rng.normal(size=(3, n, 3))
    accel[7] = np.nan
    mag[::2] = np.nan
    noise = dict(
        zip(("gyro_noise", "accel_noise", "mag_noise_uT"), np.abs(rng.normal(size=(3, 3))), strict=True)
    )
    return kreisel.ImuRecording(stamps(rng, n), gyro, accel, mag, EPOCH_NS, "held", **noise)


def increments(rng: np.random.Generator) -> kreisel.ImuIncrements:
    dtheta, dv, dp = rng.normal(size=(3, 39, 3)) * 10.0 ** rng.integers(-12, 1, size=(3, 39, 3))
    dtheta[7] = dv[7] = dp[7] = np.nan
    return kreisel.ImuIncrements(stamps(rng, 40), dtheta, dv, dp, EPOCH_NS, "held")


def attitude(rng: np.random.Generator) -> kreisel.AttitudeHistory:
    p = poses(rng)
    bias, a, sigma = rng.normal(size=(3, len(p), 3))
    bias[:5] = np.nan  # not known yet
    rest, disturbed, held = rng.integers(0, 2, size=(3, len(p)))
    return kreisel.AttitudeHistory(
        p.t, p.R_NB, bias, a, np.abs(sigma), rest, disturbed, held, EPOCH_NS, "held"
    )


def reference(rng: np.random.Generator) -> kreisel.Reference:
    p = poses(rng)
    R, counts = p.R_NB.copy(), rng.integers(0, 2, size=len(p))
    R[3], counts[3] = np.nan, 0  # out of sight
    return kreisel.Reference(p.t, R, counts, EPOCH_NS, "held")


MAKERS = {
    kreisel.Poses: poses,
    kreisel.Motion: motion,
    kreisel.ImuRecording: recording,
    kreisel.ImuIncrements: increments,
    kreisel.AttitudeHistory: attitude,
    kreisel.Reference: reference,
}
WRITTEN = [name for name in FORMATS if doors.format_named(name).HOLDS]
HELD = [(name, noun) for name in WRITTEN for noun in doors.format_named(name).HOLDS]
TIMED = [(name, noun) for name, noun in HELD if "times" not in doors.format_named(name).OPTIONS]


ARCHIVES = ("npz", "mat", "hdf5", "netcdf", "parquet")
ROS = ("mcap", "rosbag1", "rosbag2")
NEEDS = {
    "hdf5": ("h5py", "data"),
    "netcdf": ("h5netcdf", "data"),
    "parquet": ("pyarrow", "data"),
    **dict.fromkeys(ROS, ("rosbags", "ros")),
}


@pytest.fixture(autouse=True)
def _installed(request: pytest.FixtureRequest) -> None:
    """Skip what is asked of a format whose library is not here."""
    callspec = getattr(request.node, "callspec", None)
    module, extra = NEEDS.get(callspec.params.get("name") if callspec else None, (None, None))
    if module is not None:
        pytest.importorskip(module, reason=f"{module} is not installed: pip install kreisel[{extra}]")


def rounding(name: str, field: str) -> dict[str, float]:
    """What a format may lose of a field; everything else keeps its bits."""
    if field in ("R_NB", "R_NS"):
        return {"rtol": 0.0, "atol": 4e-15}  # a quaternion holds a matrix to a few roundings
    if name in ROS and field == "v_NB":
        return {"rtol": 0.0, "atol": 2e-14}  # in body axes: turned there and back, at a few m/s
    if name in ROS and field in ("mag_uT", "mag_noise_uT"):
        return {"rtol": 5e-16, "atol": 0.0}  # in tesla, and squared: one rounding each way and step
    return {"rtol": 0.0, "atol": 0.0}


def file_of(path: Path, *, telling: bool = False) -> Path:
    """The file itself; of a folder the one that tells its format, or the one with the data."""
    if not path.is_dir():
        return path
    return path / "metadata.yaml" if telling else max(path.iterdir(), key=lambda file: file.stat().st_size)


def read_back(path: Path, name: str) -> Noun:
    """Read with a rate where the format holds no time."""
    rate_hz = RATE_HZ if "times" in doors.format_named(name).OPTIONS else None
    return kreisel.read(path, name, rate_hz=rate_hz)


def columns(data: Noun) -> dict[str, np.ndarray]:
    """The arrays of a noun but for time."""
    names = [field.name for field in dataclasses.fields(data)]
    values = {name: getattr(data, name) for name in names if name not in ("t", "t0_ns", "name", "notes")}
    return {name: value for name, value in values.items() if value is not None}


@pytest.mark.parametrize(("name", "noun"), HELD)
def test_what_is_written_reads_back(name: str, noun: type, tmp_path: Path, rng: np.random.Generator) -> None:
    data = MAKERS[noun](rng)
    kreisel.write(tmp_path / "held", data, name)
    back = read_back(tmp_path / "held", name)
    assert len(back) == len(data)
    for field, array in columns(back).items():
        np.testing.assert_allclose(array, getattr(data, field), **rounding(name, field), err_msg=field)


@pytest.mark.parametrize(("name", "noun"), TIMED)
@pytest.mark.parametrize("t0_ns", [0, EPOCH_NS])
def test_nanoseconds_survive(
    name: str, noun: type, t0_ns: int, tmp_path: Path, rng: np.random.Generator
) -> None:
    data = dataclasses.replace(MAKERS[noun](rng), t0_ns=t0_ns)
    kreisel.write(tmp_path / "held", data, name)
    back = kreisel.read(tmp_path / "held", name)
    assert back.t0_ns == t0_ns
    assert back.t.tobytes() == data.t.tobytes()


@pytest.mark.parametrize("name", ["csv", "tum", *ARCHIVES])
def test_times_since_a_start_keep_every_bit(name: str, tmp_path: Path, rng: np.random.Generator) -> None:
    t = np.cumsum(rng.uniform(1e-4, 1.0, size=40))
    data = kreisel.Poses(t, rng.normal(size=(40, 3)), np.tile(np.eye(3), (40, 1, 1)))
    kreisel.write(tmp_path / "held", data, name)
    assert kreisel.read(tmp_path / "held", name).t.tobytes() == t.tobytes()


@pytest.mark.parametrize(("name", "noun"), HELD)
def test_content_alone_gives_the_format_away(
    name: str, noun: type, tmp_path: Path, rng: np.random.Generator
) -> None:
    kreisel.write(tmp_path / "held", MAKERS[noun](rng), name)
    head = file_of(tmp_path / "held", telling=True).read_bytes()
    assert [other for other in FORMATS if doors.format_named(other).sniff(head)] == [name]


@pytest.mark.parametrize(("name", "noun"), [h for h in HELD if h[0] in ARCHIVES])
def test_archives_keep_every_field(name: str, noun: type, tmp_path: Path, rng: np.random.Generator) -> None:
    data = MAKERS[noun](rng)
    kreisel.write(tmp_path / "held", data, name)
    back = kreisel.read(tmp_path / "held", name)
    assert type(back) is noun
    assert back.name == data.name
    assert getattr(back, "notes", ()) == getattr(data, "notes", ())
    assert columns(back).keys() == columns(data).keys()
    for field, array in columns(back).items():
        assert array.tobytes() == getattr(data, field).tobytes(), field


@pytest.mark.parametrize(("name", "noun"), HELD)
def test_a_cut_file_is_refused_or_shorter(
    name: str, noun: type, tmp_path: Path, rng: np.random.Generator
) -> None:
    """Cut at a hundred places: rows that come back are those written; all else is one clear sentence."""
    data = MAKERS[noun](rng)
    kreisel.write(tmp_path / "held", data, name)
    cut = (tmp_path / "held").rename(tmp_path / "cut")
    target = file_of(cut)
    whole = target.read_bytes()
    refused = 0
    for end in range(0, len(whole), max(10, len(whole) // 1000 * 10)):
        target.write_bytes(whole[:end])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                back = read_back(cut, name)
            except ValueError as error:
                assert str(cut) in str(error), end
                assert "\n" not in str(error), end
                refused += 1
                continue
        rows = len(back)
        assert rows <= len(data)
        for field, array in columns(back).items():
            # The very last number may have lost digits: nothing in the file can tell.
            expected = getattr(data, field)[:rows]
            np.testing.assert_allclose(array[: rows - 1], expected[: rows - 1], rtol=0.0, atol=4e-15)
    assert refused > 10


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n\n",
        bytes(range(256)) * 40,
        b"\x00" * 4096,
        b"\xff\xfe\x00",
        b"a,b\n",
        b"PK\x03\x04.npy",
        b"MATLAB 5.0",
    ],
)
def test_garbage_is_one_sentence(name: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "garbage"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="garbage") as caught:
        read_back(path, name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", WRITTEN)
@pytest.mark.parametrize("interruption", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_an_interrupted_write_leaves_what_was_there(
    name: str,
    interruption: BaseException,
    tmp_path: Path,
    rng: np.random.Generator,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The disk fills up, or Ctrl-C comes, when the bytes are there but not yet safe."""
    data = MAKERS[doors.format_named(name).HOLDS[0]](rng)
    final = tmp_path / "held"
    final.write_bytes(b"before")

    def interrupted(_: int) -> None:
        raise interruption

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises((KeyboardInterrupt, OSError)):
        kreisel.write(final, data, name)
    assert final.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [final]


@pytest.mark.parametrize("name", FORMATS)
def test_nouns_it_cannot_hold_are_refused_by_name(name: str, rng: np.random.Generator) -> None:
    module = doors.format_named(name)
    for noun in set(MAKERS) - set(module.HOLDS):
        with pytest.raises(ValueError, match="Write "):
            module.write(MAKERS[noun](rng), io.BytesIO())


@pytest.mark.parametrize("name", FORMATS)
def test_a_format_describes_itself(name: str) -> None:
    module = doors.format_named(name)
    assert module.KEEPS
    assert module.SUFFIX is None or module.SUFFIX.startswith(".")
    assert doors.format_name(module) == name


def test_the_docs_table_lists_every_format() -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
    listed = [
        line.split("`")[1] for line in page.splitlines() if line.startswith("| `") and "reads" not in line
    ]
    assert set(FORMATS) <= set(listed)
