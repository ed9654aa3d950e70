"""The tests that the table of mutants names are there, so that a renamed test is missed."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from documents import ROOT

from tools.mutation.table import BROAD, MUTANTS

#: All words for pytest in the table of mutants.
KILLERS = {BROAD, *(one.killers for one in MUTANTS), *(one.blind for one in MUTANTS if one.blind)}


@pytest.fixture(scope="module")
def collected() -> list[str]:
    """The tests in the files that the table of mutants names."""
    places = sorted({word.partition("::")[0] for words in KILLERS for word in words if word.startswith("tests/")})
    told = subprocess.run([sys.executable, "-m", "pytest", "--collect-only", "-q", "-q", "-o", "addopts=", "--no-header",
                           "-p", "no:cacheprovider", "--verbosity=-1", *places], cwd=ROOT, capture_output=True,
                          text=True, check=False).stdout
    return [line for line in told.splitlines() if "::" in line]


def chosen(expression: str, tests: list[str]) -> list[str]:
    """The tests that an expression of `-k` chooses: its words are parts of their names."""
    for word in {one for one in re.findall(r"[^\s()]+", expression) if one not in ("and", "or", "not")}:
        assert any(word.lower() in one.lower() for one in tests), f"{word!r} of {expression!r} is in no test's name"
    test = re.sub(r"[^\s()]+", lambda match: match[0] if match[0] in ("and", "or", "not")
                  else f"({match[0].lower()!r} in name)", expression)
    return [one for one in tests if eval(test, {"name": one.lower()})]


@pytest.mark.parametrize("words", sorted(words for words in KILLERS if "-k" in words), ids=str)
def test_the_tests_named_with_a_mutant_are_there(words: tuple[str, ...], collected: list[str]) -> None:
    """`python -m tools.mutation --check` looks at files and functions only."""
    places = [word for word in words if word.startswith("tests/")]
    among = [one for one in collected if one.startswith(tuple(places))]
    assert chosen(words[words.index("-k") + 1], among), words
