"""The websocket: a picture's messages leave together and at once; requests wait until they can be answered.

Private attributes of Tornado, Bokeh and Panel, and Panel's undocumented `set_curdoc`, are used in this file only. Each
saves some milliseconds or keeps a message from being lost; if a release drops one, the public API is used instead.
"""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import panel as pn
from bokeh.document import Document
from bokeh.events import Event
from tornado.iostream import IOStream

try:
    from panel.io.state import set_curdoc
except ImportError:  # it is not in Panel's documentation
    set_curdoc = None  # type: ignore[assignment]


def _session(document: Document) -> Any:
    return getattr(document.session_context, "session", None)


def _streams(document: Document) -> list[IOStream]:
    """The streams behind this page's websockets; empty if a release keeps them elsewhere."""
    connections = getattr(_session(document), "_subscribed_connections", ())
    sockets = [getattr(getattr(connection, "_socket", None), "ws_connection", None) for connection in connections]
    streams = [getattr(one, "stream", None) for one in sockets]
    return [stream for stream in streams if isinstance(stream, IOStream) and not stream.closed()]


def has_document_lock(document: Document) -> bool:
    """Whether Bokeh is known to hold the document's lock, without which the document may not be changed.

    While it holds the lock it keeps a list of pending writes. A message can also arrive while answers to an earlier
    one are still being written; Bokeh then refuses every change.
    """
    session = _session(document)
    return session is None or getattr(session, "_pending_writes", None) is not None


def with_document_lock(document: Document, action: Callable[[], None]) -> None:
    """Run `action` as soon as the document may be changed and the browser will be told of the change.

    The browser can send requests before it has reported that all parts are rendered. Until it has, Panel discards
    changes, as if the document had still to be fetched.
    """
    if not pn.state.loaded:
        pn.state.onload(action)
    elif has_document_lock(document):
        action()
    else:
        document.add_next_tick_callback(action)


def disable_nagle(document: Document) -> None:
    """Turn off Nagle's algorithm, which can delay a message by 40 ms until earlier ones are acknowledged."""
    for stream in _streams(document):
        stream.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


@contextmanager
def batched_messages(document: Document) -> Iterator[None]:
    """The messages written in this block are handed to the network together when it ends.

    A picture is about twenty small messages; sent singly, each costs 0.3 ms here and a wake-up in the browser.
    Tornado collects what is written until its buffer is emptied; in the block, emptying waits. Where Tornado empties it
    in another way, each message goes by itself.
    """
    streams = [stream for stream in _streams(document) if hasattr(stream, "_handle_write")]
    for stream in streams:
        stream._handle_write = _wait  # type: ignore[method-assign]
    try:
        yield
    finally:
        for stream in streams:
            del stream._handle_write
            if not stream.closed():
                stream._handle_write()


def _wait() -> None:
    """Replaces a stream's `_handle_write` while a picture is being written."""


class WithoutBusyIndicator:
    """A Panel component whose events skip the busy indicator, which this page does not show: it takes 2 of 5 ms.

    Panel calls `_process_bokeh_event`; with a release that calls another method or has no `set_curdoc`, the indicator
    comes back.
    """

    def _process_bokeh_event(self, doc: Document, event: Event) -> None:
        handle = getattr(self, "_process_event", None)
        if handle is None or set_curdoc is None:
            super()._process_bokeh_event(doc, event)  # type: ignore[misc]
            return
        with set_curdoc(doc):
            handle(event)
