"""The progress of a computation is described in the same words on every page."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import get_args

import pytest

from app.pages.branches.page import WORDS as BRANCHES
from app.pages.hard_cases.page import WORDS as HARD_CASES
from app.pages.map.page import SEARCH_WORDS
from app.session import progress as module
from app.session.progress import UNDER_WAY, Status, StatusWords

PAGES = Path(module.__file__).parents[1] / "pages"
#: Every `StatusWords` of a page, by page and name.
WORDS = {f"{path.parent.name} {name}": words for path in sorted(PAGES.glob("*/page.py"))
         for name, words in vars(importlib.import_module(f"app.pages.{path.parent.name}.page")).items()
         if isinstance(words, StatusWords)}


@pytest.mark.parametrize("words", [StatusWords(), *WORDS.values()], ids=["a new page", *WORDS])
def test_a_visitor_who_waits_for_a_compiler_reads_for_how_long(words: StatusWords) -> None:
    told = words.of("compiling")
    assert told["running"] and told["progress"].startswith("compiling the ")
    assert told["progress"].endswith(" s, only the first time on this computer …")


def test_finished_work_has_no_words_unless_it_was_stopped() -> None:
    for status in ("none", "done", "failed"):
        assert BRANCHES.of(status) == {"status": status, "progress": "", "running": False, "failure": ""}
    assert BRANCHES.of("stopped") == {"status": "stopped", "progress": "stopped; the orbits found so far are kept", "running": False,
                                       "failure": ""}
    assert HARD_CASES.of("stopped")["progress"] == "stopped"


def test_work_under_way_has_the_same_status_on_every_page() -> None:
    for status in set(UNDER_WAY) - {"compiling"}:
        assert HARD_CASES.of(status)["running"]
    assert SEARCH_WORDS.of("waiting")["progress"] == HARD_CASES.of("waiting")["progress"] == "waiting for its turn …"
    assert SEARCH_WORDS.of("searching")["progress"] != HARD_CASES.of("searching")["progress"]


def test_every_status_is_under_way_or_still() -> None:
    """Mypy checks the statuses used by pages against `Status`."""
    assert set(get_args(Status)) == {*UNDER_WAY, "none", "done", "stopped", "failed"}


def test_every_page_stops_with_the_same_word() -> None:
    scripts = {path: path.read_text(encoding="utf-8") for path in PAGES.rglob("*.js")}
    stops = re.compile(r'do:\s*"[\w-]+-stop"|send\(\s*"[\w-]+-stop"\s*\)')
    found = {path.name: (len(stops.findall(text)), len(re.findall(r'button\(\s*"(?:stop|✕)"', text)))
             for path, text in scripts.items() if stops.search(text)}
    assert len(found) > 2 and all(messages == buttons for messages, buttons in found.values()), found
    assert not [path for path, text in scripts.items() if '"cancel"' in text]
