"""The sections of docs/dashboard.md on errors and on the state of a page agree with the code."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import pytest
from documents import ROOT

from app.dashboard.sentences import Sentences
from app.serve.monitoring import faults
from app.session.session import Session
from app.session.share import BROWSER_FIELDS, INITIAL_STATE, PINS, QUESTION

pytestmark = pytest.mark.quick

PAGE = (ROOT / "docs" / "dashboard.md").read_text(encoding="utf-8")
ERRORS = " ".join(PAGE.partition("\n## Errors\n")[2].partition("\n## ")[0].split())
STATE = PAGE.partition("\n## Where the state of a web page is\n")[2].partition("\n## ")[0]
SOURCES = [path.read_text(encoding="utf-8") for path in (ROOT / "app").rglob("*.py")]


def keys_of(storage: str) -> set[str]:
    """Return the keys under which the page stores values in `localStorage` or `sessionStorage`."""
    found = set()
    for path in [*(ROOT / "app").rglob("*.js"), *(ROOT / "app").rglob("*.html")]:
        text = path.read_text(encoding="utf-8")
        for key in re.findall(rf"{storage}\.\w+\(([^,)]+)", text):
            found.add(key.strip('"') if key.startswith('"') else re.findall(rf'const {key} = "([^"]+)"', text)[0])
    return found


@pytest.mark.parametrize("storage", ["localStorage", "sessionStorage"])
def test_the_keys_of_the_browsers_storage_are_those_of_the_page(storage: str) -> None:
    (row,) = re.findall(rf"^\| `{storage}` \| (.+?) \|", STATE, re.MULTILINE)
    assert set(re.findall(r"`([\w-]+)`", row)) == keys_of(storage) != set()


def test_the_fields_of_a_link_are_those_of_the_page() -> None:
    (row,) = re.findall(r"^\| address .*", STATE, re.MULTILINE)
    of_the_server, _, of_the_browser = row.partition("fields of the browser")
    assert tuple(re.findall(r"`(\w+)`", of_the_browser)) == BROWSER_FIELDS
    assert {INITIAL_STATE, QUESTION, "story", "scene", "v"} <= set(re.findall(r"`(\w+)`", of_the_server)) and PINS[0] in of_the_server


def test_loggers_and_messages_of_errors_are_those_of_the_code() -> None:
    loggers = {name for text in SOURCES for name in re.findall(r'log = logging\.getLogger\("([\w.]+)"\)', text)}
    assert set(re.findall(r"loggers? (?:is )?`([\w.]+)`", ERRORS)) == loggers
    messages = re.findall(r"message(?: is)? `([^`]+?)(?: …)?`", ERRORS)
    assert len(messages) == 5
    for message in messages:
        assert any(f'"{message}' in text for text in SOURCES), message


def test_the_sentence_of_an_error_is_that_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: dict[str, Any] = {}
    line: Any = SimpleNamespace(update_state=shown.update)
    monkeypatch.setattr("app.dashboard.sentences.new_fault_id", lambda: "632c7595bdec")
    Sentences(Session(), line, lambda: None).show_failure(ZeroDivisionError("1/0"))
    assert f"“{shown['sentence']}”" in ERRORS
    words = "The search failed because of an error in granchain (ZeroDivisionError); please report it."
    assert f"“{faults.with_fault_id(words, '632c7595bdec')}”" in ERRORS
    assert any('failed because of an error in granchain ({type(error).__name__}); please report it.' in text for text in SOURCES)
