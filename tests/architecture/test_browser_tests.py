"""Only browser tests that move a pointer to coordinates are repeated, and they are listed."""

from __future__ import annotations

import ast
from pathlib import Path

from source import ROOT, parsed

FOLDER = ROOT / "tests" / "browser"


def moves_the_pointer(node: ast.AST, helpers: set[str]) -> bool:
    """Return whether a function uses the mouse or a touch screen, hovers, or calls a helper that does."""
    return any((isinstance(one, ast.Attribute) and one.attr in ("mouse", "touchscreen", "hover"))
               or (isinstance(one, ast.Name) and one.id in helpers) for one in ast.walk(node))


def pointer_tests(path: Path) -> tuple[str, ...]:
    """Return the names of the tests in a file that move the pointer."""
    functions = [one for one in parsed(path).body if isinstance(one, ast.FunctionDef)]
    helpers = {"hover"} | {one.name for one in functions if not one.name.startswith("test_") and moves_the_pointer(one, {"hover"})}
    return tuple(one.name for one in functions if one.name.startswith("test_") and moves_the_pointer(one, helpers))


def test_the_tests_that_are_repeated_are_those_that_move_the_pointer() -> None:
    found = {path.stem: tests for path in sorted(FOLDER.glob("test_*.py")) if (tests := pointer_tests(path))}
    namespace: dict[str, dict[str, tuple[str, ...]]] = {}
    exec((FOLDER / "pointer.py").read_text(encoding="utf-8"), namespace)
    assert namespace["POINTER_TESTS"] == found
