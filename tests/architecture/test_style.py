"""The rules of style that can be counted."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "src" / "kreisel"
FILES = sorted(SOURCE.rglob("*.py"))
DRAWERS = {"utils", "util", "helpers", "helper", "common", "misc", "tools"}

Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def parse(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def name_of(path: Path) -> str:
    return str(path.relative_to(SOURCE))


def function_lengths() -> Iterator[tuple[int, str]]:
    """Lines of every function with the place it stands; a docstring may be as long as it needs."""
    for path in FILES:
        for node in ast.walk(parse(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield code_lines(node), f"{name_of(path)}:{node.lineno} {node.name}"


def code_lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    assert node.end_lineno is not None
    lines = node.end_lineno - node.lineno + 1
    if ast.get_docstring(node) is not None:
        docstring = node.body[0]
        assert docstring.end_lineno is not None
        lines -= docstring.end_lineno - docstring.lineno + 1
    return lines


def public_definitions(module: ast.Module) -> Iterator[Definition]:
    for node in module.body:
        if isinstance(node, Definition) and not node.name.startswith("_") and not is_overload(node):
            yield node


def is_overload(node: Definition) -> bool:
    """True for a signature alone, whose docstring stands at the definition that follows."""
    return any(ast.unparse(decorator).endswith("overload") for decorator in node.decorator_list)


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_module_says_what_it_is_for(path: Path) -> None:
    docstring = ast.get_docstring(parse(path)) or ""
    first_sentence = docstring.split("\n\n")[0].strip()
    assert first_sentence.endswith((".", ":")), f"{name_of(path)} starts with {first_sentence!r}"


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_public_names_are_documented(path: Path) -> None:
    bare = [node.name for node in public_definitions(parse(path)) if not ast.get_docstring(node)]
    assert not bare, f"{name_of(path)}: no docstring in {', '.join(bare)}"


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_file_is_short_enough_to_read(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


def test_no_function_is_over_sixty_lines() -> None:
    assert [place for length, place in function_lengths() if length > 60] == []


def test_nine_functions_in_ten_are_under_25_lines() -> None:
    lengths = sorted(function_lengths(), reverse=True)
    long = [f"{length} {place}" for length, place in lengths if length >= 25]
    assert len(long) <= 0.1 * len(lengths), "\n".join(long)


def test_no_drawer_modules() -> None:
    assert [name_of(path) for path in FILES if path.stem in DRAWERS] == []
