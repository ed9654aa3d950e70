"""Sends the changes of a document to the browser: all changes of one action leave as one message, in one write.

The message is the same that Bokeh would send, but is made without a search of all models of the document. Bokeh encodes
values that are not plain, such as new models. This module uses undocumented parts of Tornado and Bokeh; if a release
lacks them, changes leave as Bokeh sends them.
"""

from __future__ import annotations

import base64
import gzip
import itertools
import json
import math
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import panel as pn
from bokeh.document import Document
from bokeh.document.events import ColumnDataChangedEvent, DocumentPatchedEvent, MessageSentEvent, ModelChangedEvent
from bokeh.events import ModelEvent
from bokeh.model import Model
from bokeh.models import ColumnarDataSource
from tornado.iostream import IOStream, StreamClosedError
from tornado.locks import Lock

from ...library_internals import Internal, internals, missing

#: Largest integer that JavaScript represents exactly.
_LARGEST_SAFE_INTEGER = 2**53 - 1
#: Types for which BokehJS has arrays, by NumPy's letters.
_ARRAYS = {"f": "float32", "d": "float64", "i": "int32", "B": "uint8"}
#: Arrays up to this size are written into the text [bytes]. A larger array costs both sides two more frames.
_LARGEST_INLINE_ARRAY = 8192
_NUMBERS = itertools.count(1)
_WITHOUT = "changes leave as Bokeh sends them: a move takes three times as long"
#: The undocumented parts of Bokeh and Tornado that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.document.callbacks.DocumentCallbackManager",
             ("_held_events", "hold", "unhold", "hold_value", "trigger_on_change"), _WITHOUT),
    Internal("bokeh.document.document.Document", ("callbacks",), _WITHOUT),
    Internal("bokeh.core.has_props.HasProps", ("_property_values",), _WITHOUT),
    Internal("bokeh.server.session.ServerSession", ("_subscribed_connections",), _WITHOUT),
    Internal("bokeh.server.connection.ServerConnection", ("_socket", "protocol"), _WITHOUT),
    Internal("bokeh.protocol.Protocol", ("create",), _WITHOUT),
    Internal("bokeh.protocol.message.Message", ("header_json", "metadata_json", "content_json", "buffers"), _WITHOUT),
    Internal("bokeh.core.serialization.Buffer", ("ref", "to_bytes"), _WITHOUT),
    Internal("bokeh.server.views.ws.WSHandler", ("write_lock",), _WITHOUT),
    Internal("tornado.websocket.WebSocketHandler", ("ws_connection",), _WITHOUT),
    Internal("tornado.websocket.WebSocketProtocol", ("stream", "is_closing"), _WITHOUT),
)


def is_complete() -> bool:
    """Return whether the installed releases have all of `INTERNALS`."""
    return not missing(INTERNALS)


_COMPLETE = is_complete()


class _NotPlainValue(Exception):
    """This value must be encoded by Bokeh."""


