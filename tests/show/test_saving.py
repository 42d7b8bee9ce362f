"""A file is complete or not there."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from kreisel.show import plot_linear, save

BEGINNINGS = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", BEGINNINGS)
def test_the_suffix_chooses_the_format_and_bytes_repeat(tmp_path: Path, circle, kind: str) -> None:
    files = [save(plot_linear(circle()), tmp_path / f"{k}.{kind}") for k in "ab"]
    first, second = (file.read_bytes() for file in files)
    assert first.startswith(BEGINNINGS[kind]) and first == second
    assert sorted(tmp_path.iterdir()) == files


def test_capital_suffixes_and_strings_are_welcome(tmp_path: Path) -> None:
    assert save(Figure(), f"{tmp_path}/A.PNG").read_bytes().startswith(BEGINNINGS["png"])


@pytest.mark.parametrize("name", ["picture.jpg", "picture"])
def test_another_suffix_is_refused_with_those_that_work(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"\.png or \.svg or \.pdf"):
        save(Figure(), tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"the folder .*nowhere does not exist"):
        save(Figure(), tmp_path / "nowhere" / "a.png")


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    class Broken(Figure):
        def savefig(self, fname, **options):
            fname.write(b"half a pic")
            raise OSError("no such font")

    target = tmp_path / "a.png"
    target.write_bytes(b"old")
    with pytest.raises(OSError, match="no such font"):
        save(Broken(), target)
    assert target.read_bytes() == b"old" and list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("kind", BEGINNINGS)
def test_a_full_disk_is_the_sentence_of_every_file(tmp_path: Path, monkeypatch, kind: str) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(
        OSError, match=rf"cannot write .*a\.{kind}: No space left on device\. Nothing was left"
    ):
        save(Figure(), tmp_path / f"a.{kind}")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="file modes are POSIX")
def test_a_picture_has_the_rights_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    assert save(Figure(), tmp_path / "a.png").stat().st_mode == (tmp_path / "plain").stat().st_mode
