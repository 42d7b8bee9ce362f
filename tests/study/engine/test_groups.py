"""Small blocks go out many at a time, large ones alone, and each exactly once."""

from __future__ import annotations

import numpy as np
import pytest

from kreisel.study.engine.groups import GROUP_BYTES, GROUP_SECONDS, Groups


def dealt(blocks: int, seconds: float, size: float = 8.0, slots: int = 4) -> list[list[int]]:
    """The groups of so many blocks that take `seconds` each, and have `size` bytes."""
    groups, found = Groups(range(blocks)), []
    while group := groups.deal(slots):
        groups.took(len(group), seconds * len(group), size * len(group))
        found.append(list(group))
    return found


@pytest.mark.parametrize("seconds", [1e-5, 1e-3, 0.1, 1.0, 100.0])
@pytest.mark.parametrize("blocks", [0, 1, 5, 1000])
def test_each_block_once(blocks: int, seconds: float) -> None:
    found = dealt(blocks, seconds)
    assert [block for group in found for block in group] == list(range(blocks))


@pytest.mark.parametrize("seconds", [1e-3, 3e-3, 0.05])
def test_a_group_takes_as_long_as_it_should(seconds: float) -> None:
    """Not the first, which measure, nor the last, which are small so that all end at the same time."""
    lengths = np.array([len(group) for group in dealt(100_000, seconds)])
    middle = lengths[10 : len(lengths) // 2]
    assert np.allclose(middle, GROUP_SECONDS / seconds, rtol=0.2)
    assert lengths[-1] == 1


def test_long_blocks_go_alone() -> None:
    assert {len(group) for group in dealt(50, 2.0)} == {1}


def test_large_results_travel_few_at_a_time() -> None:
    lengths = [len(group) for group in dealt(10_000, 1e-6, size=1e6)]
    assert max(lengths) == GROUP_BYTES / 1e6


def test_slow_starts_are_forgotten() -> None:
    """A process compiles for seconds at its first block: the groups are large a few blocks later."""
    groups = Groups(range(100_000))
    groups.took(1, 5.0, 8.0)
    groups.took(1, 5.0, 8.0)
    for _ in range(5):
        groups.took(len(groups.deal(1)), 1e-3 * len(groups.deal(1)), 8.0)
    assert len(groups.deal(1)) > 50
