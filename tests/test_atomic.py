"""A file appears whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kreisel.atomic import replacing


def test_bytes_appear_when_the_block_ends(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(b"old")
    with replacing(path) as out:
        out.write(b"new")
        assert path.read_bytes() == b"old"
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, ValueError, OSError])
def test_an_error_in_the_block_leaves_no_trace(tmp_path: Path, stop: type[BaseException]) -> None:
    with pytest.raises(stop), replacing(tmp_path / "x") as out:
        out.write(b"half")
        raise stop
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_one_sentence(tmp_path: Path) -> None:
    with (
        pytest.raises(OSError, match="Nothing was left under that name") as caught,
        replacing(tmp_path / "x"),
    ):
        raise OSError(28, "No space left on device")
    assert "No space left on device" in str(caught.value)


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is unwritable for root")
def test_an_unwritable_folder_is_named(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(PermissionError, match="is not writable"), replacing(tmp_path / "x"):
        pass


def test_a_refused_folder_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(PermissionError, match=r"the folder .* is not writable"), replacing(tmp_path / "x"):
        pass


def test_a_link_keeps_pointing(tmp_path: Path) -> None:
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    with replacing(tmp_path / "link") as out:
        out.write(b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_others_may_read_what_we_wrote(tmp_path: Path) -> None:
    """The mode is that of any new file, not the private one of temporary files."""
    (tmp_path / "usual").touch()
    with replacing(tmp_path / "x"):
        pass
    assert (tmp_path / "x").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_device_is_written_to_directly() -> None:
    with replacing("/dev/null") as out:
        out.write(b"gone")
    assert not Path("/dev/null").is_file()


@pytest.mark.parametrize(
    ("name", "message"), [("", "it is a folder"), ("no/x", "does not exist"), ("f/x", "is a file")]
)
def test_places_that_cannot_be(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "f").touch()
    with pytest.raises(OSError, match=message), replacing(tmp_path / name) as out:
        out.write(b"x")


def test_what_is_write_protected_stays(tmp_path: Path) -> None:
    """Whoever runs this: the mode counts for an administrator too."""
    (tmp_path / "x").write_bytes(b"old")
    (tmp_path / "x").chmod(0o444)
    with pytest.raises(PermissionError, match="write-protected"), replacing(tmp_path / "x") as out:
        out.write(b"new")
    assert (tmp_path / "x").read_bytes() == b"old"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_device_that_is_full_is_named() -> None:
    with pytest.raises(OSError, match="cannot write /dev/full: No space left"), replacing("/dev/full") as out:
        out.write(b"x")


def test_a_pipe_gets_the_bytes(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    with replacing(tmp_path / "pipe") as out:
        out.write(b"some")
        out.seek(0)
        out.write(b"S")
    assert os.read(reader, 10) == b"Some"
    os.close(reader)
