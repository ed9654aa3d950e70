"""The tests that tests/conftest.py names, as quick or as long ones, are there: a new name would drop out silently."""

from __future__ import annotations

import ast

from source import ROOT, parsed

TESTS = ROOT / "tests"
#: The lists by their names.
LISTS = {target.id: ast.literal_eval(statement.value)
         for statement in parsed(TESTS / "conftest.py").body if isinstance(statement, ast.Assign)
         for target in statement.targets if isinstance(target, ast.Name) and target.id in ("QUICK", "LONG")}


def test_every_quick_folder_and_file_is_there() -> None:
    assert [name for name in LISTS["QUICK"] if not (TESTS / name).exists()] == []


def test_every_long_test_is_there() -> None:
    functions = {f"{path.stem}::{node.name}" for path in TESTS.rglob("test_*.py") for node in ast.walk(parsed(path))
                 if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}
    assert [name for name in LISTS["LONG"] if name not in functions] == []
