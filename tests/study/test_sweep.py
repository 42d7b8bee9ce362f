"""Many files, one function, and no file that stops another."""

from __future__ import annotations

from pathlib import Path

import pytest

from kreisel import sweep
from kreisel.study.sweep import Outcome


def length(path: Path) -> int:
    assert path.is_absolute()
    text = path.read_text()
    if not text:
        raise ValueError(f"{path.name} is empty.")
    return len(text)


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names as they are typed, from the folder that they are in."""
    monkeypatch.chdir(tmp_path)
    names = [f"{k}.txt" for k in range(8)]
    for k, name in enumerate(names):
        Path(name).write_text("x" * k)
    return names


def made_of(outcomes: list[Outcome], folder: Path) -> None:
    by_name = {str(outcome.path): outcome for outcome in outcomes}
    assert len(by_name) == len(outcomes) == 9
    assert [by_name[f"{k}.txt"].value for k in range(1, 8)] == list(range(1, 8))
    assert by_name["0.txt"].error == "0.txt is empty." and by_name["0.txt"].value is None
    assert by_name["none.txt"].error == f"{folder / 'none.txt'}: No such file or directory"


def test_every_file_has_an_outcome(files: list[str], tmp_path: Path) -> None:
    counts: list[int] = []
    made_of(list(sweep(length, [*files, "none.txt"], threads=2, on_done=counts.append)), tmp_path)
    assert counts == list(range(1, 10))


def test_workers_make_the_same(files: list[str], tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="distributed is not installed: pip install kreisel[cluster]")
    made_of(list(sweep(length, [*files, "none.txt"], backend="dask", threads=1)), tmp_path)


def test_an_error_that_is_no_files_fault_ends_the_sweep(files: list[str]) -> None:
    with pytest.raises(ZeroDivisionError):
        list(sweep(lambda path: 1 // 0, files))


def test_no_files() -> None:
    assert list(sweep(length, [])) == []
