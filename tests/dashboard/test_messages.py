"""The messages between browser and server: each is sent by one side and understood by the other."""

from __future__ import annotations

import re
from pathlib import Path

from app.scripts import FILES
from tools.dashboard_tables import messages_of_the_browser, messages_of_the_server

ROOT = Path(__file__).parents[2]
#: In the scripts: `do: "name"`, or an argument of a function that sends it.
SENT = re.compile(r'\bdo:\s*"([\w-]+)"|\b(?:send|request)\(\s*"([\w-]+)"|\b(?:control|act)\(\s*"[^"]+",\s*"([\w-]+)"')


def test_every_message_of_a_script_is_understood() -> None:
    sent = {name for path in FILES.values() for match in SENT.findall(path.read_text(encoding="utf-8")) for name in match if name}
    known = {name for messages in messages_of_the_browser().values() for name in messages}
    assert sent <= known
    assert not known - sent, "these are not sent, or in a way that this test does not see"


#: In Python: `send(type="name")`, and the type of a message that a function creates for `send`.
SENDS = re.compile(r'send\b[(,]\s*type="([\w-]+)"|"type": "([\w-]+)"')


def test_every_message_to_the_browser_is_read() -> None:
    files = [path for part in ("curve", "dashboard", "pages", "parts", "session") for path in (ROOT / "app" / part).rglob("*.py")]
    sent = {name for path in files for match in SENDS.findall(path.read_text(encoding="utf-8")) for name in match if name}
    assert sent == {name for messages in messages_of_the_server().values() for name in messages}
