"""docs/python.md lists every older name that still works, with the new name and the version that removes it."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import granchain
import granchain_core
from app.cli.commands import OLDER_NAMES as COMMANDS
from granchain_core.kernels import batch_size

ROOT = Path(__file__).resolve().parents[2]
ROWS = re.findall(r"^\| `([^`]+)` \| `([^`]+)` \| (1\.0|stays) \|$",
                  (ROOT / "docs" / "python.md").read_text(encoding="utf-8"), re.MULTILINE)
LISTED = {(new, old) for new, old, _ in ROWS}
_OLDER = re.compile(r"The older name of `(\w+)`")


def in_the_code() -> set[tuple[str, str]]:
    """(new, old) of all properties, constants and attributes whose docstring or comment calls them older names."""
    found: set[tuple[str, str]] = set()
    for file in sorted((ROOT / "granchain_core").rglob("*.py")):
        text = file.read_text(encoding="utf-8")
        if "older name of `" not in text:
            continue
        for new, old in re.findall(r"^#: The older name of `(\w+)`\.\n(\w+) =", text, re.MULTILINE):
            found.add((new, old))
        for one in (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef)):
            for old, new in re.findall(r"(\w+) : [^\n]*\n\s+The older name of `(\w+)`", ast.get_docstring(one) or ""):
                found.add((f"{one.name}.{new}", f"{one.name}.{old}"))
            for method in (node for node in one.body if isinstance(node, ast.FunctionDef)):
                if match := _OLDER.match(ast.get_docstring(method) or ""):
                    found.add((f"{one.name}.{match[1]}", f"{one.name}.{method.name}"))
    return found


def test_every_older_name_is_in_the_table() -> None:
    packaging = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    extras = {(only, f"granchain[{extra}]") for extra, (only, *more) in packaging.items() if not more and only.startswith("granchain[")}
    known = {*((new, old) for old, new in granchain_core.OLDER_NAMES.items()), *in_the_code(), *extras,
             (batch_size.VARIABLE, batch_size.OLDER_VARIABLE), ("--max-sessions", "--most-visitors"),
             *((f"granchain {new}", f"granchain {old}") for old, new in COMMANDS.items())}
    assert known == LISTED
    assert len(in_the_code()) >= 10  # the search finds them


def test_older_names_of_the_package_are_those_that_it_has() -> None:
    for new, old in LISTED:
        if old.isidentifier() and new.isidentifier() and old in granchain_core.OLDER_NAMES:
            assert getattr(granchain, old) is getattr(granchain, new)
