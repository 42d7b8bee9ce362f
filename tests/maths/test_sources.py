"""Caches of kernels are out of date when any source they are made of is."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from kreisel.maths import sources

SOURCE = Path(__file__).resolve().parents[2] / "src"
KREISEL = SOURCE / "kreisel"


def test_what_a_module_imports_belongs_to_it() -> None:
    of_step = sources._imported(KREISEL / "estimate/filters/dcm/step.py")
    near = {"maths/vectors.py", "maths/kernels.py", "estimate/filters/dcm/layout.py"}
    assert {KREISEL / name for name in near} <= of_step


PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
import kreisel.probe_outer
print(kreisel.probe_outer.outer())
"""


def test_a_changed_function_of_another_file_is_compiled_anew(tmp_path: Path) -> None:
    package = tmp_path / "kreisel"
    (package / "maths").mkdir(parents=True)
    for name in ("__init__.py", "maths/__init__.py", "maths/kernels.py", "maths/sources.py"):
        (package / name).write_bytes((KREISEL / name).read_bytes())
    head = "from kreisel.maths.kernels import kernel\n"
    call = "from kreisel.probe_inner import inner\n\n@kernel\ndef outer() -> float:\n    return inner()\n"
    (package / "probe_outer.py").write_text(head + call)
    answers = []
    for value in (1.5, 22.5):
        (package / "probe_inner.py").write_text(
            f"{head}\n@kernel\ndef inner() -> float:\n    return {value}\n"
        )
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, str(tmp_path)],
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONPATH": "", "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        )
        assert done.returncode == 0, done.stderr
        answers.append(float(done.stdout))
    assert answers == [1.5, 22.5]
