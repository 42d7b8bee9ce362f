"""Files in blocks: the same complaints as in the whole, wherever the blocks meet."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.files import members, text_blocks
from kreisel.files.blocks import joined


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of ten rows or so."""
    monkeypatch.setattr(text_blocks, "PIECE", 400)
    monkeypatch.setattr(members, "ROWS", 10)


def table(rng: np.random.Generator, n: int = 120) -> list[str]:
    numbers = rng.normal(size=(n, 6))
    rows = [",".join([f"{0.01 * k:.2f}", *(f"{x:.6f}" for x in row)]) for k, row in enumerate(numbers)]
    return ["# logged by hand", "t [s],gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", *rows]


def outcome(read: Callable[[], object]) -> tuple[str, list[str]]:
    """What is raised and what is warned of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            read()
        except ValueError as error:
            return str(error), [str(each.message) for each in caught]
    return "", [str(each.message) for each in caught]


def assert_same_outcome(path: Path) -> str:
    whole = outcome(lambda: kreisel.read(path))
    blocks = outcome(lambda: list(kreisel.read_blocks(path)))
    assert blocks == whole
    return "".join([whole[0], *whole[1]])


FAULTS: dict[str, Callable[[list[str], int], None]] = {
    "is not a number": lambda lines, k: lines.__setitem__(k, lines[k].replace(",", ",x", 1)),
    "fields where 7 are expected": lambda lines, k: lines.__setitem__(k, lines[k] + ",1"),
    "time stands still": lambda lines, k: lines.insert(k, lines[k]),
    "time runs back": lambda lines, k: lines.insert(k, "-1" + lines[k][lines[k].index(",") :]),
    "the value is inf": lambda lines, k: lines.__setitem__(k, lines[k][: lines[k].rindex(",")] + ",inf"),
    "Every row needs its time": lambda lines, k: lines.__setitem__(
        k, "nan" + lines[k][lines[k].index(",") :]
    ),
    "is not a text file": lambda lines, k: lines.__setitem__(k, lines[k] + "\x00"),
}


@pytest.mark.parametrize("complaint", FAULTS)
def test_one_fault_has_one_sentence(complaint: str, rng: np.random.Generator, tmp_path: Path) -> None:
    """At every line: first, last and on both sides of every cut."""
    good, path = table(rng), tmp_path / "log.csv"
    for k in range(3, len(good)):
        lines = list(good)
        lines[50:50] = ["", "# a remark", "% and another"]
        FAULTS[complaint](lines, k if k < 50 else k + 3)
        path.write_text("\n".join(lines) + "\n")
        assert complaint in assert_same_outcome(path)


@pytest.mark.parametrize("cut", [1, 2, 5, 9, 40])
def test_a_file_that_was_cut_off(cut: int, rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("\n".join(table(rng))[:-cut])
    told = assert_same_outcome(path)
    assert "fewer digits" in told or "cut off" in told or cut == 1


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_line_ends(line_end: str, rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(line_end.join([*table(rng), ""]).encode())
    blocks = list(kreisel.read_blocks(path))
    assert len(blocks) > 5
    whole, together = kreisel.read(path), joined(blocks)
    for name in ("t", "gyro", "accel"):
        np.testing.assert_array_equal(getattr(together, name), getattr(whole, name))


@pytest.mark.parametrize(
    "text", ["", "\n\n", "# nothing\n" * 200, "t,gyro_x\n", "# x\n" * 300 + "t,p_x,p_y,p_z\n"]
)
def test_files_without_rows(text: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(text)
    assert assert_same_outcome(path)


def test_utf_16_and_long_comments_are_read_whole(rng: np.random.Generator, tmp_path: Path) -> None:
    for k, data in enumerate(
        ["\n".join(table(rng)).encode("utf-16"), ("# long\n" * 200 + "\n".join(table(rng))).encode()]
    ):
        path = tmp_path / f"log{k}.csv"
        path.write_bytes(data)
        (block,) = kreisel.read_blocks(path)
        np.testing.assert_array_equal(block.gyro, kreisel.read(path).gyro)


def test_even_times_go_on(rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("".join(f"{line.partition(',')[2] or line}\n" for line in table(rng)))
    blocks = list(kreisel.read_blocks(path, rate_hz=300.0))
    np.testing.assert_array_equal(joined(blocks).t, kreisel.read(path, rate_hz=300.0).t)


def arrays(rng: np.random.Generator, n: int = 95) -> dict[str, np.ndarray]:
    return {"time": np.arange(n) / 100.0, "acc": rng.normal(size=(n, 3)), "gyr": rng.normal(size=(n, 3))}


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_a_stranger_s_archive(save: Callable[..., None], rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / "theirs.npz"
    save(path, **arrays(rng))
    blocks = list(kreisel.read_blocks(path))
    assert [len(block) for block in blocks] == [10] * 9 + [5]
    np.testing.assert_array_equal(joined(blocks).accel, kreisel.read(path).accel)


@pytest.mark.parametrize(
    "change",
    [
        lambda found: found | {"acc": np.asfortranarray(found["acc"])},
        lambda found: found | {"acc": found["acc"].T},
        lambda found: found | {"time": found["time"][None]},
        lambda found: {name: found[name] for name in ("acc", "gyr")} | {"fs": np.array(100.0)},
    ],
)
def test_an_archive_of_another_layout_is_read_whole(
    change: Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]], rng: np.random.Generator, tmp_path: Path
) -> None:
    path = tmp_path / "theirs.npz"
    np.savez(path, **change(arrays(rng)))
    (block,) = kreisel.read_blocks(path)
    np.testing.assert_array_equal(block.accel, kreisel.read(path).accel)


@pytest.mark.parametrize("row", [1, 9, 10, 11, 50, 94])
@pytest.mark.parametrize("name", ["time", "gyr"])
def test_rows_of_complaints_are_those_of_the_file(
    row: int, name: str, rng: np.random.Generator, tmp_path: Path
) -> None:
    path, found = tmp_path / "theirs.npz", arrays(rng)
    q = np.tile([1.0, 0.0, 0.0, 0.0], (95, 1))
    if name == "time":
        found["time"][row] = found["time"][row - 1]
    else:
        q[row] *= 1.5
        found = {"time": found["time"], "quat": q}
    np.savez(path, **found)
    assert f"row {row}" in assert_same_outcome(path)


def test_damage_is_told_as_ever(rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / "ours.npz"
    found = arrays(rng)
    kreisel.write(path, kreisel.ImuRecording(found["time"], found["gyr"], found["acc"]))
    good = path.read_bytes()
    path.write_bytes(good[:-300])
    assert "no whole NPZ archive" in assert_same_outcome(path)
    at = good.index(b"accel.npy") + 500
    path.write_bytes(good[:at] + bytes([good[at] ^ 1]) + good[at + 1 :])  # only the checksum shows it
    assert "no whole NPZ archive" in assert_same_outcome(path)


def test_blocks_that_do_not_fit_together_are_refused(rng: np.random.Generator, tmp_path: Path) -> None:
    found = arrays(rng)
    whole = kreisel.ImuRecording(found["time"], found["gyr"], found["acc"])
    with_mag = kreisel.ImuRecording(found["time"], found["gyr"], found["acc"], found["acc"])
    first, second, third = (
        part.rows(slice(*cut))
        for part, cut in zip((whole, whole, with_mag), [(0, 40), (40, 95), (40, 95)], strict=True)
    )
    for suffix in ("csv", "npz"):
        with pytest.raises(ValueError, match="follow each other in time"):
            kreisel.write_blocks(tmp_path / f"out.{suffix}", [second, first])
        with pytest.raises(ValueError, match="must have the same"):
            kreisel.write_blocks(tmp_path / f"out.{suffix}", [first, third])
        with pytest.raises(ValueError, match="no rows"):
            kreisel.write_blocks(tmp_path / f"out.{suffix}", [])
    assert list(tmp_path.iterdir()) == []


def test_formats_without_blocks_collect_them(rng: np.random.Generator, tmp_path: Path) -> None:
    found = arrays(rng)
    whole = kreisel.ImuRecording(found["time"], found["gyr"], found["acc"])
    kreisel.write_blocks(tmp_path / "parts.mat", [whole.rows(slice(0, 40)), whole.rows(slice(40, 95))])
    (block,) = kreisel.read_blocks(tmp_path / "parts.mat")
    np.testing.assert_array_equal(block.gyro, whole.gyro)
