"""A running median: the bits of NumPy's, from memory and from disk."""

import numpy as np
import pytest

from kreisel.data import median
from kreisel.data.median import RunningMedian


@pytest.mark.parametrize("count", [1, 2, 3, 50, 51, 1000, 4001])
@pytest.mark.parametrize("kind", ["normal", "steps", "equal", "wild"])
def test_median_has_the_bits_of_numpy(
    count: int, kind: str, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(median, "KEPT", 40)
    values = {
        "normal": rng.normal(size=count),
        "steps": np.diff(np.arange(count + 1) / 200.0),
        "equal": np.full(count, -0.1),
        "wild": rng.normal(size=count) * 10.0 ** rng.integers(-300, 300, count),
    }[kind]
    running = RunningMedian()
    for piece in np.split(values, np.sort(rng.integers(0, count + 1, 9))):
        running.add(piece)
    assert running.value() == np.median(values)


def test_of_nothing_there_is_none() -> None:
    assert np.isnan(RunningMedian().value())
