"""The tables of messages in docs/dashboard.md, which follow from the dashboard's code."""

from __future__ import annotations

import re

from bokeh.document import Document

from app.dashboard.controller import Controller
from app.scripts import FILES
from app.session.session import Session

#: A comparison, in a script, of a message's type with a name.
_READS = re.compile(r'(?:\bmessage\.|(?<![.\w]))type [!=]==\s+"([\w-]+)"')
#: A message whose type no script compares, because any message to the chain shows that the server answers.
_READ_OTHERWISE = {"chain.js": ["pong"]}


def messages_of_the_browser() -> dict[str, list[str]]:
    """Return the messages that the dashboard understands, by owner."""
    dashboard = Controller(Document(), Session())
    dashboard.close()
    return {owner: list(actions) for owner, actions in dashboard.owners.items() if actions}


def messages_of_the_server() -> dict[str, list[str]]:
    """Return the messages that the scripts read, by script."""
    found: dict[str, list[str]] = {}
    for name, path in sorted(FILES.items()):
        read = list(dict.fromkeys(_READS.findall(path.read_text(encoding="utf-8")))) + _READ_OTHERWISE.get(name, [])
        if read:
            found[name] = read
    return found


def table_of_messages_of_the_browser() -> str:
    """Return the table of the owners with their messages."""
    return _table("owner", messages_of_the_browser())


def table_of_messages_of_the_server() -> str:
    """Return the table of the scripts with the messages that they read."""
    return _table("read by", {f"`{script}`": names for script, names in messages_of_the_server().items()})


def _table(title: str, messages: dict[str, list[str]]) -> str:
    rows = [f"| {owner} | {', '.join(f'`{name}`' for name in names)} |" for owner, names in messages.items()]
    return "\n".join([f"| {title} | messages |", "|---|---|", *rows])
