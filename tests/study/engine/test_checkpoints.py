"""What was finished is never lost, never mixed with another study, and never taken on trust."""

from __future__ import annotations

import errno
import io
import json
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from kreisel import run_blocks
from kreisel.study.engine import checkpoints
from kreisel.study.engine.records import MARK, packed, records
from tests.study.engine.noisy import alike

STUDY = {"seed": 3, "scenario": {"rate": 200.0, "axes": [1, 2]}}


def work(block: int) -> dict[str, np.ndarray]:
    """Every kind of array that has to come back as it was."""
    x = np.random.default_rng(block).normal(size=(4, 3))
    return {
        "x": x,
        "turned": np.asfortranarray(x.T),
        "nan": np.array([np.nan, -0.0]),
        "scalar": np.array(block),
        "empty": np.empty((0, 3), np.float32),
        "name": np.array(["Groß", "klein"]),
    }


WHOLE = {block: work(block) for block in range(12)}


def resumed(folder: Path, blocks: int = 12, **settings: object) -> tuple[dict, list[int]]:
    """The study gone on with, and the blocks that had to be computed."""
    computed: list[int] = []
    study = dict(
        run_blocks(
            lambda k: computed.append(k) or work(k), blocks, fingerprint=STUDY, folder=folder, resume=True
        )
    )
    return study, sorted(computed)


def begun(folder: Path, blocks: int = 7) -> Path:
    """The file of a study of which the first blocks are done, in their order."""
    list(run_blocks(work, blocks, fingerprint=STUDY, folder=folder, threads=1))
    return folder / "0001.blocks"


def test_finished_blocks_are_read_back_and_not_computed(tmp_path: Path) -> None:
    begun(tmp_path)
    study, computed = resumed(tmp_path)
    assert alike(study, WHOLE) and computed == [7, 8, 9, 10, 11]
    study, computed = resumed(tmp_path)
    assert alike(study, WHOLE) and computed == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0001.blocks", "0002.blocks", "study.json"]


def test_fewer_blocks_than_there_are(tmp_path: Path) -> None:
    begun(tmp_path)
    study, computed = resumed(tmp_path, 3)
    assert sorted(study) == [0, 1, 2] and computed == []


def test_every_possible_cut_leaves_whole_blocks(tmp_path: Path) -> None:
    """A file that ends anywhere, as after SIGKILL in the middle of writing: what is before is there, unblamed."""
    whole = begun(tmp_path, 2).read_bytes()
    second = whole.rindex(MARK)
    cut = tmp_path / "cut"
    for end in [*range(second, second + 40), *range(second + 40, len(whole), 17), len(whole) - 1]:
        cut.write_bytes(whole[:end])
        assert [record and record[0] for record in records(cut)] == [0]


def test_any_damaged_byte_costs_one_block_and_is_noted(tmp_path: Path, rng: np.random.Generator) -> None:
    file = begun(tmp_path)
    whole = file.read_bytes()
    third = [k for k in range(len(whole)) if whole.startswith(MARK, k)][2:4]
    for place in (third[0], third[0] + 9, *rng.integers(*third, 20)):
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 0x10]) + whole[place + 1 :])
        for later in tmp_path.glob("000[2-9].blocks"):
            later.unlink()
        with pytest.warns(UserWarning, match=r"0001.blocks is damaged in 1 place: .* computed again"):
            study, computed = resumed(tmp_path)
        assert alike(study, WHOLE) and computed == [2, 7, 8, 9, 10, 11]


def test_zeros_at_the_end_as_after_a_loss_of_power(tmp_path: Path) -> None:
    with begun(tmp_path).open("ab") as stream:
        stream.write(bytes(5_000_000))
    with pytest.warns(UserWarning, match="damaged in 1 place"):
        study, computed = resumed(tmp_path)
    assert alike(study, WHOLE) and computed == [7, 8, 9, 10, 11]


def test_a_mark_across_the_border_of_two_windows(tmp_path: Path) -> None:
    """Behind rubbish of any length the next record is found."""
    record, file = packed(5, work(5)), tmp_path / "x"
    for length in range((1 << 20) - 12, (1 << 20) + 12):
        file.write_bytes(b"\0" * length + record)
        found = list(records(file))
        assert found[0] is None and found[1] is not None and found[1][0] == 5


def test_another_study_is_refused_with_what_differs(tmp_path: Path) -> None:
    begun(tmp_path)
    other = {"seed": 4, "scenario": {"rate": 200.0, "axes": [1, 3]}}
    for resume in (False, True):
        with pytest.raises(ValueError, match="another study: ") as caught:
            run_blocks(work, 12, fingerprint=other, folder=tmp_path, resume=resume)
        assert "seed is 3 there and 4 here; scenario.axes.1 is 2 there and 3 here." in str(caught.value)