class _Message:
    """A message that is being written: its events as plain values, and its arrays."""

    def __init__(self) -> None:
        self.arrays: list[tuple[str, memoryview]] = []

    def event(self, event: DocumentPatchedEvent) -> dict[str, Any]:
        """Return an event as Bokeh's `to_serializable` writes it."""
        if isinstance(event, MessageSentEvent) and isinstance(event.msg_data, ModelEvent):
            sent = event.msg_data
            values = [["model", _reference(sent.model)], ["data", self.value(getattr(sent, "data", None))]]
            return {"kind": "MessageSent", "msg_type": event.msg_type, "msg_data": {
                "type": "event", "name": sent.event_name, "values": {"type": "map", "entries": values}}}
        if isinstance(event, ColumnDataChangedEvent) and event.cols is None:
            data = getattr(event.model, event.attr) if event.data is None else event.data
            return {"kind": "ColumnDataChanged", "model": _reference(event.model), "attr": event.attr,
                    "data": self.value(data), "cols": None}
        if isinstance(event, ModelChangedEvent):
            return {"kind": "ModelChanged", "model": _reference(event.model), "attr": event.attr,
                    "new": self.value(event.new)}
        raise _NotPlainValue

    def value(self, value: Any) -> Any:
        """Return a plain value as Bokeh writes it in JSON."""
        if value is None or isinstance(value, (str, bool)):
            return value
        if isinstance(value, float):  # includes NumPy's double
            if math.isfinite(value):
                return float(value)
            return {"type": "number", "value": "nan" if math.isnan(value) else f"{value:+}"}
        if isinstance(value, int) and abs(value) <= _LARGEST_SAFE_INTEGER:
            return int(value)
        if isinstance(value, (list, tuple)):
            return [self.value(item) for item in value]
        if isinstance(value, dict):
            return {"type": "map", "entries": [[self.value(key), self.value(item)] for key, item in value.items()]}
        if isinstance(value, np.ndarray) and value.shape and value.dtype.char in _ARRAYS:
            return self._array(value)
        raise _NotPlainValue

    def _array(self, value: np.ndarray) -> dict[str, Any]:
        data: str | dict[str, str]
        if value.nbytes <= _LARGEST_INLINE_ARRAY:
            # BokehJS expects gzip here; level 0 only puts a frame around the bytes
            data = base64.b64encode(gzip.compress(value.tobytes(), compresslevel=0, mtime=1)).decode()
        else:
            data = {"id": f"a{len(self.arrays)}"}
            self.arrays.append((data["id"], np.ascontiguousarray(value).data.cast("B")))
        return {"type": "ndarray", "array": {"type": "bytes", "data": data}, "shape": list(value.shape),
                "dtype": _ARRAYS[value.dtype.char], "order": sys.byteorder}


def _reference(model: Model | None) -> dict[str, str]:
    if model is None:
        raise _NotPlainValue
    return {"id": model.id}


def _frame(payload: bytes | memoryview, binary: bool = False) -> Iterator[bytes | memoryview]:
    """Yield a server's websocket frame (RFC 6455): unfragmented, unmasked and uncompressed."""
    kind, length = 0x82 if binary else 0x81, len(payload)
    if length < 126:
        yield struct.pack("!BB", kind, length)
    elif length < 65536:
        yield struct.pack("!BBH", kind, 126, length)
    else:
        yield struct.pack("!BBQ", kind, 127, length)
    yield payload


def encode_patch(events: list[DocumentPatchedEvent]) -> bytes | None:
    """Return the frames of a message with these events; None if Bokeh has to encode one of them."""
    message = _Message()
    try:
        content = {"events": [message.event(event) for event in events]}
    except _NotPlainValue:
        return None
    header: dict[str, Any] = {"msgid": f"s{next(_NUMBERS)}", "msgtype": "PATCH-DOC"}
    if message.arrays:
        header["num_buffers"] = len(message.arrays)
    parts: list[bytes | memoryview] = []
    for part in (header, {}, content):
        parts.extend(_frame(json.dumps(part, separators=(",", ":")).encode()))
    for name, data in message.arrays:
        parts.extend(_frame(json.dumps({"id": name}).encode()))
        parts.extend(_frame(data, binary=True))
    return b"".join(parts)


def _encoded(document: Document, events: list[DocumentPatchedEvent], connection: Any) -> bytes:
    """Return the frames of these events as Bokeh encodes them: with models that are new to the browser."""
    message = connection.protocol.create("PATCH-DOC", events)
    parts: list[bytes | memoryview] = []
    for text in (message.header_json, message.metadata_json, message.content_json):
        parts.extend(_frame(text.encode()))
    for buffer in message.buffers:
        parts.extend(_frame(json.dumps(buffer.ref).encode()))
        parts.extend(_frame(bytes(buffer.to_bytes()), binary=True))
    return b"".join(parts)


