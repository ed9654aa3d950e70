"""The messages between browser and server: docs/dashboard.md lists those of both directions, and no others are sent."""

from __future__ import annotations

import re
from pathlib import Path

from bokeh.document import Document

from app.dashboard.controller import Controller
from app.scripts import FILES
from app.session.session import Session

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "dashboard.md").read_text(encoding="utf-8")


def listed(title: str) -> dict[str, list[str]]:
    """The table with this title: the messages of each row."""
    table = PAGE.split(f"| {title} | messages |\n|---|---|\n")[1].partition("\n\n")[0]
    return {owner: re.findall(r"`([\w-]+)`", messages) for owner, messages in re.findall(r"^\| ([^|]+) \| (.+) \|$", table, re.MULTILINE)}


LISTED = listed("owner")
READ = {script.strip("`"): messages for script, messages in listed("read by").items()}
#: In the scripts: `do: "name"`, or an argument of a function that sends it.
SENT = re.compile(r'\bdo:\s*"([\w-]+)"|\b(?:send|request)\(\s*"([\w-]+)"|\b(?:control|act)\(\s*"[^"]+",\s*"([\w-]+)"')


def test_the_table_of_messages_is_the_one_that_is_understood() -> None:
    dashboard = Controller(Document(), Session())
    assert {owner: list(actions) for owner, actions in dashboard.owners.items() if actions} == LISTED
    dashboard.close(None)


def test_every_message_of_a_script_is_understood() -> None:
    sent = {name for path in FILES.values() for match in SENT.findall(path.read_text(encoding="utf-8")) for name in match if name}
    known = {name for messages in LISTED.values() for name in messages}
    assert sent <= known
    assert not known - sent, "nobody sends these, or in a way that this test does not see"


#: In the scripts: a comparison of the message's type with a name.
READS = re.compile(r'(?:\bmessage\.|(?<![.\w]))type [!=]==\s+"([\w-]+)"')
#: In Python: `send(type="name")`, and the type of a message that a function makes for `send`.
SENDS = re.compile(r'send\b[(,]\s*type="([\w-]+)"|"type": "([\w-]+)"')


def test_the_table_of_messages_to_the_browser_is_what_the_scripts_read() -> None:
    found = {name: READS.findall(path.read_text(encoding="utf-8")) for name, path in FILES.items()}
    reading = {name: set(messages) for name, messages in found.items() if messages}
    reading["chain.js"].add("pong")  # which any message of the chain may be: it shows that the server answers
    assert reading == {script: set(messages) for script, messages in READ.items()}


def test_every_message_to_the_browser_is_read() -> None:
    files = [path for part in ("curve", "dashboard", "pages", "parts", "session") for path in (ROOT / "app" / part).rglob("*.py")]
    sent = {name for path in files for match in SENDS.findall(path.read_text(encoding="utf-8")) for name in match if name}
    assert sent == {name for messages in READ.values() for name in messages}
