"""Messages of the page's own parts, passed to the part without Bokeh's decoding of a change.

Every action of a visitor arrives this way but one: a click on the resonance curve is Bokeh's event `Tap`
(`app/curve/view.py`). All other messages go to Bokeh.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import partial
from typing import Any

from bokeh.document import Document

from .locked_callbacks import can_lock, run_locked

Receive = Callable[[dict[str, Any]], None]
#: Calls a part with a message, and reports its error to the visitor.
Call = Callable[[Receive, dict[str, Any]], None]

_NUMBERS = {"nan": float("nan"), "inf": float("inf"), "+inf": float("inf"), "-inf": float("-inf")}
#: The receiver of a part's messages, by document and model id.
_RECEIVERS: weakref.WeakKeyDictionary[Document, dict[str, weakref.WeakMethod[Receive]]] = weakref.WeakKeyDictionary()
#: The method that calls the receivers, by document.
_CALLS: weakref.WeakKeyDictionary[Document, weakref.WeakMethod[Call]] = weakref.WeakKeyDictionary()


class _NotAPartMessage(Exception):
    """The message is not a message of a part in plain values."""


def register(document: Document, model: str, receive: Receive) -> None:
    """Pass the messages of the model with this id to a method of a part; this does not keep the part alive."""
    _RECEIVERS.setdefault(document, {})[model] = weakref.WeakMethod(receive)


def call_with(document: Document, call: Call) -> None:
    """Have this document's receivers called by a method that handles their errors; its object is not kept alive."""
    _CALLS[document] = weakref.WeakMethod(call)


def dispatch(session: Any, content: dict[str, Any]) -> bool:
    """Pass a message to its part with the session's document locked; return False if Bokeh has to handle it."""
    if session is None or not can_lock(session) or session.destroyed:
        return False
    known = _RECEIVERS.get(session.document)
    if known is None:
        return False
    try:
        model, message = _read(content)
    except _NotAPartMessage:
        return False
    receive = known[model]() if model in known else None
    if receive is None:
        return False
    call = _CALLS[session.document]() if session.document in _CALLS else None
    run_locked(session, [partial(receive, message) if call is None else partial(call, receive, message)])
    return True


def _read(content: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the model's id and the message of its part."""
    match content:
        case {"events": [{"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": {
                "type": "event", "name": "data_event", "values": {"type": "map", "entries": [
                    ["model", {"id": str(model)}], ["data", {"type": "map"} as data]]}}}]}:
            message = _plain(data)
            return model, message
    raise _NotAPartMessage


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, list):
        return [_plain(item) for item in value]
    match value:
        case {"type": "map", "entries": [*entries]} if len(value) == 2:
            return dict(_entry(entry) for entry in entries)
        case {"type": "number", "value": str(name)} if len(value) == 2 and name in _NUMBERS:
            return _NUMBERS[name]
    raise _NotAPartMessage


def _entry(entry: Any) -> tuple[str, Any]:
    match entry:
        case [str(key), value]:
            return key, _plain(value)
    raise _NotAPartMessage