class _Socket:
    """A page's websocket, usable if the releases of Bokeh and Tornado have the necessary attributes."""

    def __init__(self, connection: Any) -> None:
        self.connection = connection
        socket = getattr(connection, "_socket", None)
        self._lock = getattr(socket, "write_lock", None)
        self._ws_connection = getattr(socket, "ws_connection", None)
        self._stream = getattr(self._ws_connection, "stream", None)

    @property
    def usable(self) -> bool:
        """Whether whole frames can be written."""
        return isinstance(self._stream, IOStream) and isinstance(self._lock, Lock)

    def write(self, data: bytes) -> None:
        """Write whole messages, after any message that Bokeh is writing."""
        stream, lock, ws_connection = self._stream, self._lock, self._ws_connection
        assert isinstance(stream, IOStream) and isinstance(lock, Lock) and ws_connection is not None

        def put(locked: Any) -> None:
            with locked.result():
                # no frame may follow the closing frame (RFC 6455, section 5.5.1)
                if not (stream.closed() or ws_connection.is_closing()):
                    try:
                        stream.write(data)
                    except StreamClosedError:
                        return

        locked: Any = lock.acquire()
        if locked.done():
            put(locked)
        else:
            locked.add_done_callback(put)


def _send(document: Document, session: Any, events: list[Any]) -> None:
    """Send the held events that are for the browser as one message; Bokeh handles the others."""
    patches = [event for event in events if isinstance(event, DocumentPatchedEvent)]
    sockets = [_Socket(connection) for connection in getattr(session, "_subscribed_connections", ())]
    if patches and sockets and all(socket.usable for socket in sockets):
        data = encode_patch(patches)
        for socket in sockets:
            socket.write(_encoded(document, patches, socket.connection) if data is None else data)
        events = [event for event in events if not isinstance(event, DocumentPatchedEvent)]
    for event in events:
        document.callbacks.trigger_on_change(event)


@contextmanager
def batched_changes(document: Document) -> Iterator[None]:
    """Send all changes made inside this context as one message; used with the document locked."""
    session = getattr(document.session_context, "session", None)
    callbacks = document.callbacks
    known = _COMPLETE and session is not None and hasattr(callbacks, "_held_events")
    if not known or callbacks.hold_value is not None or not pn.state.loaded:
        yield
        return
    callbacks.hold("combine")
    try:
        yield
    finally:
        events, callbacks._held_events = list(callbacks._held_events), []
        callbacks.unhold()
        _send(document, session, events)


def _batching_document(model: Model) -> Document | None:
    """Return the model's document if its changes are being gathered."""
    document = model.document
    if document is None or not _COMPLETE or document.callbacks.hold_value is None:
        return None
    known = hasattr(document.callbacks, "_held_events") and hasattr(model, "_property_values")
    return document if known else None


def is_batched(model: Model) -> bool:
    """Return whether changes of the model are being gathered."""
    return _batching_document(model) is not None


def set_properties(model: Model, **values: Any) -> None:
    """Set properties of a model to valid values, which Bokeh neither checks nor converts.

    Setting an equal value is not a change. If no changes are being gathered, this calls the model's own `update`.
    """
    document = _batching_document(model)
    if document is None:
        model.update(**values)
        return
    known, events = model._property_values, document.callbacks._held_events
    for name, value in values.items():
        columns = name == "data" and isinstance(model, ColumnarDataSource)
        if not columns and name in known and known[name] == value:  # columns are arrays, which == does not compare
            continue
        known[name] = value
        _keep_last(events, (ColumnDataChangedEvent if columns else ModelChangedEvent)(document, model, name, value))


def _keep_last(events: list[Any], event: Any) -> None:
    """Keep an event instead of any earlier event of the same property, which is out of date."""
    for number, kept in enumerate(events):
        if type(kept) is type(event) and kept.model is event.model and kept.attr == event.attr:
            events[number] = event
            return
    events.append(event)


def send_event(model: Model, event: ModelEvent) -> bool:
    """Send an event to a model's view with the gathered changes; return False if none are being gathered."""
    document = _batching_document(model)
    if document is None:
        return False
    document.callbacks._held_events.append(MessageSentEvent(document, "bokeh_event", event))
    return True
