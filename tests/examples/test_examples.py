"""Every example runs, stays short and leaves a picture."""

import ast
import io
import os
import subprocess
import sys
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
NAMES = [path.stem for path in EXAMPLES]
PICTURES = {".png", ".svg", ".pdf", ".gif", ".html"}
NOT_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}


def lines_of_code(source: str) -> int:
    """Lines that hold something other than blanks, comments and the opening docstring."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in NOT_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    module = ast.parse(source)
    if ast.get_docstring(module) is not None:
        end = module.body[0].end_lineno
        assert end is not None
        lines -= set(range(1, end + 1))
    return len(lines)


@pytest.mark.parametrize("example", EXAMPLES, ids=NAMES)
def test_example_draws_something(example: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(example)],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    pictures = [path for path in tmp_path.rglob("*") if path.suffix in PICTURES and path.stat().st_size]
    assert pictures, f"{example.name} wrote no picture into the folder it ran in"


@pytest.mark.parametrize("example", EXAMPLES, ids=NAMES)
def test_example_is_short(example: Path) -> None:
    assert lines_of_code(example.read_text(encoding="utf-8")) < 40
