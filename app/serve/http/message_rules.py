"""Rules for websocket messages: only those that BokehJS sends for our page reach Bokeh.

Bokeh decodes more than BokehJS sends: arrays of any shape, new models of any kind, a whole new document, and compressed
bytes, a few kilobytes of which may expand to gigabytes. Bokeh also keeps whatever a browser writes into a property. A
message consists of three texts: header, metadata and content. The rules accept a message that requests the document,
reports the sizes of a figure, or sends events with plain values of limited depth.
"""

from __future__ import annotations

import json
from typing import Any

#: Kinds of messages: a request for the document, and changes of the document.
KINDS = ("PULL-DOC-REQ", "PATCH-DOC")
#: Kinds of changes: a new value of a property, and an event of the document or of a model.
CHANGES = ("ModelChanged", "MessageSent")
#: Encoded values that are allowed: NaN and infinities, lists, sets and dictionaries, and events.
TYPES = ("number", "array", "set", "map", "event")
#: Properties that BokehJS reports for the figures of our page: their sizes in pixels (the browser tests collect them).
#: The figures have no tool that moves a range or selects points, and the parts of Panel change no property.
REPORTED_PROPERTIES = frozenset({"inner_width", "inner_height", "outer_width", "outer_height"})
#: Largest number of characters in a content without a file. A page's longest content has a link of at most
#: `LONGEST_LINK` characters (app/session/share.py).
LARGEST_PLAIN_CONTENT = 100_000
#: Largest number of characters in a header or metadata; BokehJS writes an id and a kind.
LARGEST_HEADER = 1000
#: The value of `do` in a message with a visitor's file.
UPLOAD = "measurement"
#: Deepest nesting of lists and dictionaries; our page nests six levels.
DEEPEST = 20


class RefusedMessage(Exception):
    """A message that our pages never send; the text gives the reason."""


def checked_content(header: str, content: str) -> dict[str, Any]:
    """Return the content of a message; raise `RefusedMessage` if the rules do not accept the message."""
    head = _object("header", header)
    if not isinstance(head.get("msgid"), str) or head.get("msgtype") not in KINDS:
        raise RefusedMessage("unknown kind of message")
    if head.get("num_buffers", 0) != 0:
        raise RefusedMessage("binary data")
    given = _object("content", content)
    if len(content) > LARGEST_PLAIN_CONTENT and not _is_upload(given):
        raise RefusedMessage("message too long")
    if head["msgtype"] == "PULL-DOC-REQ":
        return given
    events = given.get("events")
    if not isinstance(events, list) or not events:
        raise RefusedMessage("no events")
    for event in events:
        if not isinstance(event, dict) or event.get("kind") not in CHANGES:
            raise RefusedMessage("unknown kind of event")
        if event["kind"] == "ModelChanged":
            _check_property(event.get("attr"), event.get("new"))
        for value in event.values():
            _check_value(value, DEEPEST)
    return given


def _object(what: str, text: str) -> dict[str, Any]:
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise RefusedMessage(f"unreadable {what}") from None
    if not isinstance(value, dict):
        raise RefusedMessage(f"unreadable {what}")
    return value


def _is_upload(given: dict[str, Any]) -> bool:
    """Return whether the content is a single event of a part with a file and its name, and nothing else."""
    match given:
        case {"events": [{"kind": "MessageSent", "msg_data": {"values": {"entries": [
                ["model", _], ["data", {"entries": [*entries]}]]}}}]}:
            match entries:
                case [[str(), str()], [str(), str()], [str(), str()]]:
                    words = dict(entries)
                    return words.keys() == {"do", "name", "content"} and bool(words["do"] == UPLOAD)
    return False


def _check_property(name: object, value: object) -> None:
    """Accept only a figure's size: any other value would stay in the model as long as the page is open."""
    if not isinstance(name, str) or name not in REPORTED_PROPERTIES:
        raise RefusedMessage("a change of a property that no page reports")
    if value is not None and not isinstance(value, (int, float)):
        raise RefusedMessage("a size that is not a number")


def _check_value(value: Any, deepest: int) -> None:
    if not isinstance(value, (dict, list)):
        return
    if deepest == 0:
        raise RefusedMessage("value nested too deeply")
    if isinstance(value, dict):
        if "type" in value and value["type"] not in TYPES:
            raise RefusedMessage("a value of a kind that no page sends")
        value = list(value.values())
    for item in value:
        _check_value(item, deepest - 1)