def test_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun(tmp_path)
    there = checkpoints.versions()
    monkeypatch.setattr(checkpoints, "versions", lambda: {**there, "numpy": "9.9"})
    with pytest.raises(ValueError, match=r'other versions.*numpy is ".*" there and "9.9" here'):
        run_blocks(work, 12, fingerprint=STUDY, folder=tmp_path, resume=True)


def test_finished_blocks_are_never_passed_over_in_silence(tmp_path: Path) -> None:
    begun(tmp_path)
    with pytest.raises(ValueError, match="finished blocks of this very study: resume=True"):
        run_blocks(work, 12, fingerprint=STUDY, folder=tmp_path)


@pytest.mark.parametrize("text", ["{", "[]", "{}"])
def test_blocks_of_nobody_knows_what_are_refused(tmp_path: Path, text: str) -> None:
    begun(tmp_path)
    (tmp_path / "study.json").write_text(text)
    with pytest.raises(ValueError, match=r"study.json is missing or damaged"):
        run_blocks(work, 12, fingerprint=STUDY, folder=tmp_path, resume=True)


def test_a_folder_without_a_finished_block_is_free(tmp_path: Path) -> None:
    """A study that failed before its first block locks nobody out, and `resume` may stand in a script for ever."""
    run_blocks(work, 12, fingerprint="first try", folder=tmp_path / "a" / "b")
    study, computed = resumed(tmp_path / "a" / "b")
    assert alike(study, WHOLE) and len(computed) == 12
    assert json.loads((tmp_path / "a" / "b" / "study.json").read_text())["study"] == STUDY


def test_a_fingerprint_tells_nan_arrays_and_numbers_apart(tmp_path: Path) -> None:
    for value in (np.nan, np.arange(3), np.float32(1.5), None, (1, {"a": 2.0}), Path("x")):
        folder = tmp_path / str(type(value).__name__)
        for resume in (False, True):
            list(run_blocks(work, 1, fingerprint={"value": value}, folder=folder, resume=resume))
    with pytest.raises(ValueError, match="value is"):
        run_blocks(
            work, 1, fingerprint={"value": np.arange(3)[::-1]}, folder=tmp_path / "ndarray", resume=True
        )
    with pytest.raises(TypeError, match=r"fingerprint\['f'\] must be a number, .* got function"):
        run_blocks(work, 1, fingerprint={"f": work}, folder=tmp_path)


def test_a_block_has_to_be_a_table_of_arrays(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=r"'x' is of type float"):
        list(run_blocks(lambda k: {"x": 1.0}, 1, folder=tmp_path))


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", place], capture_output=True)
    if mounted.returncode:
        pytest.skip("only an administrator may mount a small disk")
    yield place
    subprocess.run(["umount", place], check=True)


def test_a_disk_that_runs_full(small_disk: Path, tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"No space left on device. The \d+ blocks finished before are safe"):
        list(run_blocks(work, 200, fingerprint=STUDY, folder=small_disk / "study", threads=2))
    finished = dict(checkpoints.Checkpoints(small_disk / "study").finished(200))
    assert len(finished) > 5
    assert alike(finished, {block: work(block) for block in finished})
    subprocess.run(["mount", "-o", "remount,size=4m", small_disk], check=True)
    study, computed = resumed(small_disk / "study", 200)
    assert alike(study, {block: work(block) for block in range(200)})
    assert len(computed) == 200 - len(finished)


def test_half_a_record_is_taken_away_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that takes half of a record and then no more, as disks do, and has room again later."""
    length = len(packed(0, work(0)))
    room = [3 * length + length // 2]

    class Disk(io.FileIO):
        def write(self, data: bytes) -> int:  # type: ignore[override]
            if not room[0]:
                raise OSError(errno.ENOSPC, "No space left on device")
            written = super().write(data[: room[0]])
            room[0] -= written
            return written

    usual = Path.open

    def opened(path: Path, mode: str = "r", **settings: object):
        return Disk(path, mode) if path.suffix == ".blocks" and "x" in mode else usual(path, mode, **settings)

    monkeypatch.setattr(Path, "open", opened)
    with pytest.raises(OSError, match=r"No space left on device\. The 3 blocks finished before are safe"):
        begun(tmp_path)
    assert (tmp_path / "0001.blocks").stat().st_size == 3 * length
    room[0] = 10**6
    study, computed = resumed(tmp_path)
    assert alike(study, WHOLE) and computed == list(range(3, 12))
