"""Rules for websocket messages: only those that BokehJS sends for our page reach Bokeh.

Bokeh decodes more than its browser side sends: arrays of any shape, new models of any kind, a whole new document, and
compressed bytes, of which a few kilobytes may expand to gigabytes. It also keeps whatever a browser writes into a
property. A message consists of three texts: header, metadata and content. It is let through if it asks for the
document, if it reports the sizes of a figure, or if it sends events with plain values that are not nested too deep.
"""

from __future__ import annotations

import json
from typing import Any

#: What BokehJS asks for: the document, and changes of it.
KINDS = ("PULL-DOC-REQ", "PATCH-DOC")
#: What a change may be: a property of a model, or an event of the document or of a model.
CHANGES = ("ModelChanged", "MessageSent")
#: Encoded values that are allowed: NaN and infinities, lists, sets and dictionaries, and events.
TYPES = ("number", "array", "set", "map", "event")
#: The properties that BokehJS reports for the figures of our page (collected in the browser tests): their sizes in
#: pixels. The figures have no tool that moves a range or selects points, and Panel's parts change none of their own.
REPORTED_PROPERTIES = frozenset({"inner_width", "inner_height", "outer_width", "outer_height"})
#: Most characters of a content without a file. The longest that a page sends has a link of at most 4500.
LARGEST_PLAIN_CONTENT = 100_000
#: Most characters of a header and of metadata, which BokehJS fills with an id and a kind.
LARGEST_HEADER = 1000
#: What a message with a file of the visitor says in `do`.
UPLOAD = "measurement"
#: Deepest nesting of lists and dictionaries that is read; our page nests six.
DEEPEST = 20


class RefusedMessage(Exception):
    """A message that no page of ours sends; the text says why."""


def checked_content(header: str, content: str) -> dict[str, Any]:
    """The content of a message; raise `RefusedMessage` for one that is not let through."""
    head = _object("header", header)
    if not isinstance(head.get("msgid"), str) or head.get("msgtype") not in KINDS:
        raise RefusedMessage("unknown kind of message")
    if head.get("num_buffers", 0) != 0:
        raise RefusedMessage("binary data")
    given = _object("content", content)
    if len(content) > LARGEST_PLAIN_CONTENT and not _is_upload(given):
        raise RefusedMessage("too long a message")
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
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise RefusedMessage(f"unreadable {what}") from None
    if not isinstance(found, dict):
        raise RefusedMessage(f"unreadable {what}")
    return found


def _is_upload(given: dict[str, Any]) -> bool:
    """Whether this is one event of a part, with a file and its name and nothing else."""
    match given:
        case {"events": [{"kind": "MessageSent", "msg_data": {"values": {"entries": [
                ["model", _], ["data", {"entries": [*entries]}]]}}}]}:
            match entries:
                case [[str(), str()], [str(), str()], [str(), str()]]:
                    words = dict(entries)
                    return words.keys() == {"do", "name", "content"} and bool(words["do"] == UPLOAD)
    return False


def _check_property(name: object, value: object) -> None:
    """A figure's size: nothing else is written into a model, where it would stay as long as the page."""
    if not isinstance(name, str) or name not in REPORTED_PROPERTIES:
        raise RefusedMessage("a change of a property that no page reports")
    if value is not None and not isinstance(value, (int, float)):
        raise RefusedMessage("a size that is no number")


def _check_value(value: Any, deepest: int) -> None:
    if not isinstance(value, (dict, list)):
        return
    if deepest == 0:
        raise RefusedMessage("too deep a value")
    if isinstance(value, dict):
        if "type" in value and value["type"] not in TYPES:
            raise RefusedMessage("a value of a kind that no page sends")
        value = list(value.values())
    for item in value:
        _check_value(item, deepest - 1)
