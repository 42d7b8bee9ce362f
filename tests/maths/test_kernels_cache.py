"""Where compiled code is kept when the usual places cannot be written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "src"

# numba's own search made to find nothing, as with a read-only package and no home.
PROGRAM = """
from numba.core import caching
nowhere = classmethod(lambda cls, py_func, py_file: None)
implementation = getattr(caching, 'CacheImpl', None) or caching._CacheImpl
for locator in implementation._locator_classes:
    if locator is not caching.{provided}:
        locator.from_function = nowhere
from kreisel.maths import kernels
import kreisel.maths.kinematics
print(repr(kernels.numba.config.CACHE_DIR))
"""


def start(tmp_path: Path) -> subprocess.CompletedProcess[str]:
    from numba.core import caching

    provided = next(name for name in dir(caching) if name.endswith("UserProvidedCacheLocator"))
    return subprocess.run(
        [sys.executable, "-c", PROGRAM.format(provided=provided)],
        env={**os.environ, "PYTHONPATH": str(SOURCE), "TMPDIR": str(tmp_path), "NUMBA_CACHE_DIR": ""},
        capture_output=True,
        text=True,
    )


def test_it_goes_to_a_folder_for_temporary_files(tmp_path: Path) -> None:
    done = start(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert str(tmp_path / "kreisel-numba-") in done.stdout


@pytest.mark.skipif(os.name != "posix", reason="file modes are POSIX")
def test_a_folder_that_others_may_write_to_is_not_trusted(tmp_path: Path) -> None:
    folder = tmp_path / f"kreisel-numba-{os.geteuid()}"
    folder.mkdir()
    folder.chmod(0o777)
    done = start(tmp_path)
    assert done.returncode == 0
    assert done.stdout == "''\n"
    assert done.stderr.count("cannot be cached") == 1
