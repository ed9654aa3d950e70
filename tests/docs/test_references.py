"""Every work that a page or docstring cites by author and year has an entry in docs/references.md."""

from __future__ import annotations

import re

import pytest
from documents import ROOT

ENTRIES = {(entry[1].split()[-1] if entry[1].startswith("di ") else entry[1], entry[2]) for entry in re.finditer(
    r"^- \*\*((?:di )?[A-Z]\w+)[^*]*? (\d{4})\.\*\*", (ROOT / "docs" / "references.md").read_text(encoding="utf-8"), re.MULTILINE)}
#: First author, perhaps others, and a year: "Keller 1977", "Zhang et al. (2016)", "Benettin, Galgani & Strelcyn 1976".
CITED = re.compile(r"\b([A-ZÅÖ][a-zø]+)(?:(?:, [A-Z][a-zøö]+)*(?:,? (?:&|and) [A-Z][a-zøö]+)| et al\.)?"
                   r" \(?((?:18|19|20)\d\d)\b\)?(?!-)")
#: Words that are not authors.
NOT_AUTHORS = {"Methods", "In", "On", "Above", "Below", "November", "Since", "Taken", "Before", "After", "Of", "Seed", "Over",
               "To", "About"}
FILES = [path for path in [*(ROOT / "docs").glob("*.md"), *(ROOT / "granchain_core").rglob("*.py")]
         if path.name not in ("references.md", "benchmarks.md", "reliability.md", "cite.py", "mutation.md", "hard-cases.md")]


@pytest.mark.parametrize("path", [path for path in FILES if CITED.search(path.read_text(encoding="utf-8"))],
                         ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_work_has_its_entry(path) -> None:  # type: ignore[no-untyped-def]
    cited = {(name, year) for name, year in CITED.findall(path.read_text(encoding="utf-8")) if name not in NOT_AUTHORS}
    assert cited <= ENTRIES, cited - ENTRIES
