"""The layout of the pages: no block of commands or formulas was joined by automatic line wrapping."""

from __future__ import annotations

import importlib.util
import re
import shlex
from pathlib import Path

import pytest
from documents import PAGES, ROOT, lines_outside_fences

from app.cli.commands import parser_for

_CONTRIBUTING = ROOT / "CONTRIBUTING.md"
_PROGRAMS = {"granchain", "pip", "playwright", "pre-commit", "python", "python3"}


def shell_lines(page: Path) -> list[str]:
    """Return the lines of a page's indented blocks: lines after an empty line that begin with four spaces."""
    found, block, before = [], False, ""
    for _, line in lines_outside_fences(page):
        block = line.startswith("    ") and (block or not before)
        found += [line.strip()] if block else []
        before = line
    return found


def commands_in(line: str) -> list[list[str]]:
    """Return the words of each command in a shell line, without settings of environment variables."""
    words = shlex.split(line, comments=True)
    parts: list[list[str]] = [[]]
    for word in words:
        if word == "&&":
            parts.append([])
        elif parts[-1] or not re.match(r"[A-Z_]+=", word):
            parts[-1].append(word)
    return parts


_COMMANDS = [words for line in shell_lines(_CONTRIBUTING) for words in commands_in(line)]


@pytest.mark.parametrize("words", _COMMANDS, ids=" ".join)
def test_each_line_of_commands_holds_one_that_can_run(words: list[str]):
    """It begins with a program, contains no other program, and everything that it names exists."""
    program, *rest = words
    assert Path(program).name in _PROGRAMS
    assert not [word for word in rest if word.startswith(".venv/bin/") or word == "python3"]
    match Path(program).name, rest:
        case "python", ["-m", module, *arguments]:
            assert importlib.util.find_spec(module)
            assert all((ROOT / word).exists() for word in arguments if word.startswith("tests"))
        case "pip", ["install", "-e", extra]:
            name = extra.removeprefix(".[").removesuffix("]")
            assert f"\n{name} = [" in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
        case "granchain", arguments:
            parser_for(arguments).parse_args(arguments)


def test_the_set_up_has_its_commands():
    assert [Path(words[0]).name for words in _COMMANDS[:5]] == ["python3", "pip", "granchain", "pip", "pre-commit"]


@pytest.mark.parametrize("page", [*PAGES, ROOT / "tests" / "benchmarks" / "README.md"], ids=lambda page: str(page.relative_to(ROOT)))
def test_pages_have_no_double_empty_lines(page: Path):
    empty = {number for number, line in lines_outside_fences(page) if not line}
    assert [number for number in sorted(empty) if number + 1 in empty] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_line_has_at_most_120_characters(page: Path) -> None:
    """Rows of tables and fenced blocks are exceptions."""
    long = [number for number, line in lines_outside_fences(page) if len(line) > 120 and not line.lstrip().startswith("|")]
    assert long == []
