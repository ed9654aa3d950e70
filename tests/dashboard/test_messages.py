"""The messages of a browser: docs/dashboard.md lists those that are understood, and each script sends only these."""

from __future__ import annotations

import re
from pathlib import Path

from bokeh.document import Document

from app.dashboard.controller import Controller
from app.scripts import FILES
from app.session.session import Session

PAGE = (Path(__file__).parents[2] / "docs" / "dashboard.md").read_text(encoding="utf-8")
LISTED = {owner: re.findall(r"`([\w-]+)`", messages)
          for owner, messages in re.findall(r"^\| ([^|]+) \| ((?:`[\w-]+`(?:, )?)+) \|$", PAGE.split("| owner | messages |")[1], re.MULTILINE)}
#: In the scripts: `do: "name"`, or an argument of a function that sends it.
SENT = re.compile(r'\bdo: "([\w-]+)"|\b(?:send|request)\("([\w-]+)"|\b(?:control|act)\("[^"]+", "([\w-]+)"')


def test_the_table_of_messages_is_the_one_that_is_understood() -> None:
    dashboard = Controller(Document(), Session())
    assert {owner: list(actions) for owner, actions in dashboard.owners.items() if actions} == LISTED
    dashboard.close(None)


def test_every_message_of_a_script_is_understood() -> None:
    sent = {name for path in FILES.values() for match in SENT.findall(path.read_text(encoding="utf-8")) for name in match if name}
    known = {name for messages in LISTED.values() for name in messages}
    assert sent <= known
    assert not known - sent, "nobody sends these, or in a way that this test does not see"
