"""What formats promise that read or write in blocks: what the whole gives, asked of each that discovery finds."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel.data.tables import CONSTANTS, arrays_of
from kreisel.files import blocks as doors
from kreisel.files import members, text_blocks
from kreisel.files.doors import format_named, format_names, suffix
from kreisel.files.formats import Noun, ReadsBlocks, WritesBlocks, parquet
from tests.contracts.test_formats import EPOCH_NS, MAKERS, NEEDS

READ = [name for name in format_names() if isinstance(format_named(name), ReadsBlocks)]
WRITTEN = [name for name in format_names() if isinstance(format_named(name), WritesBlocks)]
# Increments have one stamp more than rows: they are read and written whole.
READ_NOUNS = [
    (name, noun) for name in READ for noun in format_named(name).HOLDS if noun is not kreisel.ImuIncrements
]
WRITTEN_NOUNS = [
    (name, noun) for name in WRITTEN for noun in format_named(name).HOLDS if noun is not kreisel.ImuIncrements
]


@pytest.fixture(autouse=True)
def _small(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of a few rows; formats whose library is not here are skipped."""
    name = request.node.callspec.params.get("name") if hasattr(request.node, "callspec") else None
    if name in NEEDS:
        pytest.importorskip(NEEDS[name][0], reason=f"pip install kreisel[{NEEDS[name][1]}]")
    monkeypatch.setattr(text_blocks, "PIECE", 700)
    monkeypatch.setattr(members, "ROWS", 7)
    monkeypatch.setattr(parquet, "ROWS", 7)


def rows_of(data: Noun, rows: slice) -> Noun:
    columns = {name: array[rows] for name, array in arrays_of(data) if name not in CONSTANTS}
    return dataclasses.replace(data, **columns)


def pieces(data: Noun, rng: np.random.Generator) -> Iterator[Noun]:
    edges = [0, *np.sort(rng.integers(0, len(data) + 1, 5)), len(data)]
    for first, last in pairwise(edges):
        yield rows_of(data, slice(first, last))


def assert_same(a: Noun, b: Noun) -> None:
    assert type(a) is type(b)
    for field in dataclasses.fields(a):
        x, y = getattr(a, field.name), getattr(b, field.name)
        if isinstance(x, np.ndarray):
            np.testing.assert_array_equal(x, y, err_msg=field.name)
        else:
            assert x == y, field.name


@pytest.mark.parametrize(("name", "noun"), READ_NOUNS)
@pytest.mark.parametrize("t0_ns", [EPOCH_NS, 0])
def test_blocks_read_are_the_whole(
    name: str, noun: type[Noun], t0_ns: int, rng: np.random.Generator, tmp_path: Path
) -> None:
    data = dataclasses.replace(MAKERS[noun](rng), t0_ns=t0_ns)
    path = tmp_path / f"held{suffix(name)}"
    kreisel.write(path, data, format=name)
    # As `read` has it: some formats hold less than they were given.
    whole = kreisel.read(path, format=name)
    blocks = list(doors.read_blocks(path, format=name))
    assert len(blocks) > 2
    assert_same(doors.joined(blocks), whole)


@pytest.mark.parametrize("name", [name for name in READ if kreisel.ImuIncrements in format_named(name).HOLDS])
def test_increments_are_one_block(name: str, rng: np.random.Generator, tmp_path: Path) -> None:
    path = tmp_path / f"held{suffix(name)}"
    doors.write_blocks(path, [MAKERS[kreisel.ImuIncrements](rng)], format=name)
    (block,) = doors.read_blocks(path, format=name)
    assert_same(block, kreisel.read(path, format=name))


@pytest.mark.parametrize(("name", "noun"), WRITTEN_NOUNS)
@pytest.mark.parametrize("t0_ns", [EPOCH_NS, 0])
def test_blocks_written_are_the_bytes_of_the_whole(
    name: str, noun: type[Noun], t0_ns: int, rng: np.random.Generator, tmp_path: Path
) -> None:
    data = dataclasses.replace(MAKERS[noun](rng), t0_ns=t0_ns)
    whole, parts = tmp_path / f"whole{suffix(name)}", tmp_path / f"parts{suffix(name)}"
    kreisel.write(whole, data, format=name)
    doors.write_blocks(parts, pieces(data, rng), format=name)
    assert parts.read_bytes() == whole.read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {whole.name, parts.name}


@pytest.mark.parametrize("name", WRITTEN)
def test_an_error_on_the_way_leaves_nothing(name: str, rng: np.random.Generator, tmp_path: Path) -> None:
    data = MAKERS[format_named(name).HOLDS[-1]](rng)
    path = tmp_path / f"old{suffix(name)}"
    path.write_text("what was there")

    def broken() -> Iterator[Noun]:
        yield rows_of(data, slice(0, 20))
        raise ValueError("the end of the input is bad")

    with pytest.raises(ValueError, match="the end of the input is bad"):
        doors.write_blocks(path, broken(), format=name)
    assert path.read_text() == "what was there"
    assert [found.name for found in tmp_path.iterdir()] == [path.name]
