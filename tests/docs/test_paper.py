"""docs/paper.md: its table agrees with the code, its numbers are computed, its pictures exist, and its example runs."""

from __future__ import annotations

import re
from collections.abc import Sequence

import pytest
from documents import ROOT, blocks

from granchain_core import BadInput
from granchain_core.paper import FIGURES, Statement, numbers_of, statements
from granchain_core.paper.statements import unit_of
from tools.paper.page import PAGE, gallery, table, with_parts

TEXT = PAGE.read_text(encoding="utf-8")
#: The rows of the page: figures, paper, ours, differs, command.
ROWS = [re.split(r" \| ", line.strip("| ")) for line in TEXT.splitlines() if re.match(r"\| (3, 3a|\d+(, \d+)*) ?[,|]", line)]


def test_the_table_and_the_gallery_are_those_of_the_code() -> None:
    assert with_parts(TEXT, statements()) == TEXT  # otherwise run: python -m tools.paper
    assert table(statements()) in TEXT and gallery() in TEXT
    assert len(ROWS) == len(statements()) > 10


def test_the_list_of_statements_that_do_not_hold_is_that_of_the_table() -> None:
    section = TEXT.partition("## What is not reproduced")[2].partition("*Not testable*")[0]
    items = re.findall(r"^\d+\. \*Figure ([\d, ]+)\.\* ", section, re.MULTILINE)
    differ = [one for one in statements() if one.differs.startswith("Yes")]
    assert items == [", ".join(one.figures) for one in differ]
    words = ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten"]
    assert f"{words[len(differ)]} statements do not hold here" in section


def test_every_figure_has_a_row_and_a_picture_of_moderate_size() -> None:
    assert {number for one in statements() for number in one.figures} == set(FIGURES)
    for number in set(FIGURES) - {"3a", "3b"}:
        picture = ROOT / "docs" / "paper" / f"figure-{number}.png"
        assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size < 150_000


@pytest.mark.parametrize("place", range(len(ROWS)), ids=lambda place: statements()[place].key)
def test_bold_numbers_are_the_computed_ones(place: int) -> None:
    """In the text of the page, words are equal and numbers agree within one unit of their last digit."""
    row = statements()[place]
    as_printed = Statement(row.key, row.figures, ROWS[place][1], ROWS[place][2], row.differs, row.command)
    assert as_printed.computed
    assert as_printed.wrong(numbers_of(row.key)) == []


@pytest.mark.parametrize(("ours", "found", "wrong"), [
    ("**0.622** N", [0.6226], 0), ("**0.622** N", [0.6236], 1), ("**9.758e9**", [9.7589e9], 0), ("**9.758e9**", [9.7599e9], 1),
    ("**period 1** at **5** Hz", ["period 1", 5.0], 0), ("**period 1**", ["chaotic"], 1), ("**1** and **2**", [1.0], 1),
])
def test_a_wrong_number_is_found(ours: str, found: Sequence[float | str], wrong: int) -> None:
    assert len(Statement("one", ("1",), "", ours, "", "").wrong(found)) == wrong


def test_a_unit_of_the_last_digit() -> None:
    assert [unit_of(one) for one in ("173", "0.622", "9.758e9")] == [1.0, pytest.approx(1e-3), pytest.approx(1e6)]


def test_an_unknown_row_is_named() -> None:
    with pytest.raises(BadInput, match="Unknown row 'peak'"):
        numbers_of("peak")


def test_the_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = (block.text for block in blocks(PAGE) if block.language == "python")
    (promised,) = re.findall(r"^print\(.*\)\s+# (.+)$", code, re.MULTILINE)
    exec(compile(code, "docs/paper.md", "exec"), {})
    assert capsys.readouterr().out.strip() == promised
