"""Sentences that compare granchain with the fastest other program agree with the tables of docs/benchmarks.md."""

from __future__ import annotations

import re

import pytest
from documents import ROOT

_PAGE = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
_SECTIONS = dict(section.split("\n", 1) for section in _PAGE.split("\n## ")[1:])
_MS = {"s": 1e3, "ms": 1.0, "µs": 1e-3}


def ratio(section: str, error: str) -> str:
    """Return the median time of the fastest other program over that of `dop853-root`, from a table."""
    table = section.partition(f"Trajectory at error {error}\n")[2].partition("\n\n")[0]
    medians = {}
    for name, value, unit in re.findall(r"^(\S.*?)\s{2,}.*?\s(?:\d\.\de-\d+)\s+([\d.]+) (s|ms|µs)\s", table, re.MULTILINE):
        medians.setdefault(name, float(value) * _MS[unit])
    others = [median for name, median in medians.items() if not name.startswith("granchain ")]
    return f"{min(others) / medians['granchain dop853-root']:.1f}"


def test_the_cost_of_the_derivative_is_that_of_the_tables() -> None:
    """docs/orbits.md states the smallest and largest ratios of all machines for three numbers of beads."""
    tables = [text.partition("with derivative ms")[2].partition("An orbit of")[0] for text in _PAGE.split("One drive period of ")[1:]]
    text = " ".join((ROOT / "docs" / "orbits.md").read_text(encoding="utf-8").split())
    said = re.findall(r"([\d.]+) to ([\d.]+) times (?:the motion alone )?with (\d+)", text)
    assert len(said) == 3
    for low, high, beads in said:
        ratios = [float(ratio) for table in tables
                  for ratio in re.findall(rf"^{beads} +[\d.]+ +[\d.]+ +([\d.]+) ", table, re.MULTILINE)]
        assert len(ratios) == len(tables) and (float(low), float(high)) == (min(ratios), max(ratios))


def sentence(text: str) -> str:
    """Join a text into one line."""
    return " ".join(text.split())


@pytest.mark.parametrize(("page", "core", "words"), [
    ("README.md", "znver5", "On one core of a Zen 5 the fastest other program takes {} times as long as `dop853-root` at an "
                            "error of 1e-8, and {} times at 1e-10"),
    ("docs/benchmarks.md", "znver4", "in the tables of the second section, a day later, it is {} and {} times")])
def test_sentences_about_benchmarks_agree_with_the_tables(page: str, core: str, words: str) -> None:
    (section,) = (text for title, text in _SECTIONS.items() if core in title)
    expected = words.format(*(ratio(section, error) for error in ("1e-08", "1e-10")))
    assert expected in sentence((ROOT / page).read_text(encoding="utf-8")), f"write: {expected}"
