"""Fixtures of every test: a seeded generator that names its seed, and the folder of real recordings."""

import os
import secrets
import zlib
from pathlib import Path

import hypothesis
import numpy as np
import pytest

os.environ.setdefault("MPLBACKEND", "Agg")

# The first call of a kernel compiles it, which no deadline foresees.
hypothesis.settings.register_profile(
    "kreisel", deadline=None, print_blob=True, derandomize=bool(os.environ.get("CI"))
)
hypothesis.settings.load_profile("kreisel")

SEED = int(os.environ.get("KREISEL_TEST_SEED") or secrets.randbits(32))


@pytest.fixture
def rng(request: pytest.FixtureRequest) -> np.random.Generator:
    """A generator of this test's own, whatever ran before; pytest shows the line on failure."""
    print(f"repeat with KREISEL_TEST_SEED={SEED}")
    return np.random.default_rng([SEED, zlib.crc32(request.node.nodeid.encode())])


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Real recordings, which are not part of the repository: $KREISEL_DATA, or ../shared/data."""
    named = os.environ.get("KREISEL_DATA")
    folder = Path(named) if named else Path(__file__).resolve().parents[2] / "shared" / "data"
    if named and not folder.is_dir():
        pytest.fail(f"KREISEL_DATA={named} is not a folder")
    if not folder.is_dir():
        pytest.skip(f"no real recordings: {folder} is absent and KREISEL_DATA is not set")
    return folder
