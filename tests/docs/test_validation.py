"""Every row of docs/validation.md names an existing test, with its tolerances."""

from __future__ import annotations

import ast
import re

import pytest
from documents import ROOT

PAGE = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| .* \| `([\w/]+\.py)::(\w+)` \| ([^|]+) \|$", PAGE, re.MULTILINE)
#: A number in the last column.
_NUMBER = re.compile(r"\d[\d.]*(?:e-\d+)?")


def test_every_row_is_read() -> None:
    rows = [line for line in PAGE.splitlines() if line.startswith("| ") and not line.startswith("| property")]
    assert len(rows) == len(ROWS) > 30 and len({name for _, name, _ in ROWS}) == len(ROWS)


@pytest.mark.parametrize(("file", "name", "agrees"), ROWS, ids=[name for _, name, _ in ROWS])
def test_a_row_has_its_test_with_its_tolerances(file: str, name: str, agrees: str) -> None:
    module = ast.parse((ROOT / "tests" / file).read_text(encoding="utf-8"))
    test = next((one for one in module.body if isinstance(one, ast.FunctionDef) and one.name == name), None)
    assert test is not None, f"{file} has no {name}"
    stated = [test, *(one for one in module.body if isinstance(one, ast.Assign))]  # a tolerance may have a name
    numbers = {float(one.value) for part in stated for one in ast.walk(part)
               if isinstance(one, ast.Constant) and isinstance(one.value, int | float)}
    for number in _NUMBER.findall(agrees):
        assert float(number) in numbers, f"{name} has no tolerance {number}"
